//! Whether a run can tell two effects apart.

use super::library::gain;
use super::search::{Rival, family_wise};
use crate::Options;
use crate::linear::dot;
use crate::terms::{Term, Terms};

/// Two effects tie where the difference of their held-out errors is not larger than its own scatter over the folds.
pub fn is_tie(a: &Rival, b: &Rival) -> bool {
    let differences: Vec<f64> = b.losses.iter().zip(&a.losses).map(|(b, a)| b - a).collect();
    let n = differences.len() as f64;
    let mean = differences.iter().sum::<f64>() / n;
    let spread = (differences.iter().map(|d| (d - mean).powi(2)).sum::<f64>() / (n - 1.0).max(1.0)).sqrt();
    differences.iter().sum::<f64>() <= 2.0 * n.sqrt() * spread + 1e-9 * a.held_out
}

/// Whether the model with `one` leaves nothing that matters for `other`, and the other way round it does (the encompassing
/// test of Davidson and MacKinnon 1981, by sign flips of blocks). Two effects may be apart in few of the folds, and clearly.
pub fn encompasses(now: &Terms, one: &Term, other: &Term, options: &Options) -> bool {
    let left_for = |beside: &Term, there: &Term| {
        let mut with = now.clone();
        with.terms.push(there.clone());
        with.refine();
        let basis = with.tangent();
        let residual = basis.rest(&with.response());
        let share = gain(&beside.columns, &basis, &residual, dot(&residual, &residual)).share;
        (share, family_wise(beside, Vec::new(), &basis, &residual, now.problem, options))
    };
    let ((needed, p_value), (needless, _)) = (left_for(one, other), left_for(other, one));
    needed >= options.practical_share && p_value <= options.alpha && needless < options.practical_share
}
