//! Signals of a trajectory at the work rate, smoothed before nonlinear operations.

use crate::ModelError;
use crate::preprocess::design::segments;
use crate::preprocess::filter::{LowPass, by_recording, derivative};
use crate::preprocess::friction::bristles;
use crate::preprocess::friction::work_rate::{Even, even};
use crate::preprocess::sample_s;
use crate::signal::{Signal, Signals};
use crate::stats::summary::quantile;
use jointbench_instrument::RunTable;
use rayon::prelude::*;

/// Corner frequencies of the signal filter [Hz], lower for slow and unknown signals.
const SIGNAL_HZ: f64 = 40.0;
const SLOW_HZ: f64 = 1.0;
const UNKNOWN_HZ: f64 = 5.0;
/// Largest corner frequency as a share of the work rate.
const MOST_OF_RATE: f64 = 0.35;

/// The run at the work rate.
pub struct Work {
    pub signals: Signals,
    pub torque: Vec<f64>,
    pub even: Even,
    pub turns: Vec<usize>,
    /// The sign of the motion if it does not change.
    pub only_direction: Option<f64>,
    /// Samples at which the joint reverses or rests.
    pub stills: Vec<usize>,
    pub encoder_step: f64,
    pub slowest_step: f64,
    pub fastest: f64,
}

impl Work {
    /// Adds samples at rest: slower than `slow_rad_s`, unless the joint is that slow most of the time.
    pub fn set_stills(&mut self, slow_rad_s: f64) {
        let velocity = self.signals.find(Signal::Velocity).unwrap_or_default();
        let rests: Vec<usize> = (0..velocity.len()).filter(|i| velocity[*i].abs() < slow_rad_s).collect();
        self.stills.clone_from(&self.turns);
        if 2 * rests.len() < velocity.len() {
            self.stills.extend(rests);
            self.stills.sort_unstable();
        }
    }

    /// Time from a sample to the nearest reversal or rest [s].
    pub fn turn_s(&self, sample: usize) -> f64 {
        let next = self.stills.partition_point(|still| *still < sample);
        let near = [next.checked_sub(1), Some(next)].into_iter().flatten().filter_map(|at| self.stills.get(at));
        near.map(|still| still.abs_diff(sample) as f64 * self.even.step_s).fold(f64::INFINITY, f64::min)
    }
}

pub fn filtered(values: &[f64], even: &Even, cutoff_hz: f64, order: usize) -> Vec<f64> {
    let filter = LowPass::butterworth(order, (2.0 * cutoff_hz * even.step_s).min(0.99));
    by_recording(values, &even.starts, |_, v| filter.both_ways(v, pad(cutoff_hz, even.step_s)))
}

/// Samples by which the ends of a recording are extended for a filter.
pub fn pad(cutoff_hz: f64, step_s: f64) -> usize {
    (1.0 / (cutoff_hz * step_s)).ceil() as usize
}

pub fn read(run: &RunTable) -> Result<Work, ModelError> {
    let column = |name: &str| run.column(name).unwrap_or_default();
    let needed = "torque_constant_nm_per_a";
    let km = run.meta().torque_constant_nm_per_a.ok_or(ModelError::MissingConstant { needed })?;
    let gear = run.meta().gear_ratio.unwrap_or(1.0);
    let (time_s, position) = (column("time_s"), column("motor_position_rad"));
    if position.iter().all(|q| *q == position[0]) {
        return Err(ModelError::Constant { column: "motor_position_rad".into() });
    }
    let step_s = sample_s(time_s);
    let starts = segments::recordings(time_s, position, step_s);
    let mut unknown = Signals::new(run.len());
    crate::preprocess::unknown_columns::keep(&mut unknown, run);
    let known =
        [("link_position_rad", Signal::Link), ("link_torque_nm", Signal::Load), ("temperature_c", Signal::Temperature)];
    let known = known.into_iter().filter_map(|(name, signal)| Some((signal, run.column(name)?)));
    let named: Vec<(Signal, &[f64])> = known.chain(unknown.iter()).collect();
    let columns: Vec<&[f64]> =
        [position, column("motor_current_a")].into_iter().chain(named.iter().map(|(_, values)| *values)).collect();
    let mut even = even(&columns, time_s, &starts, step_s);
    let columns = std::mem::take(&mut even.columns);
    let signal_hz = SIGNAL_HZ.min(MOST_OF_RATE / even.step_s);
    let corner = |signal: &Signal| match signal {
        Signal::Temperature => SLOW_HZ.min(signal_hz),
        Signal::Column(_) => UNKNOWN_HZ.min(signal_hz),
        _ => signal_hz,
    };
    let all: Vec<Signal> = [Signal::Position, Signal::Drive].into_iter().chain(named.iter().map(|n| n.0)).collect();
    let smooth: Vec<Vec<f64>> =
        columns.par_iter().zip(&all).map(|(c, signal)| filtered(c, &even, corner(signal), 2)).collect();
    let mut signals = Signals::new(even.time_s.len());
    let mut smooth = smooth.into_iter();
    let (position, current) = (smooth.next().unwrap_or_default(), smooth.next().unwrap_or_default());
    for (signal, values) in all.into_iter().skip(2).zip(smooth) {
        let scale = if signal == Signal::Load { 1.0 / gear } else { 1.0 };
        signals.set(signal, values.into_iter().map(|v| scale * v).collect());
    }
    if signals.find(Signal::Link).is_none() {
        signals.set(Signal::Link, position.iter().map(|q| q / gear).collect());
    }
    let slope = |values: &[f64]| by_recording(values, &even.starts, |range, v| derivative(&even.time_s[range], v));
    let velocity = slope(&position);
    let acceleration = slope(&velocity);
    let readings = run.column("motor_position_rad").unwrap_or_default();
    let (encoder_step, slowest_step) = (bristles::encoder_step(readings), bristles::slowest_step(readings));
    let turns = bristles::turns(&position, &even.starts, encoder_step);
    let only_direction = match turns.is_empty() {
        true => bristles::only_direction(&position, &even.starts, encoder_step),
        false => None,
    };
    let fastest = quantile(velocity.iter().map(|w| w.abs()), 0.995).max(f64::MIN_POSITIVE);
    signals.set(Signal::Jerk, slope(&acceleration));
    signals.set(Signal::Acceleration, acceleration);
    signals.set(Signal::Velocity, velocity);
    signals.set(Signal::Position, position);
    signals.set(Signal::Time, even.time_s.iter().map(|t| t - even.time_s[0]).collect());
    let torque = current.iter().map(|i| km * i).collect();
    Ok(Work { signals, torque, even, turns, only_direction, stills: Vec::new(), encoder_step, slowest_step, fastest })
}
