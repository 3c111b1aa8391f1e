//! Whether an effect explains all that another one explains.

use crate::Options;
use crate::regression::linear_model::{LinearModel, Term};
use crate::regression::partial_regression::PartialRegression;
use crate::regression::significance::alone;

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
    use crate::selection::tiny::Tiny;
    use jointbench_instrument::Kind;

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
