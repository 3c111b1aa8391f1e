//! The validation error over all samples does not clearly increase with the candidate.
//!
//! The decision gives samples near reversals and at rest less weight. A candidate that improves the others but worsens
//! these by more than one standard error contradicts a part of the run. A candidate that changes the friction direction is
//! judged by the rule *friction direction*: its model has other nuisance columns, and at rest no direction is right.

use crate::regression::evidence::errors;
use crate::regression::linear_model::LinearModel;
use crate::regression::solution::Solution;
use crate::selection::evidence_search::rules::Refit;
use crate::thresholds::ONE_ERROR;

pub(super) fn passes(refit: &Refit) -> bool {
    if !std::ptr::eq(refit.now.main.problem, refit.after.main.problem) {
        return true;
    }
    let losses = |model: &LinearModel| Solution::of(model).map(|solution| solution.validation_losses(model));
    match (losses(&refit.now.main), losses(&refit.after.main)) {
        (Some(now), Some(after)) => is_no_worse(&now, &after),
        _ => true,
    }
}

fn is_no_worse(now: &[f64], after: &[f64]) -> bool {
    let increases: Vec<f64> = now.iter().zip(after).map(|(now, after)| after - now).collect();
    errors(&increases) <= ONE_ERROR
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_that_increases_in_most_blocks_is_worse() {
        let now = [1.0, 1.2, 0.9, 1.1];
        assert!(!is_no_worse(&now, &[1.3, 1.4, 1.2, 1.5]));
        assert!(is_no_worse(&now, &[1.2, 1.1, 0.8, 1.2]));
    }
}
