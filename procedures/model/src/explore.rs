//! From a model to the model that is left when nothing more can be named, with everything learnt on the way.

use crate::assembly::Assembly;
use crate::effect::Stage;
use crate::linear::dot;
use crate::maps::Maps;
use crate::memory::memory;
use crate::prepare::Prepared;
use crate::report::{Invisible, NoiseFloor, Verdict};
use crate::select::{Library, Move, Rival, Silence, held_out, search};
use crate::terms::Terms;
use crate::{ModelError, ModelSpec, Options, ResidualKind, floor};

/// What was added or removed, and the model after it.
pub struct Advance<'p> {
    pub added: Option<Rival<'p>>,
    pub removed: Option<&'p str>,
    pub ties: Vec<&'p str>,
    pub after: Assembly<'p>,
}

pub struct Exploration<'p> {
    pub start: Assembly<'p>,
    pub advances: Vec<Advance<'p>>,
    pub silent: Vec<Silence<'p>>,
    pub invisible: Vec<Invisible>,
    /// Maps of what the last model leaves.
    pub maps: Maps,
    pub floor: NoiseFloor,
}

/// A map must take this share off held-out squared error to be called structure. Over null runs the best map reaches
/// 2 %, and what is left of well-explained runs 11 %.
const STRUCTURE_SHARE: f64 = 0.15;

/// More than this share of the remaining squared error, the same in every repeat, is structure.
const REPEATABLE_SHARE: f64 = 0.6;

/// Held-out error beyond this multiple of the noise floor is not noise.
const FAR_FROM_FLOOR: f64 = 1.5;

impl<'p> Exploration<'p> {
    pub fn new(
        prepared: &'p Prepared,
        spec: &'p ModelSpec,
        options: &Options,
        most: usize,
    ) -> Result<Self, ModelError> {
        let start = Assembly::new(prepared, spec)?;
        let all = [Stage::Settled, Stage::Ramp, Stage::Memory];
        let apart = prepared.about.residual == ResidualKind::PlateauMean;
        let stages = if apart { &all[..1] } else { &all[..] };
        let library = Library::new(spec, &prepared.main, stages);
        let path = search(start.main.clone(), &library, most, options);
        let mut advances: Vec<Advance> = Vec::new();
        let mut effects = start.effects.clone();
        for (step, terms) in path.moves {
            let (added, removed, ties) = match step {
                Move::Added { rival, ties } => {
                    effects.push(rival.term.id().into());
                    (Some(*rival), None, ties)
                }
                Move::Removed(id) => {
                    effects.retain(|e| e != id);
                    (None, Some(id), Vec::new())
                }
            };
            let after = start.with_main(terms, effects.clone());
            advances.push(Advance { added, removed, ties, after });
        }
        if advances.len() < most
            && let now = advances.last().map_or(&start, |a| &a.after)
            && let Some(rival) = memory(now, options)
        {
            let after = now.with_memory(&rival.term);
            advances.push(Advance { added: Some(rival), removed: None, ties: Vec::new(), after });
        }
        let mut invisible = library.invisible;
        invisible.retain(|i| !start.hidden.iter().any(|h| h.effect == i.effect));
        let (maps, floor, silent) = {
            let end = advances.last().map_or(&start.main, |a| &a.after.main);
            let basis = end.tangent();
            let residual = basis.rest(&end.response());
            let floor = floor::noise_floor(prepared, &residual);
            (Maps::new(prepared, residual, options), floor, path.silent)
        };
        Ok(Self { start, advances, silent, invisible, maps, floor })
    }

    pub fn end(&self) -> &Assembly<'p> {
        self.advances.last().map_or(&self.start, |a| &a.after)
    }

    /// Verdict on the last model.
    pub fn end_verdict(&self) -> Verdict {
        let mapped = self.maps.removable().is_some_and(|(_, share)| share > STRUCTURE_SHARE);
        if mapped || self.repeats_itself() { Verdict::UnexplainedStructure } else { Verdict::Adequate }
    }

    /// Most of what is left is the same in every repeat, or the model is far from predicting what was held out: no
    /// noise, whether or not a map shows where it comes from.
    fn repeats_itself(&self) -> bool {
        let main = &self.end().main;
        let held_out = (held_out(main).iter().sum::<f64>() / main.problem.rows() as f64).sqrt();
        self.floor.repeatable_share.is_some_and(|share| share > REPEATABLE_SHARE)
            || self.floor.rms.is_some_and(|floor| held_out > FAR_FROM_FLOOR * floor)
    }

    /// Added effects that are still there, the most important first: by what the last model loses without them, so
    /// that effects that mask each other come out in the right order.
    pub fn ranking(&self) -> Vec<(&Advance<'p>, f64)> {
        let end = self.end();
        let mut seen: Vec<&str> = Vec::new();
        let mut ranked: Vec<(&Advance, f64)> = Vec::new();
        // From the end, because an effect that was dropped and came again has its present evidence there.
        for advance in self.advances.iter().rev() {
            let Some(id) = advance.added.as_ref().map(|r| r.term.id()) else { continue };
            if !seen.contains(&id) && end.effects.iter().any(|e| e == id) {
                seen.push(id);
                ranked.push((advance, importance(end, id)));
            }
        }
        ranked.sort_by(|a, b| b.1.total_cmp(&a.1));
        ranked
    }
}

/// Share of the squared error without an effect that the effect takes away.
fn importance(end: &Assembly, id: &str) -> f64 {
    let loss = |terms: &Terms| {
        let mut less = terms.clone();
        less.terms.retain(|t| t.id() != id);
        less.refine();
        let (with, without) = (terms.linear(), less.linear());
        1.0 - dot(&with.residual, &with.residual) / without.sse
    };
    let parts = std::iter::once(&end.main).chain(&end.moving);
    parts.filter(|t| t.contains(id)).map(loss).fold(0.0, f64::max)
}
