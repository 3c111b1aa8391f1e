//! Axes of a look-up table, and their points.

use crate::export::parts::{PartColumn, Parts};
use crate::formula::expression::{Expression, What};
use crate::formula::signals::NamedSignal;
use crate::report::fit::{Scope, SignalRange};
use crate::signal::{Signal, Signals};
use jointbench_instrument::Kind;
use std::f64::consts::TAU;

/// Largest number of axes: controllers rarely interpolate over more.
pub const MOST_AXES: usize = 2;
/// Points of an axis over a data range.
const EVEN: usize = 21;
/// Points of each direction on a speed axis: a tenth of a decade apart, over three decades.
const DECADES: f64 = 3.0;
const EACH_DECADE: usize = 10;
/// Cells of a turn without fast waves.
const CELLS: f64 = 90.0;
/// Cells for each period of the fastest wave: linear interpolation has an error below two hundredths of its
/// amplitude.
const EACH_WAVE: f64 = 16.0;
/// Largest number of cells of a table; its header states the resulting error.
const MOST_CELLS: f64 = 4096.0;

#[derive(Debug)]
pub struct Axis {
    pub signal: NamedSignal,
    pub points: Vec<f64>,
}

impl Axis {
    pub fn is_angle(&self) -> bool {
        matches!(self.signal.signal, Signal::Position | Signal::Link)
    }

    pub fn place(&self, value: f64) -> (usize, f64) {
        cell(&self.points, if self.is_angle() { value.rem_euclid(TAU) } else { value })
    }
}

/// The cell that contains a value, by its first point, and the relative position within it. Beyond the ends the value
/// of the end applies.
pub fn cell(points: &[f64], value: f64) -> (usize, f64) {
    let cell = points.partition_point(|p| *p <= value).clamp(1, points.len() - 1) - 1;
    let (from, to) = (points[cell], points[cell + 1]);
    (cell, if to > from { ((value - from) / (to - from)).clamp(0.0, 1.0) } else { 0.0 })
}

/// The first signals, in the order in which a controller needs them.
pub fn axes(kind: Kind, signals: &[NamedSignal], scope: &Scope, parts: &Parts) -> Vec<Axis> {
    let order: &[Signal] = match kind {
        Kind::Friction => &[Signal::Velocity, Signal::Load, Signal::Temperature, Signal::Link, Signal::Position],
        Kind::Encoder => &[Signal::Position, Signal::Velocity, Signal::Direction, Signal::Temperature],
        Kind::Stiffness => &[Signal::Load, Signal::Direction, Signal::Link, Signal::Temperature],
        Kind::Brake => &[Signal::Current, Signal::Velocity, Signal::Position, Signal::Temperature],
    };
    let used = |signal: &Signal| {
        parts.uses(*signal) || kind == Kind::Friction && *signal == Signal::Velocity && parts.uses(Signal::Direction)
    };
    let others = signals.iter().map(|s| s.signal).filter(|s| matches!(s, Signal::Column(_)));
    let order = order.iter().copied().chain(others).filter(used);
    let axis = |signal: Signal| {
        let signal = *signals.iter().find(|s| s.signal == signal)?;
        let range = scope.signals.iter().find(|r| r.name == signal.name)?;
        Some(Axis { points: points(signal.signal, range, parts), signal })
    };
    order.filter_map(axis).take(MOST_AXES).collect()
}

fn points(signal: Signal, range: &SignalRange, parts: &Parts) -> Vec<f64> {
    let peak = range.min.abs().max(range.max.abs());
    match signal {
        Signal::Direction => vec![-1.0, 1.0],
        Signal::Velocity => {
            let steps = (DECADES * EACH_DECADE as f64) as i32;
            let speed = |k: i32| peak * 10f64.powf(f64::from(k - steps) / EACH_DECADE as f64);
            (0..=steps).rev().map(|k| -speed(k)).chain((0..=steps).map(speed)).collect()
        }
        // Angles cover a whole turn.
        Signal::Position | Signal::Link => {
            let cells = (EACH_WAVE * fastest_wave(parts, signal)).ceil().clamp(CELLS, MOST_CELLS) as u32;
            (0..=cells).map(|k| f64::from(k) * TAU / f64::from(cells)).collect()
        }
        _ => even(range),
    }
}

/// Even points over a range.
pub fn even(range: &SignalRange) -> Vec<f64> {
    let step = (range.max - range.min) / (EVEN - 1) as f64;
    (0..EVEN).map(|k| range.min + step * k as f64).collect()
}

/// Largest number of waves of any part in a turn of an angle.
fn fastest_wave(parts: &Parts, angle: Signal) -> f64 {
    let mut most = 0.0f64;
    for part in &parts.parts {
        let shape: Vec<f64> = part.shape.iter().map(|(_, value)| *value).collect();
        for column in &part.columns {
            let PartColumn::Formula(formula) = column else { continue };
            formula.any(&mut |what| {
                if let What::Call(function, arguments) = what
                    && function.is_periodic()
                    && let Some(inner) = arguments.first().filter(|inner| inner.uses_signal(angle))
                {
                    // `max` ignores NaN.
                    most = most.max(slope(inner, angle, &shape).abs());
                }
                false
            });
        }
    }
    most
}

/// Derivative of an expression with respect to an angle, with all other signals at rest.
fn slope(expression: &Expression, angle: Signal, shape: &[f64]) -> f64 {
    let mut signals = Signals::new(2);
    Signal::ALL.into_iter().for_each(|other| signals.set(other, vec![0.0; 2]));
    signals.set(angle, vec![0.0, 1.0]);
    let ends = expression.column(shape, &signals);
    ends[1] - ends[0]
}
