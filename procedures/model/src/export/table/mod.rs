//! A look-up table over the signals that the model depends on most.

pub(crate) mod axes;
pub(crate) mod error;
pub(crate) mod mean;

pub use crate::export::table::error::on_run;
pub use crate::export::table::mean::curves;

use crate::ModelError;
use crate::export::parts::{Part, PartColumn, Parts};
use crate::export::table::axes::{Axis, MOST_AXES, axes};
use crate::export::{about, predict, suffix};
use crate::formula::signals::NamedSignal;
use crate::report::fit::{Fit, MeanCurve, Scope};
use crate::signal::Signal;
use crate::user_effects::signals_with;
use std::fmt::Write;

const ANGLES: [Signal; 2] = [Signal::Position, Signal::Link];
/// Temperature at which temperature effects are zero [°C].
const REFERENCE_C: f64 = 25.0;

/// The part of a model in a table, and its axes.
pub(crate) struct Layout<'f> {
    /// The static effects of the table; hysteresis effects are added as mean curves.
    still: Fit,
    means: Vec<&'f MeanCurve>,
    parts: Parts<'f>,
    signals: Vec<NamedSignal>,
    axes: Vec<Axis>,
    scope: &'f Scope,
}

impl<'f> Layout<'f> {
    /// At most two axes; every other signal is at rest. Effects of an angle without an axis are omitted. Hysteresis
    /// effects are replaced by their mean curves, because their steady state depends on the history.
    fn of(fit: &'f Fit) -> Result<Self, ModelError> {
        let scope = fit.scope.as_ref().ok_or(ModelError::NoScope)?;
        let mut parts = Parts::of(fit)?;
        let remembers = |column: &PartColumn| !matches!(column, PartColumn::Formula(_));
        let (states, settled): (Vec<_>, Vec<_>) = parts.parts.drain(..).partition(|p| p.columns.iter().any(remembers));
        parts.parts = settled;
        let signals = signals_with(fit.kind, &fit.user_effects);
        // Mean curves need the axis of their signal, too.
        let (held, gone): (Vec<_>, Vec<_>) = states.into_iter().partition(|p| mean_of(scope, p.effect).is_some());
        let count = parts.parts.len();
        parts.parts.extend(held);
        let axes = axes(fit.kind, &signals, scope, &parts);
        let mut held = parts.parts.split_off(count);
        // A wave over an angle without an axis is omitted, because its value at angle zero is arbitrary.
        let has_axis = |signal: Signal| axes.iter().any(|axis| axis.signal.signal == signal);
        let waves = |p: &Part| ANGLES.into_iter().any(|angle| p.uses(angle) && !has_axis(angle));
        let (turning, standing): (Vec<_>, Vec<_>) = parts.parts.drain(..).partition(waves);
        parts.parts = standing;
        let mut leave_out = |parts_of: &[Part<'f>], why: &str| {
            parts.left_out.extend(parts_of.iter().map(|part| (part.effect, why.to_owned())));
        };
        leave_out(&turning, "it turns with an angle, for which the table has no axis");
        let is_old = |part: &Part| crate::export::load_noise::remembered(part).is_some_and(mean::has_ways);
        let (old, forgotten): (Vec<_>, Vec<_>) = gone.into_iter().partition(is_old);
        leave_out(&forgotten, "it remembers; settled it is zero");
        leave_out(&old, "it remembers, and this file does not hold its mean: fit again with this version");
        let means: Vec<&MeanCurve> = held.iter().filter_map(|part| mean_of(scope, part.effect)).collect();
        let still = Fit {
            effects: fit.effects.iter().filter(|id| parts.parts.iter().any(|p| p.effect == *id)).cloned().collect(),
            terms: fit.terms.iter().filter(|t| parts.parts.iter().any(|p| p.effect == t.effect)).cloned().collect(),
            ..fit.clone()
        };
        parts.parts.append(&mut held);
        Ok(Self { still, means, parts, signals, axes, scope })
    }

    /// Every combination of some values of each axis, the last axis fastest.
    fn rows(&self, values: impl Fn(&Axis, usize) -> Vec<f64>) -> Vec<Vec<f64>> {
        self.axes.iter().enumerate().fold(vec![Vec::new()], |rows, (place, axis)| {
            let values = values(axis, place);
            rows.iter().flat_map(|row| values.iter().map(move |p| [row.as_slice(), &[*p]].concat())).collect()
        })
    }

    fn grid(&self) -> Vec<Vec<f64>> {
        self.rows(|axis, _| axis.points.clone())
    }

    /// The tabulated quantity at any point of the axes.
    fn predict(&self, rows: &[Vec<f64>]) -> Result<Vec<f64>, ModelError> {
        let axis = |signal: Signal| self.axes.iter().position(|axis| axis.signal.signal == signal);
        let column = |signal: &NamedSignal| match (axis(signal.signal), axis(Signal::Velocity)) {
            (Some(axis), _) => rows.iter().map(|row| row[axis]).collect(),
            // The direction follows the velocity.
            (None, Some(axis)) if signal.signal == Signal::Direction => rows.iter().map(|r| r[axis].signum()).collect(),
            (None, None) if signal.signal == Signal::Direction => vec![1.0; rows.len()],
            _ => vec![rest(signal, self.scope); rows.len()],
        };
        let moments: Vec<(&str, Vec<f64>)> = self.signals.iter().map(|s| (s.name, column(s))).collect();
        let mut values = predict(&self.still, &moments, self.scope.sample_s)?;
        for mean in &self.means {
            let over = moments.iter().find(|(name, _)| *name == mean.signal).map_or(&[][..], |(_, x)| x);
            values.iter_mut().zip(over).for_each(|(value, x)| *value += mean.value(*x));
        }
        Ok(values)
    }

