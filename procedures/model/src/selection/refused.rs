//! Results of the evidence beyond the named effects: unexplained structure, and rejected effects.

use crate::effect::{Effect, Regime};
use crate::regression::evidence::{self, Evidence};
use crate::report::reasons::RejectionReason;
use crate::residual_analysis::structure::Unexplained;
use crate::thresholds::ONE_ERROR;
use crate::words::percent;

/// Findings that remain after the decision.
pub struct EvidenceResult<'p> {
    /// Structure that no effect explains.
    pub left: Option<Unexplained>,
    pub refused: Vec<Refused<'p>>,
}

/// A rejected effect with a large error reduction.
pub struct Refused<'p> {
    pub effect: &'p str,
    pub gain: f64,
    pub p_value: f64,
    pub alpha: f64,
    pub errors: f64,
    /// Error reduction that would be required.
    pub least: f64,
    /// Whether the model already has the largest number of added effects.
    pub is_full: bool,
}

impl<'p> Refused<'p> {
    pub fn of(evidence: &Evidence<'_, 'p>, alpha: f64, is_full: bool) -> Self {
        Self {
            effect: evidence.best.id(),
            gain: evidence.gain,
            p_value: evidence.p_value,
            alpha,
            errors: evidence.errors,
            least: evidence.least_share(),
            is_full,
        }
    }

    /// Why it is rejected, and the same in words with the error reduction.
    pub fn reason(&self) -> (RejectionReason, String) {
        let (reason, but) = match () {
            () if self.p_value >= self.alpha => {
                (RejectionReason::NotSignificant, format!("which is not significant (p = {:.2})", self.p_value))
            }
            () if self.errors <= ONE_ERROR => (RejectionReason::FewBlocks, "but only in a few blocks".into()),
            () if self.gain <= self.least => {
                let required = percent(self.least);
                let but =
                    format!("but form error of the model could explain the same; at least {required} is required");
                (RejectionReason::FormError, but)
            }
            () if !self.is_full => (RejectionReason::FormError, "but form error of the model explains as much".into()),
            () => (RejectionReason::ModelFull, "but the largest number of added effects is reached".into()),
        };
        (reason, format!("it would reduce the squared validation error by {}, {but}", percent(self.gain)))
    }
}

/// An effect of transients competes with the form error of all models: it has to explain most of the residual.
pub fn least_share(effect: &dyn Effect) -> f64 {
    evidence::least_share(effect.regime() != Regime::SteadyState)
}
