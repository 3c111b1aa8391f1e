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
        (partial.orthogonalized(&tested.columns).share, alone(tested, &partial, options))
    };
    let ((needed, p_value), (needless, _)) = (left_for(one, other), left_for(other, one));
    needed >= options.practical_share && p_value <= options.alpha && needless < options.practical_share
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::selection::tiny::Tiny;
    use jointbench_instrument::Kind;

    #[test]
    fn models_tie_where_their_difference_is_within_its_scatter() {
        let best = [1.0, 1.1, 0.9, 1.0, 1.2, 0.8];
        assert!(is_tie(&best, &[1.1, 1.0, 1.0, 0.9, 1.3, 0.8]));
        assert!(!is_tie(&best, &best.map(|loss| loss + 0.5)));
        // One fold decides: the mean difference is within two of its standard errors.
        assert!(is_tie(&best, &[1.0, 1.1, 0.9, 1.0, 1.2, 3.0]));
    }

    #[test]
    fn a_wave_encompasses_another_order_only_if_the_data_contains_it() {
        let encompasses = |waves: fn(f64) -> f64| {
            let tiny = Tiny::new(Kind::Friction, &["coulomb"], |row| {
                5.0 * row.direction + waves(row.angle) + 0.1 * row.scatter
            });
            let (one, other) = (tiny.term("gravity", Vec::new()), tiny.term("cogging", vec![2.0]));
            super::encompasses(&tiny.model(), &one, &other, &tiny.options)
        };
        assert!(encompasses(f64::cos));
        assert!(!encompasses(|angle| angle.cos() + (2.0 * angle).cos()));
    }
}
