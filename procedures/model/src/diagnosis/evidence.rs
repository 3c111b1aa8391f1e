//! Evidence for a suggested effect in addition to its p-value.

use crate::linear::basis::dot;
use crate::preprocess::independent_blocks::independent_blocks;
use crate::regression::cross_validation::validation_losses;
use crate::regression::linear_model::LinearModel;
use crate::stats::{jackknife, student};

/// 95 % interval of the relative reduction of the validation RMS between two models: jackknife over folds, on the
/// logarithm of the ratio. `None` with too few folds.
pub fn reduction(before: &LinearModel, after: &LinearModel) -> Option<[f64; 2]> {
    let (before, after) = (validation_losses(before), validation_losses(after));
    let t = student::t95(before.len() as f64 - 1.0)?;
    let (log, error) = jackknife::log_ratio(&before, &after);
    let share = |log: f64| 1.0 - (0.5 * log).exp();
    let ci95 = [share(log + t * error), share(log - t * error)];
    ci95.iter().all(|end| end.is_finite()).then_some(ci95)
}

/// Change of the Bayesian information criterion (Schwarz 1978), counted over independent blocks of the run, because
/// consecutive samples are correlated.
pub fn bic_change(before: &LinearModel, after: &LinearModel) -> f64 {
    let parameters = |terms: &LinearModel| terms.terms.iter().map(|t| t.size() as f64).sum::<f64>();
    let count = independent_blocks(before.problem, after.columns().len()).1 as f64;
    count * (after.linear().sse / before.linear().sse).ln() + (parameters(after) - parameters(before)) * count.ln()
}

/// Correlation of the contributions of two models to the residual of a third one.
pub fn correlation(of: &LinearModel, one: &LinearModel, other: &LinearModel) -> f64 {
    let left = of.linear().residual;
    let taken = |by: &LinearModel| -> Vec<f64> { left.iter().zip(by.linear().residual).map(|(l, r)| l - r).collect() };
    let (a, b) = (taken(one), taken(other));
    dot(&a, &b) / (dot(&a, &a) * dot(&b, &b)).sqrt()
}
