//! Friction runs: motor torque k_m·i_q over motion, load and temperature.

pub(crate) mod bristles;
pub(crate) mod layout;
pub(crate) mod operating_points;
pub(crate) mod signals;
pub(crate) mod steady_state;
pub(crate) mod trajectory;
pub(crate) mod unmeasured_gravity;
pub(crate) mod work_rate;

use crate::effects::changes_direction;
use crate::linear::basis::{Basis, dot};
use crate::preprocess::chunks::Source;
use crate::preprocess::design::segments;
use crate::preprocess::{INFORMATIVE_ROWS, Prepared, filter, sample_s};
use crate::report::fit::Bristles;
use crate::signal::{Signal, Signals};
use crate::stats::summary::{median, peak};
use crate::view::Constants;
use crate::{ModelError, Options, ResidualKind};
use jointbench_instrument::{Motion, RunTable};

pub fn prepare(run: &RunTable, options: &Options, bristles: Option<&Bristles>) -> Result<Prepared, ModelError> {
    if run.meta().operating_points {
        return operating_points::prepare(run);
    }
    if options.residual == Some(ResidualKind::Raw) {
        return trajectory::prepare(run, options, bristles);
    }
    let samples = read(run, options)?;
    let plateaus = steady_state::find(&samples, run.meta().gear_ratio.unwrap_or(1.0), options);
    let settled: usize = plateaus.iter().map(|p| p.len()).sum();
    // A few steady moments of a trajectory are no measurement in steps. A long rest in addition to many steps still
    // is one.
    let in_steps = settled * 2 > run.len()
        || (samples.segment.is_some() && plateaus.len() >= 12 && plateaus.len() * 2 > samples.legs().len());
    // If presliding is known, ramps and reversals are as informative as steady-state motion, and there are more of
    // them.
    let can_absorb = run.meta().baseline.iter().any(|effect| changes_direction(effect));
    match options.residual {
        None if !in_steps || can_absorb => trajectory::prepare(run, options, bristles),
        _ => steady_state::prepare(run, samples, plateaus, options),
    }
}

fn read(run: &RunTable, options: &Options) -> Result<Source, ModelError> {
    let column = |name: &str| run.column(name).unwrap_or_default();
    let km = run
        .meta()
        .torque_constant_nm_per_a
        .ok_or(ModelError::MissingConstant { needed: "torque_constant_nm_per_a" })?;
    let position = column("motor_position_rad");
    if position.iter().all(|q| *q == position[0]) {
        return Err(ModelError::Constant { column: "motor_position_rad".into() });
    }
    let time_s = column("time_s").to_vec();
    let step_s = sample_s(&time_s);
    let starts = segments::recordings(&time_s, position, step_s);
    let cutoff_hz = crate::preprocess::cutoff_hz(options, step_s)?;
    let motion = || motion(run, &starts, 2.0 * cutoff_hz * step_s);
    let other_columns = || {
        let torque_nm: Vec<f64> = column("motor_current_a").iter().map(|i| km * i).collect();
        (other_signals(run), torque_nm, segments::numbered(run), segments::integers(run, "repeat"))
    };
    let (of_motion, (mut signals, target, segment, repeat)) = rayon::join(motion, other_columns);
    of_motion.into_iter().for_each(|(signal, values)| signals.set(signal, values));
    let slides = run.meta().motion == Motion::Linear;
    Ok(Source {
        signals,
        target: target.into(),
        step_s,
        starts,
        runs: segments::runs(run),
        cutoff_hz,
        segment,
        repeat,
        derived_velocity: run.column("motor_velocity_rad_s").is_none(),
        constants: Constants { slides, rotor_inertia: run.meta().rotor_inertia_kg_m2, ..Constants::default() },
        time_s,
    })
}

