//! From a model to the model that is left when nothing more can be named, with everything learnt on the way.

mod given;
mod others;
mod outside;
mod swift;
mod withdrawn;

pub use withdrawn::{Withdrawal, Withdrawn};

use crate::assembly::Assembly;
use crate::intervals::intervals;
use crate::late::late;
use crate::maps::Maps;
use crate::memory::memory;
use crate::prepare::Prepared;
use crate::report::{Imitated, Invisible, LeftOut, NoiseFloor, Parameter, ParameterState, Silent, Verdict};
use crate::select::{Library, Move, Rival, Search, held_out, moved};
use crate::terms::{Term, Terms};
use crate::{ModelError, ModelSpec, Options, floor};
use jointbench_instrument::Kind;
use others::Others;

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
    pub withdrawn: Vec<Withdrawn<'p>>,
    others: Others,
    /// Maps of what the last model leaves.
    pub maps: Maps,
    /// What shows in them is what whole stretches of motion scatter by.
    scatters: bool,
    pub floor: NoiseFloor,
    pub end_held_out_rms: f64,
    /// Effects of the last model, and what this run cannot tell them from.
    ties: Vec<(&'p str, &'p str)>,
    /// Effects of the last model that the error would hardly miss.
    pub upheld: Vec<Imitated>,
    /// One that may be there as well.
    pub open: Option<Imitated>,
}

/// More than this share of the remaining squared error, the same in every repeat, is structure.
const REPEATABLE_SHARE: f64 = 0.6;

/// Held-out error beyond this multiple of the noise floor is not noise.
const FAR_FROM_FLOOR: f64 = 1.5;

/// No formula of friction, of a spring or of a magnet is nature to this share of what was measured, in RMS: what is left
/// below it is nothing that anybody misses. Encoders err by waves, steps and slopes, whose formulas are no approximations.
const FORM_ACCURACY: f64 = 0.002;

/// An effect that the run does not decide stays where held-out squared error without it is larger by this share.
const CLEARLY_NEEDED: f64 = 0.1;

/// One that could be nothing at all, whatever its shape, needs more.
const PLAINLY_NEEDED: f64 = 0.5;

/// So much more error without an effect is no accident, however open its parameters are.
const UNMISTAKABLE: f64 = 1.0;

