//! Results of the evidence beyond the named effects: unexplained structure, and rejected effects.

use crate::report::reasons::RejectionReason;
use crate::residual_analysis::structure::Unexplained;
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
    /// Error reduction that would be required.
    pub least: f64,
    /// `gain` is relative to a model without the nuisance terms that imitate the effect.
    pub is_without_form_error: bool,
    pub reason: RejectionReason,
}

impl Refused<'_> {
    /// The reason in words, with the error reduction.
    pub fn words(&self) -> String {
        let but = match self.reason {
            RejectionReason::NotSignificant => format!("which is not significant (p = {:.2})", self.p_value),
            RejectionReason::FewBlocks => "but only in a few blocks".into(),
            RejectionReason::NoReduction => "but the error over all samples increases".into(),
            RejectionReason::Unresolved => "but it acts within the shortest displacement that this run resolves".into(),
            RejectionReason::Implausible => "but its size would be physically impossible".into(),
            RejectionReason::ModelFull => "but the largest number of added effects is reached".into(),
            _ if self.gain <= self.least => {
                let required = percent(self.least);
                format!("but the nuisance terms of the model could explain the same; at least {required} is required")
            }
            _ => "but the nuisance terms of the model explain as much".into(),
        };
        let base = if self.is_without_form_error { "without the nuisance terms that imitate it, " } else { "" };
        format!("{base}it would reduce the squared validation error by {}, {but}", percent(self.gain))
    }
}
