//! Rules that a candidate of the evidence search has to pass, one file for each rule, and the list in which they run.

pub(crate) mod dissipation;
pub(crate) mod error_reduction;
pub(crate) mod friction_direction;
pub(crate) mod model_size;
pub(crate) mod nonzero_size;
pub(crate) mod possible_size;
pub(crate) mod resolved_reach;
pub(crate) mod significance;
pub(crate) mod standard_error;
pub(crate) mod whole_error;

use crate::regression::evidence::Evidence;
use crate::regression::solution::Solution;
use crate::regression::two_stage_model::TwoStageModel;
use crate::report::reasons::RejectionReason;

/// Figures of a candidate, and the limits of the search.
#[derive(Clone, Copy)]
pub(crate) struct Figures {
    /// Share of the squared validation error that the candidate explains.
    pub gain: f64,
    /// The same in standard errors.
    pub errors: f64,
    /// p-value, corrected for all forms of the library.
    pub p_value: f64,
    /// Whether form error of the model could explain the same.
    pub form_error_imitates: bool,
    /// Family-wise error probability.
    pub alpha: f64,
    /// Whether the model has the largest number of added effects.
    pub is_full: bool,
}

impl Figures {
    pub fn of(evidence: &Evidence, alpha: f64, is_full: bool) -> Self {
        let Evidence { gain, errors, p_value, form_error_imitates, .. } = *evidence;
        Self { gain, errors, p_value, form_error_imitates, alpha, is_full }
    }
}

/// A model before and after a candidate.
pub(crate) struct Refit<'r, 'p> {
    pub now: &'r TwoStageModel<'p>,
    /// The solution before.
    pub solution: &'r Solution,
    /// Id of the candidate.
    pub id: &'r str,
    pub after: &'r TwoStageModel<'p>,
}

/// What a rule judges.
enum Test {
    /// The figures of the candidate.
    Figures(fn(&Figures) -> bool),
    /// The model before and after the candidate.
    Model(fn(&Refit) -> bool),
}

/// A rule that a candidate has to pass, with the reason for the candidates that it rejects.
struct Rule {
    reason: RejectionReason,
    test: Test,
}

/// All rules by name, in the order in which they run.
const RULES: [(&str, Rule); 10] = [
    ("significance", Rule { reason: RejectionReason::NotSignificant, test: Test::Figures(significance::passes) }),
    ("standard error", Rule { reason: RejectionReason::FewBlocks, test: Test::Figures(standard_error::passes) }),
    ("error reduction", Rule { reason: RejectionReason::FormError, test: Test::Figures(error_reduction::passes) }),
    ("model size", Rule { reason: RejectionReason::ModelFull, test: Test::Figures(model_size::passes) }),
    ("resolved reach", Rule { reason: RejectionReason::Unresolved, test: Test::Model(resolved_reach::passes) }),
    ("friction direction", Rule { reason: RejectionReason::FormError, test: Test::Model(friction_direction::passes) }),
    ("nonzero size", Rule { reason: RejectionReason::FormError, test: Test::Model(nonzero_size::passes) }),
    ("possible size", Rule { reason: RejectionReason::Implausible, test: Test::Model(possible_size::passes) }),
    ("dissipation", Rule { reason: RejectionReason::Implausible, test: Test::Model(dissipation::passes) }),
    ("whole error", Rule { reason: RejectionReason::NoReduction, test: Test::Model(whole_error::passes) }),
];

/// Why the figures of a candidate reject it. `None` for a candidate whose model has to be judged.
pub(crate) fn rejection(figures: &Figures) -> Option<RejectionReason> {
    let rejects = |rule: &Rule| matches!(rule.test, Test::Figures(passes) if !passes(figures));
    RULES.iter().map(|(_, rule)| rule).find(|rule| rejects(rule)).map(|rule| rule.reason)
}

/// Why the model with the candidate rejects it.
pub(crate) fn model_rejection(refit: &Refit) -> Option<RejectionReason> {
    let rejects = |rule: &Rule| matches!(rule.test, Test::Model(passes) if !passes(refit));
    RULES.iter().map(|(_, rule)| rule).find(|rule| rejects(rule)).map(|rule| rule.reason)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::selection::listed_rules;

    #[test]
    fn the_docs_list_the_rules_in_the_order_in_which_they_run() {
        listed_rules::check("evidence_search/rules", &RULES.map(|(name, _)| name));
    }

    #[test]
    fn the_first_rule_that_fails_gives_the_reason() {
        let good =
            Figures { gain: 0.2, errors: 3.0, p_value: 0.001, form_error_imitates: false, alpha: 0.05, is_full: false };
        assert_eq!(rejection(&good), None);
        assert_eq!(rejection(&Figures { is_full: true, ..good }), Some(RejectionReason::ModelFull));
        assert_eq!(rejection(&Figures { form_error_imitates: true, ..good }), Some(RejectionReason::FormError));
        let weak = Figures { p_value: 0.2, errors: 0.5, ..good };
        assert_eq!(rejection(&weak), Some(RejectionReason::NotSignificant));
        assert_eq!(rejection(&Figures { p_value: 0.001, ..weak }), Some(RejectionReason::FewBlocks));
    }
}