impl<'p> Exploration<'p> {
    /// `on_advance` sees every move when it is made.
    pub fn new(
        prepared: &'p Prepared,
        spec: &'p ModelSpec,
        options: &Options,
        most: usize,
        on_advance: &mut dyn FnMut(&Advance),
    ) -> Result<Self, ModelError> {
        let start = Assembly::new(prepared, spec, options)?;
        let library = Library::new(spec, &prepared.main, prepared.stages());
        // Of columns that cannot be right every effect is made up.
        let most = if prepared.clashes.void.is_empty() { most } else { 0 };
        let given = (most > 0).then(|| given::advance(&start, &library, options)).flatten();
        let mut advances: Vec<Advance> = given.into_iter().collect();
        advances.iter().for_each(&mut *on_advance);
        let begin = advances.first().map_or(&start, |a| &a.after);
        let left = most.saturating_sub(advances.len());
        let mut search = Search::new(begin.main.clone(), &library, &prepared.baseline, left, options);
        let mut effects = begin.effects.clone();
        let mut taken_back = Vec::new();
        let (maps, residual, open) = loop {
            let made = search.next().or_else(|| {
                let undecided = || Some((undecided(&search, prepared)?, Withdrawal::Undecided));
                let (id, why) = search.wandering().map(|id| (id, Withdrawal::Wanders)).or_else(undecided)?;
                taken_back.push((id, why));
                Some(search.withdraw(id))
            });
            let made = match made {
                Some(made) => made,
                None => {
                    let residual = search.now.tangent().rest(&search.now.response());
                    let maps = maps_of(&search.now, residual.clone(), prepared, options);
                    let axis = outside::structured(&maps);
                    let whole = axis.and_then(|axis| outside::taken_back(&search, &maps, axis, prepared, options));
                    let bump = || Some((outside::bump(&search, &maps, prepared, options)?, Withdrawal::HalfExplains));
                    if let Some((id, why)) = whole.or_else(bump) {
                        taken_back.push((id, why));
                        search.closed = true;
                        search.withdraw(id)
                    } else {
                        let is_decided = |with: &Terms<'p>, term: &Term<'p>| is_decided(with, term, prepared);
                        let nothing_shows = axis.is_none();
                        let is_all = |with: &Terms| nothing_shows || leaves_nothing(with, prepared, options);
                        match search.imitated(is_decided) {
                            Some(found) if found.is_clear && is_all(&found.with) => search.uphold(found.rival),
                            open => break (maps, residual, open.filter(|_| nothing_shows)),
                        }
                    }
                }
            };
            let (added, removed, ties) = match made {
                Move::Added { rival, ties } => {
                    effects.push(rival.term.id().into());
                    (Some(*rival), None, ties)
                }
                Move::Removed(id) => {
                    effects.retain(|e| e != id);
                    (None, Some(id), Vec::new())
                }
            };
            let after = start.of(search.now.clone(), effects.clone());
            advances.push(Advance { added, removed, ties, after });
            advances.last().into_iter().for_each(&mut *on_advance);
        };
        if let Some(last) = advances.last_mut() {
            last.after = last.after.clone().settled(options)?;
        }
        let moves = |id: &str, was: &Terms<'p>, is: &Terms<'p>| imitated(id, was, is, spec, prepared);
        let open = open.and_then(|open| moves(open.rival.term.id(), &search.now, &open.with));
        let upheld = search.upheld.iter().filter(|id| search.now.contains(id));
        let upheld = upheld.filter_map(|id| moves(id, &search.now.without(id), &search.now)).collect();
        let withdrawn = withdrawn::all(&search, &taken_back);
        let ties = open_ties(&search, &advances);
        let may_grow = |now: &Assembly| now.effects.len() < start.effects.len() + most && !search.closed;
        let now = advances.last().map_or(&start, |a| &a.after);
        if may_grow(now)
            && let Some((rival, after)) = late(now, options)
        {
            let after = after.settled(options)?;
            advances.push(Advance { added: Some(rival), removed: None, ties: Vec::new(), after });
            advances.last().into_iter().for_each(&mut *on_advance);
        }
        let now = advances.last().map_or(&start, |a| &a.after);
        if may_grow(now)
            && let Some(rival) = memory(now, options)
            && let effects = now.effects.iter().map(String::as_str).chain([rival.term.id()]).map(String::from).collect()
            && let after = now.of(now.main.clone(), effects).settled(options)?
            && let Some(moving) = &after.moving
            && !Doubt::of(&rival.term, moving, &intervals(moving, prepared.motion).parameters, prepared).is_there()
        {
            advances.push(Advance { added: Some(rival), removed: None, ties: Vec::new(), after });
            advances.last().into_iter().for_each(&mut *on_advance);
        }
        let others = Others::of(advances.last().map_or(&start, |a| &a.after), &search, &withdrawn, &ties);
        let floor = floor::noise_floor(prepared, &residual, search.now.contains("hysteresis"));
        let scatters = outside::is_scatter(&search, &maps, &residual, &floor, prepared, options);
        let end_held_out_rms = held_out_rms(&advances.last().map_or(&start, |a| &a.after).main);
        Ok(Self { start, advances, withdrawn, others, maps, scatters, floor, end_held_out_rms, ties, upheld, open })
    }