    /// Linear interpolation in the values of the grid. It is called for every sample of a run, so that it does not
    /// allocate.
    fn interpolate(&self, values: &[f64], at: impl Fn(usize) -> f64) -> f64 {
        let mut corners = [(0, 0.0); 1 << MOST_AXES];
        corners[0].1 = 1.0;
        for (number, axis) in self.axes.iter().enumerate() {
            let (cell, share) = axis.place(at(number));
            for place in 0..1 << number {
                let (corner, weight) = corners[place];
                let corner = corner * axis.points.len() + cell;
                corners[place] = (corner, weight * (1.0 - share));
                corners[place + (1 << number)] = (corner + 1, weight * share);
            }
        }
        corners[..1 << self.axes.len()].iter().map(|(corner, weight)| weight * values[*corner]).sum()
    }

    /// Accuracy of the table, one line each.
    fn worth(&self, fit: &Fit, values: &[f64]) -> Result<Vec<String>, ModelError> {
        let unit = &fit.unit;
        let of_model = format!("of the whole model {}", super::error(fit));
        let mut lines = vec![match self.scope.table_rms {
            Some(rms) => format!("Error: of this table {rms:.4e} {unit} rms on the run that was fitted; {of_model}"),
            None => format!("Error: of this table not known, for the fit did not measure it; {of_model}"),
        }];
        if let Some([rms, most]) = error::between(self, values)? {
            lines.push(format!(
                "Read in straight lines between its points, it is off what it is a table of by {rms:.4e} {unit} rms, {most:.4e} at \
                 most"
            ));
        }
        let has_velocity_axis = self.axes.iter().any(|axis| axis.signal.signal == Signal::Velocity);
        if has_velocity_axis && self.parts.uses(Signal::Direction) {
            lines.push(
                "The direction is the sign of the velocity: noise about standstill turns it round and round".to_owned(),
            );
        }
        if self.axes.iter().any(Axis::is_angle) {
            lines.push("An angle is periodic: look it up without its whole turns".to_owned());
        }
        lines.extend(self.means.iter().map(|mean| {
            format!(
                "{} remembers: the table holds its mean over {} on that run, off which it was by {:.4e} {unit} rms",
                mean.effect, mean.signal, mean.off_rms
            )
        }));
        Ok(lines)
    }
}

fn mean_of<'f>(scope: &'f Scope, effect: &str) -> Option<&'f MeanCurve> {
    scope.means.iter().find(|mean| mean.effect == effect)
}

/// CSV with comments.
pub fn table(fit: &Fit) -> Result<String, ModelError> {
    let layout = Layout::of(fit)?;
    let (grid, scope) = (layout.grid(), layout.scope);
    let values = layout.predict(&grid)?;
    let mut text = String::new();
    about(fit, &layout.parts, &layout.parts.left_out, layout.worth(fit, &values)?).iter().for_each(|words| {
        let _ = writeln!(text, "# {words}");
    });
    let has_axis = |s: &NamedSignal| layout.axes.iter().any(|axis| axis.signal == *s);
    let rests = |s: &&NamedSignal| s.signal != Signal::Direction && layout.parts.uses(s.signal) && !has_axis(s);
    let resting: Vec<String> =
        layout.signals.iter().filter(rests).map(|s| format!("{} = {} {}", s.name, rest(s, scope), s.unit)).collect();
    if !resting.is_empty() {
        let _ = writeln!(text, "# At rest: {}", resting.join(", "));
    }
    let label = |signal: &NamedSignal| suffix::named(signal.name, &scope.motion.label(signal.unit));
    let mut names: Vec<String> = layout.axes.iter().map(|axis| label(&axis.signal)).collect();
    names.push(suffix::named(crate::export::quantity(fit.kind), &fit.unit));
    let _ = writeln!(text, "{}", names.join(","));
    for (row, value) in grid.iter().zip(values) {
        let fields: Vec<String> = row.iter().chain([&value]).map(f64::to_string).collect();
        let _ = writeln!(text, "{}", fields.join(","));
    }
    Ok(text)
}

/// Rounded to four digits.
fn rounded(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}

/// Fixed value of a signal without an axis.
fn rest(signal: &NamedSignal, scope: &Scope) -> f64 {
    let range = scope.signals.iter().find(|r| r.name == signal.name);
    match (signal.signal, range) {
        (Signal::Temperature, _) => REFERENCE_C,
        // The typical value of an unknown column is only known from the data.
        (Signal::Column(_), Some(range)) => rounded(0.5 * (range.min + range.max)),
        _ => 0.0,
    }
}
