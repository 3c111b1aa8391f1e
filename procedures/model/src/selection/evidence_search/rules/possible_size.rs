//! A part of the torque is not larger than the largest measured torque.
//!
//! A coefficient in the unit of the response is a size that the effect reaches: a wave at its crest, Stribeck friction at rest.
//! A larger one is extrapolated from a small part of the wave or curve, where other effects cancel it. An exact formula, as
//! that of gravity, may be extrapolated; the columns of a user's formula have any size.

use crate::effect::Effect;
use crate::regression::solution::Solution;
use crate::selection::evidence_search::rules::Refit;
use crate::stats::summary::peak;

pub(super) fn passes(refit: &Refit) -> bool {
    let model = &refit.after.main;
    let Some(((term, places), solution)) = model.term(refit.id).zip(Solution::of(model)) else { return true };
    let (traits, sizes) = (term.effect.traits(), &solution.coefficients[places]);
    traits.is_exact
        || traits.is_user_defined
        || are_possible(term.effect, &term.form.linear, sizes, peak(&model.problem.target))
}

/// Whether no coefficient in the unit of the response exceeds the largest response.
fn are_possible(effect: &dyn Effect, names: &[&str], sizes: &[f64], largest: f64) -> bool {
    let info = effect.info();
    names.iter().zip(sizes).all(|(name, size)| info.unit(name) != info.kind.target_unit() || size.abs() <= largest)
}

#[cfg(test)]
mod tests {
    use super::are_possible;
    use crate::effects::find;
    use jointbench_instrument::Kind;

    #[test]
    fn friction_at_rest_does_not_exceed_the_largest_torque() {
        let of = |id: &str, name: &str| {
            let effect = find(Kind::Friction, id).unwrap();
            [0.9, 1.1].map(|size| are_possible(effect, &[name], &[-size], 1.0))
        };
        assert_eq!(of("stribeck", "tau_s"), [true, false]);
        assert_eq!(of("viscous", "c_v"), [true, true], "another unit");
    }
}
