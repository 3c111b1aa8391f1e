//! Removes an added effect whose coefficients are physically impossible.

use crate::regression::linear_model::LinearModel;
use crate::selection::floating_search::FloatingSearch;

impl<'p> FloatingSearch<'_, 'p> {
    /// The added effect whose coefficients are physically impossible in a model.
    pub(crate) fn impossible(&self, terms: &LinearModel<'p>) -> Option<&'p str> {
        let factors = terms.linear().factors;
        let mut sized = terms.terms.iter().zip(&factors).filter(|(term, _)| !self.initial_terms.contains(&term.id()));
        sized.find(|(term, factors)| !term.allows(factors)).map(|(term, _)| term.id())
    }
}
