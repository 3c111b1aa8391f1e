//! Cross-validation: the error of a model on folds that were left out of its fit.

use crate::linear::gram::BlockGrams;
use crate::regression::linear_model::LinearModel;
use crate::regression::solution::Solution;

/// Squared validation error of each fold.
pub fn validation_losses(terms: &LinearModel) -> Vec<f64> {
    if let Some(solution) = Solution::of(terms) {
        return solution.validation_losses(terms);
    }
    let linear = terms.linear();
    let problem = terms.problem;
    BlockGrams::new(&terms.columns(), &linear.residual, &problem.fold, problem.folds).validation_losses()
}

/// Validation error: RMS over all folds.
pub fn validation_rms(terms: &LinearModel) -> f64 {
    (validation_losses(terms).iter().sum::<f64>() / terms.problem.rows() as f64).sqrt()
}
