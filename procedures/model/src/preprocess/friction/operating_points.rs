//! A table of operating points: each row is the mean of one steady state, in any order and without time.

use crate::preprocess::chunks::{Layout, Source, problem};
use crate::preprocess::friction::steady_state;
use crate::preprocess::{Prepared, unknown_columns};
use crate::report::fit::Preparation;
use crate::signal::{Signal, Signals};
use crate::stats::summary::peak;
use crate::thresholds::AT_REST;
use crate::view::Constants;
use crate::{ModelError, ResidualKind};
use jointbench_instrument::{Motion, RunTable};

/// Source of the segments of such a table.
pub const OPERATING_POINTS: &str = "operating points";

/// Fewer points cannot separate two effects.
const FEWEST: usize = 12;

/// Rows of equal speed and load are replicates of one condition. Points at rest are omitted, because friction at rest
/// is any torque up to breakaway. The table has no angles, ramps and reversals.
pub fn prepare(run: &RunTable) -> Result<Prepared, ModelError> {
    let samples = read(run)?;
    let speed = samples.signals.find(Signal::Velocity).unwrap_or_default();
    let fastest = peak(speed);
    let moving: Vec<usize> = (0..run.len()).filter(|row| speed[*row].abs() > AT_REST * fastest).collect();
    let at_rest = run.len() - moving.len();
    if moving.len() < FEWEST {
        return Err(ModelError::TooFewSamples {
            usable: moving.len(),
            needed: FEWEST,
            what: "operating points in motion",
        });
    }
    let points: Vec<_> = moving.iter().map(|row| *row..row + 1).collect();
    let condition = steady_state::conditions(&samples, &points, run.column("brake_torque_command_nm"));
    let occurrence = occurrences(&condition);
    let mut repeat = vec![0; run.len()];
    moving.iter().zip(&occurrence).for_each(|(row, k)| repeat[*row] = *k as i64);
    let samples = Source { repeat: Some(repeat), ..samples };
    let group = (0..moving.len()).collect();
    let repeats = occurrence.iter().any(|k| *k > 0);
    let layout = Layout { chunks: points, group, condition, phase: Some(occurrence), settled: true, inputs: &[] };
    let mut main = problem(&samples, layout);
    steady_state::set_drive(&mut main);
    let doubt = (at_rest > 0).then(|| {
        format!("{at_rest} of {} operating points are at rest and omitted: they do not determine friction", run.len())
    });
    let about = Preparation {
        residual: ResidualKind::PlateauMean,
        sample_rate_hz: 1.0,
        cutoff_hz: None,
        velocity_lag_s: None,
        decimation: 1,
        bristles: None,
        chunk_s: None,
        samples: run.len(),
        rows: main.rows(),
        blocks: main.blocks,
        segments_from: OPERATING_POINTS.into(),
        repeats_from: if repeats { "found" } else { "none" }.into(),
    };
    Ok(Prepared { warnings: doubt.into_iter().collect(), ..Prepared::of(run, main, about) })
}

fn read(run: &RunTable) -> Result<Source, ModelError> {
    let column = |name: &str| run.column(name).unwrap_or_default();
    let km = run
        .meta()
        .torque_constant_nm_per_a
        .ok_or(ModelError::MissingConstant { needed: "torque_constant_nm_per_a" })?;
    let gear = run.meta().gear_ratio.unwrap_or(1.0);
    let velocity = column("motor_velocity_rad_s");
    if velocity.iter().all(|v| *v == velocity[0]) {
        return Err(ModelError::Constant { column: "motor_velocity_rad_s".into() });
    }
    let mut signals = Signals::new(run.len());
    signals.set(Signal::Velocity, velocity.to_vec());
    let way = |v: &f64| if *v == 0.0 { 0.0 } else { v.signum() };
    signals.set(Signal::Direction, velocity.iter().map(way).collect());
    if let Some(load) = run.column("link_torque_nm") {
        signals.set(Signal::Load, load.iter().map(|t| t / gear).collect());
    }
    if let Some(temperature) = run.column("temperature_c") {
        signals.set(Signal::Temperature, temperature.to_vec());
    }
    unknown_columns::keep(&mut signals, run);
    let slides = run.meta().motion == Motion::Linear;
    let target: Vec<f64> = column("motor_current_a").iter().map(|i| km * i).collect();
    Ok(Source {
        signals,
        target: target.into(),
        step_s: 1.0,
        starts: vec![0],
        runs: vec![0],
        cutoff_hz: 0.0,
        segment: None,
        repeat: None,
        derived_velocity: false,
        constants: Constants { slides, rotor_inertia: run.meta().rotor_inertia_kg_m2, ..Constants::default() },
        time_s: column("time_s").to_vec(),
    })
}

/// How often each condition occurred before, for each row.
fn occurrences(condition: &[usize]) -> Vec<usize> {
    let mut seen = vec![0; condition.iter().max().map_or(0, |most| most + 1)];
    let next = |c: &usize| {
        seen[*c] += 1;
        seen[*c] - 1
    };
    condition.iter().map(next).collect()
}
