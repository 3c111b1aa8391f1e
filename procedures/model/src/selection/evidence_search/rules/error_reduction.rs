//! A candidate explains the smallest share of the validation error that is worth a name.
//!
//! Every model has form error. A candidate that form error can imitate, because it shows only at reversals or in the
//! nuisance columns themselves, has to explain most of the residual.

use crate::selection::evidence_search::rules::Figures;
use crate::thresholds::{DECISION_SHARE, LARGER_PART};

pub(super) fn passes(figures: &Figures) -> bool {
    figures.gain > least_gain(figures.form_error_imitates)
}

/// The smallest error reduction of an effect, which is larger if form error imitates the effect.
pub fn least_gain(form_error_imitates: bool) -> f64 {
    if form_error_imitates { LARGER_PART } else { DECISION_SHARE }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_form_error_imitates_has_to_explain_most_of_the_residual() {
        let with = |gain: f64, form_error_imitates: bool| {
            passes(&Figures { gain, errors: 3.0, p_value: 0.001, form_error_imitates, alpha: 0.05, is_full: false })
        };
        assert!(with(0.05, false) && !with(0.02, false));
        assert!(with(0.6, true) && !with(0.4, true));
    }
}
