//! Removes an added effect whose coefficients are physically impossible.

use crate::regression::linear_model::LinearModel;
use crate::selection::floating_search::FloatingSearch;

impl<'p> FloatingSearch<'_, 'p> {
    /// The added effect whose coefficients are physically impossible in a model.
    pub(crate) fn infeasible(&self, terms: &LinearModel<'p>) -> Option<&'p str> {
        let coefficients = terms.linear().coefficients;
        let mut sized =
            terms.terms.iter().zip(&coefficients).filter(|(term, _)| !self.initial_terms.contains(&term.id()));
        sized.find(|(term, coefficients)| !term.allows(coefficients)).map(|(term, _)| term.id())
    }
}
