//! Upper limits of effects that were not found, and effects that a run could hardly show.

use crate::effects::{self, excitation};
use crate::report::diagnosis::{Diagnosis, Discovery, Silent};
use crate::report::fit::Fit;
use crate::report::reasons::{Invisible, InvisibleReason};
use crate::thresholds::{DETECTION_POWER, WORTH_SEEING};
use crate::words::percent;

/// Quantiles of the standard normal distribution: two-sided 95 %, one-sided 95 % and 80 %.
const Z: [f64; 3] = [1.960, 1.645, 0.842];

/// Size that is found with 95 % power, as a multiple of the detection limit (80 %), with the critical size of a single
/// test. A test of many effects has a larger critical size, and a smaller multiple.
const UPPER_LIMIT: f64 = (Z[0] + DETECTION_POWER * Z[1] / Z[2]) / (Z[0] + DETECTION_POWER);

impl Diagnosis {
    /// Each effect that was not found with its upper limit. Those that the run could hardly show are not testable:
    /// their detection limit exceeds [`WORTH_SEEING`] of the measured signal.
    #[must_use]
    pub fn bounded(mut self) -> Self {
        (self.silent, self.not_visible) = bounded(&self.fit, self.silent, self.not_visible);
        self
    }
}

impl Discovery {
    /// As [`Diagnosis::bounded`].
    #[must_use]
    pub fn bounded(mut self) -> Self {
        (self.silent, self.not_visible) = bounded(&self.fit, self.silent, self.not_visible);
        self
    }
}

fn bounded(fit: &Fit, silent: Vec<Silent>, mut not_visible: Vec<Invisible>) -> (Vec<Silent>, Vec<Invisible>) {
    // Without a residual the signal has no known size, and everything is detectable.
    let signal_rms = fit.rms / fit.relative_error;
    let (hidden, mut tested): (Vec<_>, Vec<_>) =
        silent.into_iter().partition(|one| one.minimum_detectable_rms > WORTH_SEEING * signal_rms);
    for one in &mut tested {
        one.upper_rms = Some(UPPER_LIMIT * one.minimum_detectable_rms);
    }
    not_visible.extend(hidden.into_iter().map(|one| {
        let [limit, bound] = [one.minimum_detectable_rms / signal_rms, WORTH_SEEING].map(percent);
        // Noise cannot hide what is larger than the residual; effects of the model can.
        let cure = match effects::find(fit.kind, &one.effect).ok().filter(|_| one.minimum_detectable_rms > fit.rms) {
            Some(effect) => format!(
                "this data hardly distinguishes it from the effects of the model; to distinguish them, measure {}",
                excitation(effect)
            ),
            None => "measure more repeats, or a wider range".to_owned(),
        };
        let why = match limit == bound {
            true => format!("the detection limit is just above the bound of {bound} of the measured signal; {cure}"),
            false => {
                format!("the detection limit is {limit} of the measured signal, above the bound of {bound}; {cure}")
            }
        };
        Invisible { effect: one.effect, reason: InvisibleReason::DetectionLimit, why }
    }));
    (tested, not_visible)
}