    pub fn end(&self) -> &Assembly<'p> {
        self.advances.last().map_or(&self.start, |a| &a.after)
    }

    /// Effects that this run cannot show, those of the model first.
    pub fn not_visible(&self) -> Vec<Invisible> {
        self.start.hidden.iter().chain(&self.others.invisible).cloned().collect()
    }

    /// Effects that were looked for and not found.
    pub fn silent(&self) -> Vec<Silent> {
        self.others.silent.clone()
    }

    /// Effects that were tried and left out.
    pub fn left_out(&self) -> Vec<LeftOut> {
        self.others.left_out.clone()
    }

    /// What this run cannot tell an effect of the last model from: the model is as good with it in its place.
    pub fn ties_of(&self, effect: &str) -> Vec<String> {
        self.ties.iter().filter(|(e, _)| *e == effect).map(|(_, rival)| (*rival).into()).collect()
    }

    /// This run cannot tell it from an effect of the last model.
    pub fn is_rival(&self, effect: &str) -> bool {
        self.ties.iter().any(|(_, rival)| *rival == effect)
    }

    /// Verdict on the last model.
    pub fn end_verdict(&self) -> Verdict {
        let shows = outside::structured(&self.maps).is_some() && !self.scatters;
        if (shows || self.repeats_itself()) && !self.is_negligible() {
            Verdict::UnexplainedStructure
        } else {
            Verdict::Adequate
        }
    }

    /// Most of what is left is the same in every repeat, or the model is far from predicting what was held out: no
    /// noise, whether or not a map shows where it comes from. A floor without an interval is too little known to accuse.
    fn repeats_itself(&self) -> bool {
        let held_out = self.end_held_out_rms;
        let surely = self.floor.repeatable_ci95.is_some_and(|[least, _]| least > outside::STRUCTURE_SHARE);
        self.floor.repeatable_share.is_some_and(|share| share > REPEATABLE_SHARE) && surely
            || self
                .floor
                .rms
                .filter(|_| self.floor.ci95.is_some())
                .is_some_and(|floor| held_out > FAR_FROM_FLOOR * floor)
    }

    /// RMS of what whole stretches of motion differ by, where that is what shows over an axis.
    pub fn scatter_rms(&self) -> Option<f64> {
        self.scatters.then(|| self.maps.between_rms())
    }

    /// What is left is small beside what was measured, however much of it repeats.
    fn is_negligible(&self) -> bool {
        let main = &self.end().main;
        let response = main.response();
        let mean = response.iter().sum::<f64>() / response.len() as f64;
        let spread = (response.iter().map(|y| (y - mean).powi(2)).sum::<f64>() / response.len() as f64).sqrt();
        self.start.prepared.kind != Kind::Encoder && self.end_held_out_rms < FORM_ACCURACY * spread
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

impl Exploration<'_> {
    /// Share of the held-out error that the last model has less than the same model without an effect.
    pub fn lost_without(&self, id: &str) -> f64 {
        let parts = parts_without(self.end(), id);
        parts.first().map_or(0.0, |(part, without)| 1.0 - held_out_rms(part) / held_out_rms(without))
    }
}

/// Maps of what a model leaves.
fn maps_of(terms: &Terms, residual: Vec<f64>, prepared: &Prepared, options: &Options) -> Maps {
    Maps::new(prepared, swift::without_swift_waves(terms, residual), options)
}

/// Nothing of what a model leaves shows over any axis.
fn leaves_nothing(terms: &Terms, prepared: &Prepared, options: &Options) -> bool {
    let residual = terms.tangent().rest(&terms.response());
    outside::structured(&maps_of(terms, residual, prepared, options)).is_none()
}

fn held_out_rms(terms: &Terms) -> f64 {
    (held_out(terms).iter().sum::<f64>() / terms.problem.rows() as f64).sqrt()
}

/// What the run leaves open about an effect.
#[derive(Clone, Copy, Default)]
struct Doubt {
    /// Its factors could all be zero, be it because they trade off with the shape.
    of_factors: bool,
    /// They could with the shape held as well. What is open only because of the shape is no reason to doubt the effect.
    of_size: bool,
    /// Its shape lies at the edge of what the run can speak about, or a factor beyond what is physically possible.
    of_shape: bool,
}

impl Doubt {
    fn of(term: &Term, terms: &Terms, parameters: &[Parameter], prepared: &Prepared) -> Self {
        let own = |p: &&Parameter| p.effect == term.id();
        let sudden = term.effect.suddenness();
        let mut others = parameters.iter().filter(own).filter(|p| sudden != Some(p.name.as_str()));
        // Of a wave's two factors one may well be zero.
        let is_there = |parameters: &[Parameter]| {
            let mut factors = parameters.iter().filter(own).filter(|p| term.form.linear.contains(&p.name.as_str()));
            factors.any(|p| p.state != ParameterState::Unidentified)
        };
        let held = || intervals(&terms.held(term.id()), prepared.motion).parameters;
        Self {
            of_factors: !is_there(parameters),
            of_size: !is_there(parameters) && !is_there(&held()),
            of_shape: others.any(|p| p.state == ParameterState::AtBound),
        }
    }

