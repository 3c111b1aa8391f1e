//! Brake runs: braking torque over the coil current.

use crate::preprocess::chunks::{CHUNK_S, Source};
use crate::preprocess::design::replicates::Same;
use crate::preprocess::design::segments;
use crate::preprocess::{Prepared, sample_s, sweeps};
use crate::signal::{Signal, Signals};
use crate::view::Constants;
use crate::{ModelError, Options};
use jointbench_instrument::{Motion, RunTable};

pub fn prepare(run: &RunTable, options: &Options) -> Result<Prepared, ModelError> {
    let column = |name: &str| run.column(name).unwrap_or_default();
    let current = column("brake_current_a");
    if current.iter().all(|i| *i == current[0]) {
        return Err(ModelError::Constant { column: "brake_current_a".into() });
    }
    let time_s = column("time_s").to_vec();
    let step_s = sample_s(&time_s);
    let mut signals = Signals::new(run.len());
    signals.set(Signal::Time, time_s.iter().map(|t| t - time_s[0]).collect());
    signals.set(Signal::Current, current.to_vec());
    for (name, signal) in [
        ("velocity_rad_s", Signal::Velocity),
        ("position_rad", Signal::Position),
        ("temperature_c", Signal::Temperature),
        ("repeat", Signal::Repeat),
    ] {
        if let Some(values) = run.column(name) {
            signals.set(signal, values.to_vec());
        }
    }
    let rising = segments::direction(&trend(current, run.len() / 400 + 5), 0.0);
    signals.set(Signal::Direction, rising);
    crate::preprocess::unknown_columns::keep(&mut signals, run);
    let source = Source {
        signals,
        target: column("brake_torque_nm").to_vec().into(),
        step_s,
        starts: segments::runs(run),
        runs: segments::runs(run),
        cutoff_hz: 0.1 / step_s,
        segment: segments::numbered(run),
        repeat: segments::integers(run, "repeat"),
        derived_velocity: false,
        time_s,
        constants: Constants {
            pole_pairs: None,
            poles: run.meta().poles,
            slides: run.meta().motion == Motion::Linear,
            ..Constants::default()
        },
    };
    sweeps::prepare(run, source, CHUNK_S, &[Same::Size(Signal::Velocity), Same::Value(Signal::Current)], options)
}

/// Change of a signal over a window around each sample.
fn trend(values: &[f64], window: usize) -> Vec<f64> {
    let n = values.len();
    (0..n).map(|i| values[(i + window).min(n - 1)] - values[i.saturating_sub(window)]).collect()
}
