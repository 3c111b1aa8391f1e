//! Removes an added effect that makes a coefficient of a given effect negative.

use crate::effect::Regime;
use crate::regression::cross_validation::validation_losses;
use crate::regression::linear_model::{LinearModel, Term};
use crate::selection::floating_search::FloatingSearch;
use jointbench_instrument::Kind;
use rayon::prelude::*;

impl<'p> FloatingSearch<'_, 'p> {
    /// The added friction effect that makes a given coefficient negative at the final nonlinear parameters: the two
    /// cancel each other. If several do, the one without which the validation error is smallest.
    pub(crate) fn mutually_cancelling(&self) -> Option<&'p str> {
        if self.library.kind != Kind::Friction {
            return None;
        }
        let infeasible = |terms: &LinearModel<'p>| {
            let sized = terms.terms.iter().zip(terms.linear().coefficients);
            sized
                .filter(|(term, coefficients)| self.initial_terms.contains(&term.id()) && !term.allows(coefficients))
                .count()
        };
        let all = infeasible(&self.now);
        if all == 0 {
            return None;
        }
        let of_now = self.testable().filter(|term| term.effect.traits().regime != Regime::Hysteresis);
        let of_now: Vec<&str> = of_now.map(Term::id).collect();
        let freed = of_now.into_par_iter().filter_map(|id| {
            let without = self.model_without(id);
            (infeasible(&without) < all).then(|| (id, validation_losses(&without).iter().sum::<f64>()))
        });
        freed.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(id, _)| id)
    }
}

#[cfg(test)]
mod tests {
    use crate::selection::tiny::Tiny;
    use jointbench_instrument::Kind;

    #[test]
    fn a_drag_that_makes_the_coulomb_friction_negative_cancels_it() {
        let removed = |coulomb: f64| {
            let tiny = Tiny::new(Kind::Friction, &["coulomb", "viscous"], |row| {
                let drag = row.velocity - 0.05 * row.velocity * row.velocity.abs();
                coulomb * row.direction + drag + 0.1 * row.scatter
            });
            tiny.removed(&["viscous_quadratic"], |search| search.mutually_cancelling())
        };
        assert_eq!(removed(-1.0).as_deref(), Some("viscous_quadratic"));
        assert_eq!(removed(1.0), None);
    }
}
