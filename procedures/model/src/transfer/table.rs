//! A look-up table over the signals that the model depends on most.

use super::parts::{Part, PartColumn, Parts};
use super::{about, predict, suffix};
use crate::ModelError;
use crate::formula::NamedSignal;
use crate::own::signals_with;
use crate::report::{Fit, Scope, SignalRange};
use crate::view::Signal;
use jointbench_instrument::Kind;
use std::fmt::Write;

/// Points of an axis that begins where the data begins.
const EVEN: usize = 21;
/// Points of each direction on a speed axis: a tenth of a decade apart over three decades.
const DECADES: f64 = 3.0;
const EACH_DECADE: usize = 10;
const ANGLES: [Signal; 2] = [Signal::Position, Signal::Link];
/// Where temperature effects are zero [°C].
const REFERENCE_C: f64 = 25.0;

/// CSV with comments. At most two axes; every other signal rests. Effects that remember are left out, because the table
/// holds the settled value, and those that turn with an angle that has no axis.
pub fn table(fit: &Fit) -> Result<String, ModelError> {
    let scope = fit.scope.as_ref().ok_or(ModelError::NoScope)?;
    let mut parts = Parts::of(fit)?;
    let remembers = |column: &PartColumn| !matches!(column, PartColumn::Formula(_));
    let (states, settled): (Vec<_>, Vec<_>) = parts.parts.drain(..).partition(|p| p.columns.iter().any(remembers));
    parts.left_out.extend(states.iter().map(|p| (p.effect, "it remembers; the table holds the settled value".into())));
    parts.parts = settled;
    let signals = signals_with(fit.kind, &fit.own);
    let axes = axes(fit.kind, &signals, scope, &parts);
    // No angle stands for all of a wave: at rest it would be whatever it is at 0.
    let has_axis = |signal: Signal| axes.iter().any(|(axis, _)| axis.signal == signal);
    let waves = |p: &Part| ANGLES.into_iter().any(|angle| p.uses(angle) && !has_axis(angle));
    let (turning, held): (Vec<_>, Vec<_>) = parts.parts.drain(..).partition(waves);
    parts
        .left_out
        .extend(turning.iter().map(|p| (p.effect, "it turns with an angle, for which the table has no axis".into())));
    parts.parts = held;
    let still = Fit {
        effects: fit.effects.iter().filter(|id| parts.parts.iter().any(|p| p.effect == *id)).cloned().collect(),
        terms: fit.terms.iter().filter(|t| parts.parts.iter().any(|p| p.effect == t.effect)).cloned().collect(),
        ..fit.clone()
    };
    let grid: Vec<Vec<f64>> = axes.iter().fold(vec![Vec::new()], |rows, (_, points)| {
        rows.iter().flat_map(|row| points.iter().map(move |p| [row.as_slice(), &[*p]].concat())).collect()
    });
    let column = |signal: &NamedSignal| match axes.iter().position(|(axis, _)| axis.signal == signal.signal) {
        Some(axis) => grid.iter().map(|row| row[axis]).collect(),
        None if signal.signal == Signal::Direction => match axes.iter().position(|(a, _)| a.signal == Signal::Velocity)
        {
            Some(axis) => grid.iter().map(|row| row[axis].signum()).collect(),
            None => vec![1.0; grid.len()],
        },
        None => vec![rest(signal, scope); grid.len()],
    };
    let moments: Vec<(&str, Vec<f64>)> = signals.iter().map(|s| (s.name, column(s))).collect();
    let values = predict(&still, &moments, scope.sample_s)?;

    let mut text = String::new();
    about(fit, &parts, &parts.left_out).iter().for_each(|words| {
        let _ = writeln!(text, "# {words}");
    });
    // The direction follows the velocity.
    let rests =
        |s: &&NamedSignal| s.signal != Signal::Direction && parts.uses(s.signal) && !axes.iter().any(|(a, _)| a == s);
    let resting: Vec<String> =
        signals.iter().filter(rests).map(|s| format!("{} = {} {}", s.name, rest(s, scope), s.unit)).collect();
    if !resting.is_empty() {
        let _ = writeln!(text, "# At rest: {}", resting.join(", "));
    }
    let mut names: Vec<String> = axes.iter().map(|(s, _)| suffix::named(s.name, &scope.motion.label(s.unit))).collect();
    names.push(suffix::named(super::quantity(fit.kind), &fit.unit));
    let _ = writeln!(text, "{}", names.join(","));
    for (row, value) in grid.iter().zip(values) {
        let fields: Vec<String> = row.iter().chain([&value]).map(f64::to_string).collect();
        let _ = writeln!(text, "{}", fields.join(","));
    }
    Ok(text)
}

/// To four digits.
fn rounded(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}

/// What a signal is held at.
fn rest(signal: &NamedSignal, scope: &Scope) -> f64 {
    let range = scope.signals.iter().find(|r| r.name == signal.name);
    match (signal.signal, range) {
        (Signal::Temperature, _) => REFERENCE_C,
        // Nobody knows what is usual but the data.
        (Signal::Column(_), Some(range)) => rounded(0.5 * (range.min + range.max)),
        _ => 0.0,
    }
}

/// The first two signals in the order in which a controller needs them, with their points.
fn axes<'s>(kind: Kind, signals: &'s [NamedSignal], scope: &Scope, parts: &Parts) -> Vec<(&'s NamedSignal, Vec<f64>)> {
    let order: &[Signal] = match kind {
        Kind::Friction => &[Signal::Velocity, Signal::Load, Signal::Temperature, Signal::Link, Signal::Position],
        Kind::Encoder => &[Signal::Position, Signal::Velocity, Signal::Direction, Signal::Temperature],
        Kind::Stiffness => &[Signal::Load, Signal::Direction, Signal::Link, Signal::Temperature],
        Kind::Brake => &[Signal::Current, Signal::Velocity, Signal::Position, Signal::Temperature],
    };
    let used = |signal: Signal| {
        parts.uses(signal) || kind == Kind::Friction && signal == Signal::Velocity && parts.uses(Signal::Direction)
    };
    let named = |signal: &Signal| signals.iter().find(|s| s.signal == *signal);
    let others = signals.iter().map(|s| s.signal).filter(|s| matches!(s, Signal::Column(_)));
    let order: Vec<Signal> = order.iter().copied().chain(others).collect();
    let mut axes: Vec<_> = order
        .iter()
        .filter(|s| used(**s))
        .filter_map(named)
        .filter_map(|signal| {
            let range = scope.signals.iter().find(|r| r.name == signal.name)?;
            Some((signal, points(signal.signal, range)))
        })
        .collect();
    axes.truncate(2);
    axes
}

fn points(signal: Signal, range: &SignalRange) -> Vec<f64> {
    let peak = range.min.abs().max(range.max.abs());
    match signal {
        Signal::Direction => vec![-1.0, 1.0],
        Signal::Velocity => {
            let steps = (DECADES * EACH_DECADE as f64) as i32;
            let speed = |k: i32| peak * 10f64.powf(f64::from(k - steps) / EACH_DECADE as f64);
            (0..=steps).rev().map(|k| -speed(k)).chain((0..=steps).map(speed)).collect()
        }
        // A turn is a turn.
        Signal::Position | Signal::Link => (0..=90).map(|k| f64::from(k) * std::f64::consts::TAU / 90.0).collect(),
        _ => {
            let step = (range.max - range.min) / (EVEN - 1) as f64;
            (0..EVEN).map(|k| range.min + step * k as f64).collect()
        }
    }
}
