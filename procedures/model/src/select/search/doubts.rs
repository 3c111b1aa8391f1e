//! Why an effect that was added goes again.

use super::{Found, Search, held_out};
use crate::effect::Stage;
use crate::select::library::Candidate;
use crate::select::rivals::{is_tie, left_by_memory};
use crate::select::scatter::shows_within_blocks;
use crate::select::wander::Wander;
use crate::terms::{Term, Terms};
use jointbench_instrument::Kind;
use rayon::prelude::*;

impl<'p> Search<'_, 'p> {
    /// An added effect in whose place another one makes the model clearly better, with that one: an effect that came first
    /// because it looks a little like two that are missing. No effect gives way to one that this run cannot tell it from.
    pub(super) fn misplaced(&self) -> Option<(&'p str, Found<'p>)> {
        let losses = held_out(&self.now);
        let present: f64 = losses.iter().sum();
        let ids: Vec<&'p str> = self.added().map(Term::id).collect();
        let alone = self.now.terms.len() <= self.kept.len() + 1;
        let better = |id: &'p str| {
            let rest = self.now.without(id);
            let plain = if alone { None } else { self.step(&rest) };
            let plain = plain.filter(|(rival, _)| {
                let clearly = rival.held_out < (1.0 - self.options.practical_share) * present;
                rival.term.id() != id && clearly && !is_tie(&rival.losses, &losses)
            });
            plain.or_else(|| self.behind_bent(&rest, Some(id), &losses)).map(|found| (id, found))
        };
        ids.into_par_iter().find_map_first(better)
    }

    /// The added effect without which the model is as good. What came last has just shown its reason.
    pub(super) fn needless(&self) -> Option<&'p str> {
        let full = self.now.linear().sse;
        let ids = self.on_trial().map(Term::id).filter(|id| self.last != Some(id));
        let ids: Vec<&'p str> = ids.collect();
        let share = |id: &'p str| {
            let without = self.now.without(id);
            let share = 1.0 - full / without.linear().sse;
            // What would need another effect of an impossible size in its place is not needless.
            (share < self.options.practical_share && self.impossible(&without).is_none()).then_some((id, share))
        };
        ids.into_par_iter().filter_map(share).min_by(|a, b| a.1.total_cmp(&b.1)).map(|(id, _)| id)
    }

    /// The added effect whose factors are physically impossible in a model.
    pub(super) fn impossible(&self, terms: &Terms<'p>) -> Option<&'p str> {
        let factors = terms.linear().factors;
        let mut sized = terms.terms.iter().zip(&factors).filter(|(term, _)| !self.kept.contains(&term.id()));
        sized.find(|(term, factors)| !term.allows(factors)).map(|(term, _)| term.id())
    }

    /// The added effect of friction that drives a given one below zero in the shapes in which all of them ended, as two
    /// that cancel each other do; of several that without which the model is best.
    pub(super) fn cancelling(&self) -> Option<&'p str> {
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

    /// The added effect that brings least on what was held out, where that is not worth a name: whatever came in since
    /// explains the rest of it. Asked when nothing more can be added, because on the way two effects may mask each other.
    pub(super) fn idle(&self) -> Option<&'p str> {
        let (present, sse) = (held_out(&self.now).iter().sum::<f64>(), self.now.linear().sse);
        let on_trial: Vec<&Term<'p>> = self.on_trial().collect();
        let idle = on_trial.into_par_iter().filter_map(|term| {
            let without = self.laid_without(term.id());
            let share = 1.0 - present / held_out(&without).iter().sum::<f64>();
            let is_remainder = without.linear().sse - sse < left_by_memory(&without);
            (share < self.options.practical_share || is_remainder).then_some((term.id(), share))
        });
        idle.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(id, _)| id)
    }

    /// An added effect that shows from stretch to stretch of motion only, and there no more than a zero that wanders would.
    pub fn wandering(&self) -> Option<&'p str> {
        self.added().next()?;
        let wander = Wander::of(&self.now, self.options)?;
        let mut open: Vec<&str> = self.library.candidates.iter().map(Candidate::id).collect();
        open.dedup();
        let explained = |term: &&Term<'p>| Some((wander.gain(term, open.len(), self.options)?, term.id()));
        let within = |term: &&Term<'p>| shows_within_blocks(term, &self.now, self.options);
        let explained = self.added().filter(|term| !within(term)).filter_map(|term| explained(&term));
        explained.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, id)| id)
    }

    /// Added effects that have to be worth their error.
    fn on_trial(&self) -> impl Iterator<Item = &Term<'p>> {
        self.added().filter(|term| !self.upheld.contains(&term.id()))
    }
}
