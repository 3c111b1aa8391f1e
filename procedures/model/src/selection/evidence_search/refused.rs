//! Results of the evidence beyond the named effects: unexplained structure, and rejected effects.

use crate::report::reasons::RejectionReason;
use crate::residual_analysis::structure::Unexplained;
use crate::selection::evidence_search::rules::error_reduction::least_share;
use crate::selection::evidence_search::rules::{self, Figures};
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
    pub figures: Figures,
    pub reason: RejectionReason,
}

impl<'p> Refused<'p> {
    /// A candidate whose figures pass was rejected with its model, in which form error explains as much.
    pub fn of(effect: &'p str, figures: Figures) -> Self {
        Self { effect, figures, reason: rules::rejection(&figures).unwrap_or(RejectionReason::FormError) }
    }

    /// The reason in words, with the error reduction.
    pub fn words(&self) -> String {
        let Figures { gain, p_value, form_error_imitates, .. } = self.figures;
        let least = least_share(form_error_imitates);
        let but = match self.reason {
            RejectionReason::NotSignificant => format!("which is not significant (p = {p_value:.2})"),
            RejectionReason::FewBlocks => "but only in a few blocks".into(),
            RejectionReason::ModelFull => "but the largest number of added effects is reached".into(),
            _ if gain <= least => {
                let required = percent(least);
                format!("but form error of the model could explain the same; at least {required} is required")
            }
            _ => "but form error of the model explains as much".into(),
        };
        format!("it would reduce the squared validation error by {}, {but}", percent(gain))
    }
}
