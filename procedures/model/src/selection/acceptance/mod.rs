//! Rules that a candidate has to pass before it enters a model, one file for each rule, and the list in which they run.

pub(crate) mod aliasing;
pub(crate) mod between_leg_variance;
pub(crate) mod feasible_parameters;
pub(crate) mod formula_error;

use crate::regression::linear_model::{LinearModel, Term};
use crate::regression::partial_regression::PartialRegression;
use crate::selection::acceptance::formula_error::AcceptanceThreshold;

/// A candidate, and the model that it would enter.
pub(crate) struct Candidate<'c, 'p> {
    pub term: &'c Term<'p>,
    /// Its partial R².
    pub share: f64,
    pub now: &'c LinearModel<'p>,
    /// The residual of that model.
    pub partial: &'c PartialRegression,
    pub threshold: AcceptanceThreshold<'c>,
}

type Rule = fn(&Candidate) -> bool;

/// All rules by name, in the order in which they run.
const RULES: [(&str, Rule); 4] = [
    ("feasible parameters", feasible_parameters::passes),
    ("between leg variance", between_leg_variance::passes),
    ("aliasing", aliasing::passes),
    ("formula error", formula_error::passes),
];

impl Candidate<'_, '_> {
    /// Whether it passes all rules.
    pub fn is_acceptable(&self) -> bool {
        RULES.iter().all(|(_, passes)| passes(self))
    }
}

#[cfg(test)]
mod tests {
    use super::RULES;
    use crate::selection::listed_rules;

    #[test]
    fn the_docs_list_the_rules_in_the_order_in_which_they_run() {
        listed_rules::check("acceptance", &RULES.map(|(name, _)| name));
    }
}