/// Velocity, acceleration, jerk and direction. `cutoff` is the corner frequency as a share of the Nyquist frequency.
fn motion(run: &RunTable, starts: &[usize], cutoff: f64) -> [(Signal, Vec<f64>); 4] {
    let column = |name: &str| run.column(name).unwrap_or_default();
    let (time_s, position) = (column("time_s"), column("motor_position_rad"));
    let smooth = filter::LowPass::butterworth(4, cutoff);
    let smoothed = |values: &[f64]| filter::by_recording(values, starts, |_, v| smooth.both_ways(v, 12));
    let slope = |values: &[f64]| filter::by_recording(values, starts, |range, v| filter::derivative(&time_s[range], v));
    let (velocity, smooth_velocity) = match run.column("motor_velocity_rad_s") {
        Some(v) => (v.to_vec(), smoothed(v)),
        None => {
            let v = slope(&smoothed(position));
            (v.clone(), v)
        }
    };
    let slopes = || {
        let acceleration = slope(&smooth_velocity);
        (slope(&acceleration), acceleration)
    };
    let ways = || {
        let every = velocity.len().div_ceil(INFORMATIVE_ROWS);
        let off = velocity.iter().zip(&smooth_velocity).step_by(every).map(|(a, b)| (a - b).abs());
        let noise = median(off);
        let fastest = peak(&smooth_velocity);
        let direction = segments::direction(&smooth_velocity, (2.0 * noise).min(0.02 * fastest));
        segments::without_swings(direction, position, starts)
    };
    let ((jerk, acceleration), direction) = rayon::join(slopes, ways);
    [
        (Signal::Velocity, velocity),
        (Signal::Acceleration, acceleration),
        (Signal::Jerk, jerk),
        (Signal::Direction, direction),
    ]
}

/// Time, positions, load, temperature, and the columns that the model does not know.
fn other_signals(run: &RunTable) -> Signals {
    let column = |name: &str| run.column(name).unwrap_or_default();
    let (time_s, position) = (column("time_s"), column("motor_position_rad"));
    let gear = run.meta().gear_ratio.unwrap_or(1.0);
    let mut signals = Signals::new(run.len());
    signals.set(Signal::Time, time_s.iter().map(|t| t - time_s[0]).collect());
    signals.set(Signal::Position, position.to_vec());
    let link = match run.column("link_position_rad") {
        Some(link) => link.to_vec(),
        None => position.iter().map(|q| q / gear).collect(),
    };
    signals.set(Signal::Link, link);
    if let Some(load) = run.column("link_torque_nm") {
        signals.set(Signal::Load, load.iter().map(|t| t / gear).collect());
    }
    if let Some(temperature) = run.column("temperature_c") {
        signals.set(Signal::Temperature, temperature.to_vec());
    }
    crate::preprocess::unknown_columns::keep(&mut signals, run);
    signals
}

/// The motor torque as explained by load, direction, speed and acceleration. It excludes the noise of the measured
/// torque, which would correlate with any power of itself, and the cubic part due to magnetic saturation.
fn drive(signals: &Signals, torque_nm: &[f64]) -> Vec<f64> {
    let of = |signal| signals.find(signal).map(<[f64]>::to_vec);
    let inputs = [Signal::Direction, Signal::Velocity, Signal::Load, Signal::Acceleration];
    let mut columns: Vec<Vec<f64>> = inputs.into_iter().filter_map(of).collect();
    columns.push(vec![1.0; torque_nm.len()]);
    let linear = Basis::of(&columns);
    let explained = |y: &[f64]| -> Vec<f64> { y.iter().zip(linear.rest(y)).map(|(y, e)| y - e).collect() };
    let mut drive = explained(torque_nm);
    for _ in 0..2 {
        let cube: Vec<f64> = drive.iter().map(|t| t * t * t).collect();
        let cube_rest = linear.rest(&cube);
        let share = dot(&cube_rest, torque_nm) / dot(&cube_rest, &cube_rest).max(f64::MIN_POSITIVE);
        let rest: Vec<f64> = torque_nm.iter().zip(&cube).map(|(y, c)| y - share * c).collect();
        drive = explained(&rest);
    }
    drive
}
