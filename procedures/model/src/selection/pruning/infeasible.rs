//! An added effect whose coefficients are physically impossible.

use crate::regression::linear_model::Terms;
use crate::selection::floating_search::Search;

impl<'p> Search<'_, 'p> {
    /// The added effect whose factors are physically impossible in a model.
    pub(crate) fn impossible(&self, terms: &Terms<'p>) -> Option<&'p str> {
        let factors = terms.linear().factors;
        let mut sized = terms.terms.iter().zip(&factors).filter(|(term, _)| !self.kept.contains(&term.id()));
        sized.find(|(term, factors)| !term.allows(factors)).map(|(term, _)| term.id())
    }
}
