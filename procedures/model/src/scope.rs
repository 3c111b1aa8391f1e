//! Where a fit holds, and what lies beyond.

use crate::formula::{NamedSignal, signals};
use crate::prepare::Prepared;
use crate::report::{Scope, SignalRange};
use crate::view::Signal;
use crate::words::{figure, percent};

/// So far beyond a range, as a share of it, is not beyond.
const MARGIN: f64 = 0.02;

/// A smaller share of the points beyond is not worth a word.
const WORTH_A_WORD: f64 = 0.01;

impl Scope {
    pub(crate) fn of(prepared: &Prepared) -> Self {
        let view = &prepared.main.view;
        let range = |s: &NamedSignal| {
            let values = view.find(s.signal)?;
            let (min, max) = values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
            Some(SignalRange { name: s.name.into(), unit: prepared.motion.label(s.unit), min, max })
        };
        Self {
            motion: prepared.motion,
            load_scale: prepared.load_scale,
            sample_s: view.sample_s,
            signals: signals(prepared.kind).iter().filter_map(range).collect(),
        }
    }

    /// The signals of another run that leave the ranges of this fit, in sentences: there the model is an extrapolation.
    pub(crate) fn left_by(&self, prepared: &Prepared) -> Vec<String> {
        let say = |range: &SignalRange| {
            let signal = signals(prepared.kind).iter().find(|s| s.name == range.name)?.signal;
            // Every run has its own moments, an angle goes round, and the torque of the drive is what is predicted.
            let other = [Signal::Time, Signal::Repeat, Signal::Position, Signal::Link, Signal::Drive].contains(&signal);
            let values = prepared.main.view.find(signal).filter(|_| !other)?;
            let scale = if signal == Signal::Load { self.load_scale } else { 1.0 };
            let margin = MARGIN * (range.max - range.min);
            let inside = range.min - margin..=range.max + margin;
            let beyond = values.iter().filter(|v| !inside.contains(v)).count() as f64 / values.len().max(1) as f64;
            (beyond > WORTH_A_WORD).then(|| {
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
