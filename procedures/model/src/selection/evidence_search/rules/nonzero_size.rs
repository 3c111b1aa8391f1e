//! The model with the candidate gives it a size.
//!
//! A coefficient that cannot be negative is held at zero if its estimate is negative by chance. If all coefficients of
//! the candidate are, the error falls because of its nuisance terms only: another form, or form error. A candidate that
//! changes the direction of friction has the size of the Coulomb friction.

use crate::effects::changes_direction;
use crate::effects::friction::coulomb;
use crate::regression::linear_model::LinearModel;
use crate::regression::solution::Solution;
use crate::selection::evidence_search::rules::Refit;
use std::ops::Range;

pub(super) fn passes(refit: &Refit) -> bool {
    has_size(refit.id, &refit.after.main)
}

pub(in crate::selection::evidence_search) fn has_size(id: &str, model: &LinearModel) -> bool {
    let Some(solution) = Solution::of(model) else { return true };
    let id = if changes_direction(id) { coulomb::ID } else { id };
    model.term(id).is_none_or(|(_, places)| !is_held(places, &solution.bound))
}

/// Whether all coefficients at these places are held at zero.
fn is_held(mut range: Range<usize>, bound: &[(usize, f64)]) -> bool {
    range.all(|at| bound.iter().any(|(held, _)| *held == at))
}

#[cfg(test)]
mod tests {
    use super::is_held;

    #[test]
    fn an_effect_has_a_size_if_one_of_its_coefficients_is_free() {
        let bound = [(1, 0.1), (2, 0.2)];
        assert!(is_held(1..3, &bound) && is_held(2..3, &bound));
        assert!(!is_held(0..2, &bound) && !is_held(0..1, &bound));
    }
}
