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