    fn is_there(self) -> bool {
        self.of_size || self.of_shape
    }
}

/// What another effect imitates, with the figure of the given model that it costs.
fn imitated(id: &str, without: &Terms, with: &Terms, spec: &ModelSpec, prepared: &Prepared) -> Option<Imitated> {
    let found = moved(without, with, &spec.effects)?;
    let info = found.term.effect.info();
    Some(Imitated {
        effect: id.into(),
        parameter: format!("{}.{}", info.id, found.factor),
        unit: prepared.motion.label(info.unit(found.factor)),
        without: found.was,
        with: found.is,
    })
}

/// A model says how large an effect is, and of which shape.
fn is_decided<'p>(with: &Terms<'p>, term: &Term<'p>, prepared: &Prepared) -> bool {
    let doubt = Doubt::of(term, with, &intervals(with, prepared.motion).parameters, prepared);
    !doubt.of_factors && !doubt.of_shape
}

/// An added effect whose size or shape the run does not decide, and without which held-out error is hardly larger. Where it
/// decides neither, something else may show in its place: there it has to take half of the error away, and a third where it
/// could be nothing whatever its shape. Beside structure from outside the library no size is decided: a part of that may be in it.
fn undecided<'p>(search: &Search<'_, 'p>, prepared: &Prepared) -> Option<&'p str> {
    let parameters = intervals(&search.now, prepared.motion).parameters;
    let present: f64 = held_out(&search.now).iter().sum();
    let open = search.added().filter_map(|term| {
        let doubt = Doubt::of(term, &search.now, &parameters, prepared);
        let more = held_out(&search.now.without(term.id())).iter().sum::<f64>() / present - 1.0;
        let goes = match doubt.of_factors && doubt.of_shape {
            true => more < UNMISTAKABLE,
            false if doubt.of_size => more < PLAINLY_NEEDED,
            false => (search.closed || doubt.is_there()) && more < CLEARLY_NEEDED,
        };
        goes.then_some((term.id(), more))
    });
    open.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(id, _)| id)
}

/// Of what tied with an effect when it came in, what still does beside everything that came later, and what does only
/// since then.
fn open_ties<'p>(search: &Search<'_, 'p>, advances: &[Advance<'p>]) -> Vec<(&'p str, &'p str)> {
    let mut open = Vec::new();
    for advance in advances {
        let Some(effect) = advance.added.as_ref().map(|rival| rival.term.id()) else { continue };
        let is_new = |rival: &&&'p str| !search.now.contains(rival) && !open.contains(&(effect, **rival));
        if search.now.contains(effect) {
            let rivals: Vec<&'p str> = advance.ties.iter().filter(is_new).copied().collect();
            open.extend(rivals.into_iter().filter(|rival| search.ties(effect, rival)).map(|rival| (effect, rival)));
        }
    }
    for term in search.added() {
        let stand_ins = search.stand_ins(term).into_iter().map(|rival| (term.id(), rival));
        let new: Vec<_> = stand_ins.filter(|tie| !open.contains(tie)).collect();
        open.extend(new);
    }
    open
}

/// Share of the squared error without an effect that the effect takes away.
fn importance(end: &Assembly, id: &str) -> f64 {
    let loss = |(part, without): &(&Terms, Terms)| 1.0 - part.linear().sse / without.linear().sse;
    parts_without(end, id).iter().map(loss).fold(0.0, f64::max)
}

/// The parts of a model that hold an effect, beside what they are without it.
fn parts_without<'a, 'p>(end: &'a Assembly<'p>, id: &str) -> Vec<(&'a Terms<'p>, Terms<'p>)> {
    if let Ok(effect) = end.spec.find(id)
        && effect.is_given()
    {
        return vec![(&end.main, end.main.without_given(effect))];
    }
    let parts = std::iter::once(&end.main).chain(&end.moving).filter(|part| part.contains(id));
    parts.map(|part| (part, part.without(id))).collect()
}
