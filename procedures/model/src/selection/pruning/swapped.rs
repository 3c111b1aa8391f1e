//! Replaces an added effect by another one with which the model is clearly better.

use crate::regression::cross_validation::{is_tie, validation_losses};
use crate::regression::linear_model::Term;
use crate::selection::floating_search::FloatingSearch;
use crate::selection::pruning::Rejected;
use rayon::prelude::*;

impl<'p> FloatingSearch<'_, 'p> {
    /// An added effect that another one replaces with a clearly smaller validation error, and the replacement. Such
    /// an effect entered first because it resembles two missing ones. Confounded effects do not replace each other.
    pub(crate) fn swapped(&self) -> Option<Rejected<'p>> {
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
            plain
                .or_else(|| self.masked_by(&rest, Some(id), &losses))
                .map(|found| Rejected { id, replacement: Some(found) })
        };
        ids.into_par_iter().find_map_first(better)
    }
}

#[cfg(test)]
mod tests {
    use crate::selection::tiny::Tiny;
    use jointbench_instrument::Kind;

    #[test]
    fn an_effect_that_resembles_the_missing_one_is_swapped_for_it() {
        let replacement = |drag: fn(f64) -> f64| {
            let tiny = Tiny::new(Kind::Friction, &["coulomb"], |row| {
                3.0 + 5.0 * row.direction + drag(row.velocity) + 0.1 * row.scatter
            });
            tiny.removed(&["viscous", "direction_offset"], |search| {
                let swapped = search.swapped()?;
                assert_eq!(swapped.id, "viscous");
                Some(swapped.replacement?.0.term.id())
            })
        };
        assert_eq!(replacement(|v| 0.1 * v * v.abs()).as_deref(), Some("viscous_quadratic"));
        assert_eq!(replacement(|v| v), None);
    }
}
