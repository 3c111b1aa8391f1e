//! A candidate that changes the direction of all friction terms explains as much as free form-error columns in its
//! place.
//!
//! A delayed torque also bends around reversals, but friction directions do not follow it.

use crate::regression::solution::Solution;
use crate::selection::evidence_search::rules::Refit;
use crate::thresholds::FLOOR_RATIO;

pub(super) fn passes(Refit { now, solution, after, .. }: &Refit) -> bool {
    let Some(form_error) = after.main.problem.form_error.as_deref() else { return true };
    std::ptr::eq(now.main.problem, after.main.problem)
        || Solution::weighted(&after.main, form_error, solution.weight.clone(), None).ridge.loss()
            < FLOOR_RATIO.powi(2) * solution.ridge.loss()
}
