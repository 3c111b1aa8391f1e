//! Range of validity of a fit, and the conditions of another run that exceed it.

use crate::formula::signals::NamedSignal;
use crate::preprocess::Prepared;
use crate::report::fit::{Fit, GivenConstant, Scope, SignalRange};
use crate::signal::Signal;
use crate::thresholds::{BEYOND_SHARE, RANGE_MARGIN};
use crate::user_effects::{UserEffect, find_with_user_effects, signals_with};
use crate::view::View;
use crate::words::{figure, percent};

impl Scope {
    pub(crate) fn of(prepared: &Prepared, user_effects: &[UserEffect]) -> Self {
        let view = &prepared.main.view;
        let range = |s: &NamedSignal| {
            // Steady-state motion has no acceleration; effects of acceleration were fitted to the ramps.
            let of_ramps = matches!(s.signal, Signal::Acceleration | Signal::Jerk);
            let ramps = prepared.moving.as_ref().filter(|_| of_ramps).and_then(|m| m.view.find(s.signal));
            let values = view.find(s.signal)?.iter().chain(ramps.into_iter().flatten());
            let (min, max) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
            let noise = (s.signal == Signal::Load).then(|| noise(view)).flatten();
            Some(SignalRange { name: s.name.into(), unit: prepared.motion.label(s.unit), min, max, noise })
        };
        Self {
            motion: prepared.motion,
            load_scale: prepared.load_scale,
            sample_s: view.sample_s,
            signals: signals_with(prepared.kind, user_effects).iter().filter_map(range).collect(),
            constants: prepared.constants.clone(),
            fed_rms: None,
            means: Vec::new(),
            table_rms: None,
        }
    }

    /// Limitations of the error of a fit on another run, in sentences.
    pub(crate) fn notes(&self, fit: &Fit, prepared: &Prepared) -> Vec<String> {
        let effects = fit.effects.iter().filter_map(|id| self.other_columns(fit, id, prepared));
        effects.chain(self.other_constants(prepared)).chain(self.left_by(prepared, &fit.user_effects)).collect()
    }

    /// An effect that this run cannot show but the fitted run could, or the reverse.
    fn other_columns(&self, fit: &Fit, id: &str, prepared: &Prepared) -> Option<String> {
        let effect = find_with_user_effects(fit.kind, &fit.user_effects, id).ok()?;
        if !effect.traits().is_offset {
            let is_fitted = fit.terms.iter().any(|t| t.effect == id);
            return (!is_fitted).then(|| format!("{id} counts as zero: the run that was fitted could not show it"));
        }
        let column = effect.info().needs.first()?;
        let signal = signals_with(fit.kind, &fit.user_effects).into_iter().find(|s| s.column == *column)?;
        let was_there = self.signals.iter().any(|s| s.name == signal.name);
        match (was_there, effect.missing(&prepared.main.view)) {
            (true, Some(column)) => Some(format!(
                "{id} is omitted, because the run has no column {column}: the effect of any link load counts as model error; add the column, or use the figure for an unloaded joint only"
            )),
            (false, None) => Some(format!(
                "{id} counts here, but the run that was fitted had no column {column}: if its link carried a load, the \
                 other effects have taken it in; fit again with that column"
            )),
            _ => None,
        }
    }

    /// Constants of the set-up that differ from those of the fitted run.
    fn other_constants(&self, prepared: &Prepared) -> Vec<String> {
        let here = |name: &str| prepared.constants.iter().find(|c| c.name == name).map(|c| c.value);
        let differ = |a: f64, b: f64| (a - b).abs() > 1e-9 * a.abs().max(b.abs());
        let say = |c: &GivenConstant| match here(&c.name) {
            Some(value) if differ(value, c.value) => Some(format!(
                "{} is {value} in the facts of this run and {} in those of the fitted one: of one joint only one can be \
                 right, and the error counts the difference as the model's; correct the meta file that is wrong, or fit \
                 this joint's own model",
                c.name, c.value
            )),
            Some(_) => None,
            None => Some(format!(
                "{} is {} in the facts of the fitted run and missing in those of this one",
                c.name, c.value
            )),
        };
        self.constants.iter().filter_map(say).collect()
    }

    /// Signals of another run that exceed the ranges of this fit, in sentences: there the model extrapolates.
    fn left_by(&self, prepared: &Prepared, user_effects: &[UserEffect]) -> Vec<String> {
        let named = signals_with(prepared.kind, user_effects);
        let say = |range: &SignalRange| {
            let signal = named.iter().find(|s| s.name == range.name)?.signal;
            // Time differs between runs, angles are periodic, and the drive torque is the response.
            let other = [Signal::Time, Signal::Repeat, Signal::Position, Signal::Link, Signal::Drive].contains(&signal);
            let values = prepared.main.view.find(signal).filter(|_| !other)?;
            let scale = if signal == Signal::Load { self.load_scale } else { 1.0 };
            let margin = RANGE_MARGIN * (range.max - range.min);
            let inside = range.min - margin..=range.max + margin;
            let beyond = values.iter().filter(|v| !inside.contains(v)).count() as f64 / values.len().max(1) as f64;
            (beyond > BEYOND_SHARE).then(|| {
                format!(
                    "{} of the points lie outside the {} that the model was fitted to ({} to {}): there it is an \
                     extrapolation",
                    percent(beyond),
                    range.name.replace('_', " "),
                    figure(scale * range.min, &range.unit),
                    figure(scale * range.max, &range.unit),
                )
            })
        };
        self.signals.iter().filter_map(say).collect()
    }
}

/// RMS of the noise that smoothing removed from the load. Samples outside of legs are not smoothed, so that they do
/// not count.
fn noise(view: &View) -> Option<f64> {
    let smooth = view.samples.find(Signal::Load)?;
    let off = view
        .measured_load
        .as_ref()?
        .iter()
        .zip(smooth)
        .map(|(measured_load, smooth)| measured_load - smooth)
        .filter(|off| *off != 0.0);
    let (count, square) = off.fold((0, 0.0), |(n, sum), off| (n + 1, sum + off * off));
    Some((square / f64::from(count.max(1))).sqrt())
}
