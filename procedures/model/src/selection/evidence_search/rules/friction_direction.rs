//! A candidate that changes the direction of all friction terms explains as much as free form-error columns in its
//! place, and predicts as well.
//!
//! A delayed torque also bends around reversals, but friction directions do not follow it.

use crate::regression::solution::Solution;
use crate::selection::evidence_search::rules::Refit;
use crate::thresholds::FLOOR_RATIO;

pub(super) fn passes(Refit { now, solution, after, .. }: &Refit) -> bool {
    let Some(form_error) = after.main.problem.form_error.as_deref() else { return true };
    if std::ptr::eq(now.main.problem, after.main.problem) {
        return true;
    }
    let candidate = Solution::weighted(&after.main, form_error, solution.weight.clone(), None);
    let validation_loss = |model| Solution::of(model).map(|s| s.validation_losses(model).iter().sum::<f64>());
    let validation_losses = validation_loss(&after.main).zip(validation_loss(&now.main));
    explains_as_much(candidate.ridge.loss(), solution.ridge.loss())
        && validation_losses.is_none_or(|(after, now)| explains_as_much(after, now))
}

/// Whether the squared error with the new direction is near that of the form-error columns.
fn explains_as_much(candidate: f64, form_error: f64) -> bool {
    candidate < FLOOR_RATIO.powi(2) * form_error
}

#[cfg(test)]
mod tests {
    use super::explains_as_much;
    use crate::thresholds::FLOOR_RATIO;

    #[test]
    fn a_direction_that_leaves_more_than_the_form_error_is_wrong() {
        let limit = FLOOR_RATIO.powi(2);
        assert!(explains_as_much(0.5, 1.0) && explains_as_much(0.99 * limit, 1.0));
        assert!(!explains_as_much(1.01 * limit, 1.0) && !explains_as_much(4.0, 1.0));
    }
}
