//! Replaces an added effect by another one with which the model is clearly better.

use crate::regression::cross_validation::validation_losses;
use crate::regression::linear_model::Term;
use crate::selection::equivalence::is_tie;
use crate::selection::floating_search::{FloatingSearch, Found};
use rayon::prelude::*;

impl<'p> FloatingSearch<'_, 'p> {
    /// An added effect that another one replaces with a clearly smaller validation error, and the replacement. Such
    /// an effect entered first because it resembles two missing ones. Confounded effects do not replace each other.
    pub(crate) fn swapped(&self) -> Option<(&'p str, Found<'p>)> {
        let losses = validation_losses(&self.now);
        let present: f64 = losses.iter().sum();
        let ids: Vec<&'p str> = self.added().map(Term::id).collect();
        let alone = self.now.terms.len() <= self.initial_terms.len() + 1;
        let better = |id: &'p str| {
            let rest = self.now.without(id);
            let plain = if alone { None } else { self.step(&rest) };
            let plain = plain.filter(|(scored, _)| {
                let clearly = scored.validation_losses < (1.0 - self.options.practical_share) * present;
                scored.term.id() != id && clearly && !is_tie(&scored.losses, &losses)
            });
            plain.or_else(|| self.masked_by(&rest, Some(id), &losses)).map(|found| (id, found))
        };
        ids.into_par_iter().find_map_first(better)
    }
}
