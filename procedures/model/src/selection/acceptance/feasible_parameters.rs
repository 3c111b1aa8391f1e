//! A candidate enters only if every coefficient of the model stays physically possible.

use crate::regression::linear_model::{LinearModel, Term};
use crate::selection::acceptance::formula_error::AcceptanceThreshold;
use jointbench_instrument::Kind;

impl AcceptanceThreshold<'_> {
    /// Rejects a candidate that makes a friction coefficient negative: a wave over short strokes can look like a
    /// constant.
    pub fn keeps_parameters_feasible(&self, now: &LinearModel, term: &Term) -> bool {
        if self.kind != Kind::Friction {
            return true;
        }
        let mut with = now.clone();
        with.terms.push(term.clone());
        let (was, is) = (now.linear().coefficients, with.linear().coefficients);
        let mut changes = now.terms.iter().zip(was.iter().zip(&is));
        changes.all(|(t, (was, is))| !t.allows(was) || t.allows(is))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::selection::tiny::Tiny;

    #[test]
    fn a_candidate_that_makes_the_viscous_friction_negative_is_rejected() {
        let passes = |viscous: f64| {
            let tiny = Tiny::new(Kind::Friction, &["viscous"], |row| {
                5.0 * row.direction + viscous * row.velocity + 0.1 * row.scatter
            });
            let threshold = AcceptanceThreshold { plain: 1.0, kind: Kind::Friction, options: &tiny.options };
            threshold.keeps_parameters_feasible(&tiny.model(), &tiny.term("coulomb", Vec::new()))
        };
        assert!(passes(0.2) && !passes(-0.2));
    }
}
