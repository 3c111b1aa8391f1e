//! Encoder runs: the wrapped difference of a test encoder and a reference.

use crate::preprocess::chunks::Source;
use crate::preprocess::design::replicates::Same;
use crate::preprocess::design::segments;
use crate::preprocess::encoder_count::encoder_count;
use crate::preprocess::{Prepared, filter, sample_s, sweeps};
use crate::signal::{Signal, Signals, is_pose};
use crate::stats::summary::peak;
use crate::view::Constants;
use crate::{ModelError, Options};
use jointbench_instrument::RunTable;
use jointbench_instrument::units::wrapped;

/// Short, so that errors within one pole pair are not averaged out at slow speed.
const CHUNK_S: f64 = 0.01;

pub fn prepare(run: &RunTable, options: &Options) -> Result<Prepared, ModelError> {
    let column = |name: &str| run.column(name).unwrap_or_default();
    let time_s = column("time_s").to_vec();
    let step_s = sample_s(&time_s);
    let reference = unwrap(column("reference_position_rad"));
    if reference.iter().all(|q| *q == reference[0]) {
        return Err(ModelError::Constant { column: "reference_position_rad".into() });
    }
    let target = difference(column("test_position_rad"), column("reference_position_rad"));
    let cutoff_hz = crate::preprocess::cutoff_hz(options, step_s)?;
    let measured = run.column("velocity_rad_s");
    let velocity = measured.map_or_else(
        || {
            let smooth = filter::LowPass::butterworth(4, 2.0 * cutoff_hz * step_s);
            let slope =
                |range: std::ops::Range<usize>, q: &[f64]| filter::derivative(&time_s[range], &smooth.both_ways(q, 12));
            filter::by_recording(&reference, &segments::runs(run), slope)
        },
        <[f64]>::to_vec,
    );
    let fastest = peak(&velocity);
    let mut signals = Signals::new(run.len());
    signals.set(Signal::Time, time_s.iter().map(|t| t - time_s[0]).collect());
    signals.set(Signal::Direction, segments::direction(&velocity, 1e-3 * fastest));
    signals.set(Signal::Position, reference);
    signals.set(Signal::Velocity, velocity);
    for (name, signal) in [("temperature_c", Signal::Temperature), ("repeat", Signal::Repeat)] {
        if let Some(values) = run.column(name) {
            signals.set(signal, values.to_vec());
        }
    }
    crate::preprocess::unknown_columns::keep(&mut signals, run);
    let source = Source {
        signals,
        target: target.into(),
        step_s,
        starts: segments::runs(run),
        runs: segments::runs(run),
        cutoff_hz,
        segment: segments::numbered(run),
        repeat: segments::integers(run, "repeat"),
        derived_velocity: measured.is_none(),
        time_s,
        constants: Constants {
            pole_pairs: run.meta().pole_pairs,
            poles: run.meta().poles,
            half_counts: 0.5
                * (encoder_count(column("reference_position_rad")) + encoder_count(column("test_position_rad"))),
            ..Constants::default()
        },
    };
    let poses = source.signals.unknown().filter(|s| matches!(s, Signal::Column(column) if is_pose(column)));
    let inputs: Vec<Same> = std::iter::once(Signal::Velocity).chain(poses).map(Same::Value).collect();
    sweeps::prepare(run, source, CHUNK_S, &inputs, options)
}

/// test − reference, wrapped about its circular mean, so that no sample is separated from the others at ±π.
///
/// The centre is the circular mean.
fn difference(test: &[f64], reference: &[f64]) -> Vec<f64> {
    let raw = || test.iter().zip(reference).map(|(t, r)| t - r);
    let (sin, cos) = raw().fold((0.0, 0.0), |(s, c), d| (s + d.sin(), c + d.cos()));
    let middle = sin.atan2(cos);
    raw().map(|d| middle + wrapped(d - middle)).collect()
}

fn unwrap(angle: &[f64]) -> Vec<f64> {
    let mut turned = 0.0;
    let mut last = angle.first().copied().unwrap_or_default();
    angle
        .iter()
        .map(|a| {
            turned += wrapped(a - last);
            last = *a;
            angle[0] + turned
        })
        .collect()
}
