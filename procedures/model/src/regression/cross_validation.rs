//! Cross-validation: the error of a model on folds that were left out of its fit.

use crate::linear::gram::BlockGrams;
use crate::regression::linear_model::LinearModel;
use crate::regression::solution::Solution;
use crate::stats::summary::deviation;
use crate::thresholds::TIE_ERRORS;

/// Two models tie if the difference of their validation errors is within its own scatter over the folds.
pub fn is_tie(a: &[f64], b: &[f64]) -> bool {
    let differences: Vec<f64> = b.iter().zip(a).map(|(b, a)| b - a).collect();
    let n = differences.len() as f64;
    let spread = deviation(&differences);
    differences.iter().sum::<f64>() <= TIE_ERRORS * n.sqrt() * spread + 1e-9 * a.iter().sum::<f64>()
}

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

#[cfg(test)]
mod tests {
    use super::is_tie;

    #[test]
    fn models_tie_where_their_difference_is_within_its_scatter() {
        let best = [1.0, 1.1, 0.9, 1.0, 1.2, 0.8];
        assert!(is_tie(&best, &[1.1, 1.0, 1.0, 0.9, 1.3, 0.8]));
        assert!(!is_tie(&best, &best.map(|loss| loss + 0.5)));
        // One fold decides: the mean difference is within two of its standard errors.
        assert!(is_tie(&best, &[1.0, 1.1, 0.9, 1.0, 1.2, 3.0]));
    }
}
