//! When two models explain the data equally well.

use crate::Options;
use crate::regression::linear_model::{LinearModel, Term};
use crate::regression::partial_regression::PartialRegression;
use crate::regression::significance::alone;
use crate::stats::summary::deviation;
use crate::thresholds::TIE_ERRORS;

/// Two models tie if the difference of their validation errors is within its own scatter over the folds.
pub fn is_tie(a: &[f64], b: &[f64]) -> bool {
    let differences: Vec<f64> = b.iter().zip(a).map(|(b, a)| b - a).collect();
    let n = differences.len() as f64;
    let spread = deviation(&differences);
    differences.iter().sum::<f64>() <= TIE_ERRORS * n.sqrt() * spread + 1e-9 * a.iter().sum::<f64>()
}

/// Whether `one` explains all that matters of `other`, and `other` does not explain all of `one`: the encompassing
/// test of Davidson and MacKinnon (1981), by sign flips of blocks. Two effects can differ significantly in only a few
/// folds.
pub fn encompasses(now: &LinearModel, one: &Term, other: &Term, options: &Options) -> bool {
    let left_for = |tested: &Term, included: &Term| {
        let mut with = now.clone();
        with.terms.push(included.clone());
        with.refine();
        let partial = PartialRegression::of(&with);
        (partial.own(&tested.columns).share, alone(tested, &partial, options))
    };
    let ((needed, p_value), (needless, _)) = (left_for(one, other), left_for(other, one));
    needed >= options.practical_share && p_value <= options.alpha && needless < options.practical_share
}
