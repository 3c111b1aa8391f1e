//! An added effect that drives a given one below zero.

use crate::effect::Stage;
use crate::regression::cross_validation::held_out;
use crate::regression::linear_model::{Term, Terms};
use crate::selection::floating_search::Search;
use jointbench_instrument::Kind;
use rayon::prelude::*;

impl<'p> Search<'_, 'p> {
    /// The added effect of friction that drives a given one below zero in the shapes in which all of them ended, as two
    /// that cancel each other do; of several that without which the model is best.
    pub(crate) fn cancelling(&self) -> Option<&'p str> {
        if self.library.kind != Kind::Friction {
            return None;
        }
        let impossible = |terms: &Terms<'p>| {
            let sized = terms.terms.iter().zip(terms.linear().factors);
            sized.filter(|(term, factors)| self.kept.contains(&term.id()) && !term.allows(factors)).count()
        };
        let all = impossible(&self.now);
        if all == 0 {
            return None;
        }
        let of_now = self.on_trial().filter(|term| term.effect.stage() != Stage::Memory);
        let of_now: Vec<&str> = of_now.map(Term::id).collect();
        let freed = of_now.into_par_iter().filter_map(|id| {
            let without = self.laid_without(id);
            (impossible(&without) < all).then(|| (id, held_out(&without).iter().sum::<f64>()))
        });
        freed.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(id, _)| id)
    }
}
