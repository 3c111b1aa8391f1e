//! Floating forward selection of effects: one added or removed effect at a time.

use crate::Options;
use crate::effect::{Effect, Form};
use crate::preprocess::Prepared;
use crate::regression::candidates::{CandidateSet, Regressor};
use crate::regression::canonical_fit::fit_canonical;
use crate::regression::cross_validation::{is_tie, validation_losses};
use crate::regression::linear_model::{LinearModel, Term};
use crate::regression::partial_regression::PartialRegression;
use crate::report::reasons::{AdditionReason, RemovalReason};
use crate::residual_analysis::maps::Maps;
use crate::residual_analysis::undersampled_harmonics;
use crate::selection::acceptance::formula_error::AcceptanceThreshold;
use crate::selection::equivalence::encompasses;
use crate::selection::forward_step::{ScoredCandidate, step};
use crate::thresholds::SIMPLER_GAIN;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

/// Effects of a model with their forms and nonlinear parameters.
type CachedTerms<'p> = Vec<(&'p dyn Effect, Arc<Form<'p>>, Vec<f64>)>;

/// Largest number of exchanges of effects, so that the search ends. With ten, simulated runs have the same results.
const MOST_EXCHANGES: usize = 2;

pub enum Move<'p> {
    Added { scored: Box<ScoredCandidate<'p>>, ties: Vec<&'p str> },
    Removed { id: &'p str, why: RemovalReason },
}

/// A scored candidate with the effects that are confounded with it.
pub(crate) type Found<'p> = (ScoredCandidate<'p>, Vec<&'p str>);

/// State of the search: the model, and the effects that were tried.
pub struct FloatingSearch<'l, 'p> {
    pub now: LinearModel<'p>,
    pub(crate) prepared: &'p Prepared,
    pub(crate) library: &'l CandidateSet<'p>,
    pub(crate) options: &'l Options,
    /// Squared error of the model with only the baseline effects and those with an exact formula.
    plain: f64,
    /// Effects of the given model.
    pub(crate) initial_terms: Vec<&'p str>,
    /// Effects that were removed and are not tried again.
    pub(crate) withdrawn: Vec<&'p str>,
    /// The last reason for the removal of each of them.
    reasons: BTreeMap<&'p str, RemovalReason>,
    /// Effects that are kept because the other coefficients are biased without them, not because of the error.
    pub retained_for_bias: Vec<&'p str>,
    /// Squared validation errors, fold by fold, of the models before each removal.
    rejected_losses: Vec<Vec<f64>>,
    /// The effect that was added last.
    pub(crate) last: Option<&'p str>,
    pub(crate) left: usize,
    exchanges: usize,
    /// The effect that replaces the one that was just removed.
    pending_swap: Option<Found<'p>>,
    /// Cache of canonical models, without their columns.
    cache: Mutex<BTreeMap<Vec<&'p str>, CachedTerms<'p>>>,
    /// Structure from outside the library was found. Any effect that is added now would only imitate it.
    pub unmodelled_structure: bool,
}

impl<'l, 'p> FloatingSearch<'l, 'p> {
    /// `most` limits the number of added effects.
    pub fn new(
        start: LinearModel<'p>,
        library: &'l CandidateSet<'p>,
        prepared: &'p Prepared,
        most: usize,
        options: &'l Options,
    ) -> Self {
        let initial_terms = start.terms.iter().map(Term::id).collect();
        let mut plain = start.clone();
        // The effects that the test conditions of the run imply.
        let baseline = &prepared.baseline;
        plain
            .terms
            .retain(|t| baseline.is_empty() || baseline.iter().any(|b| b == t.id()) || t.effect.traits().is_exact);
        let exact = library.candidates.iter().filter(|c| c.effect.traits().is_exact);
        plain.terms.extend(exact.map(|c| c.term(start.problem)));
        plain.refine();
        let plain = plain.linear().sse;
        Self {
            now: start,
            prepared,
            library,
            options,
            plain,
            initial_terms,
            withdrawn: Vec::new(),
            reasons: BTreeMap::new(),
            retained_for_bias: Vec::new(),
            rejected_losses: Vec::new(),
            last: None,
            left: most,
            exchanges: MOST_EXCHANGES,
            pending_swap: None,
            cache: Mutex::default(),
            unmodelled_structure: false,
        }
    }

    pub(crate) fn step(&self, now: &LinearModel<'p>) -> Option<Found<'p>> {
        step(now, self.library, &self.withdrawn, self.threshold())
    }

    pub(crate) fn threshold(&self) -> AcceptanceThreshold<'_> {
        AcceptanceThreshold { plain: self.plain, kind: self.library.kind, options: self.options }
    }

    /// Removes an effect that was found to be wrong.
    pub fn withdraw(&mut self, id: &'p str, why: RemovalReason) -> Move<'p> {
        self.rejected_losses.push(validation_losses(&self.now));
        self.exclude(id, why)
    }

    /// Removes an effect that is not tried again.
    pub fn exclude(&mut self, id: &'p str, why: RemovalReason) -> Move<'p> {
        self.withdrawn.push(id);
        self.reasons.insert(id, why);
        self.remove(id, why)
    }

    /// Adds an effect that hardly changes the error, and keeps it.
    pub fn retain(&mut self, scored: ScoredCandidate<'p>) -> Move<'p> {
        self.retained_for_bias.push(scored.term.id());
        self.add(scored, Vec::new())
    }

    pub fn add(&mut self, scored: ScoredCandidate<'p>, ties: Vec<&'p str>) -> Move<'p> {
        self.left -= 1;
        let id = scored.term.id();
        self.now = self.model_with(id);
        self.last = Some(id);
        Move::Added { scored: scored.into(), ties }
    }

    fn remove(&mut self, id: &'p str, why: RemovalReason) -> Move<'p> {
        self.left += 1;
        self.drop(id, why)
    }

    /// Removes an effect; the next step adds the one that replaces it.
    pub fn exchange(&mut self, id: &'p str, replacement: Option<Found<'p>>, why: RemovalReason) -> Move<'p> {
        let of_exchange = |scored| ScoredCandidate { reason: AdditionReason::Exchange, ..scored };
        self.pending_swap = replacement.map(|(scored, ties)| (of_exchange(scored), ties));
        self.remove(id, why)
    }

    /// Takes one of the tries to exchange an effect; `false` if none is left.
    pub fn take_exchange(&mut self) -> bool {
        let left = self.exchanges.checked_sub(1);
        self.exchanges = left.unwrap_or(0);
        left.is_some()
    }

    /// Removes an effect that may be tried again, without a place for another one.
    pub fn drop(&mut self, id: &'p str, why: RemovalReason) -> Move<'p> {
        self.now = self.model_without(id);
        Move::Removed { id, why }
    }

    /// The candidate to add: the replacement of an exchanged effect, or the best one if there is a place for it. A
    /// candidate that explains significantly less than a removed effect is only a substitute for it.
    pub fn candidate(&mut self) -> Option<Found<'p>> {
        let found = self.pending_swap.take().or_else(|| if self.left > 0 { self.best() } else { None });
        let stands_in = |scored: &ScoredCandidate| {
            let clearly = |losses: &Vec<f64>| {
                losses.iter().sum::<f64>() < scored.validation_losses && !is_tie(losses, &scored.losses)
            };
            self.rejected_losses.iter().any(clearly)
        };
        found.filter(|(scored, _)| !stands_in(scored))
    }

    /// Residual maps of a model.
    pub(crate) fn maps_of(&self, model: &LinearModel) -> Maps {
        let residual = model.tangent().rest(&model.response());
        Maps::new(self.prepared, undersampled_harmonics::without_undersampled_harmonics(model, residual), self.options)
    }

    /// The next effect to add.
    fn best(&self) -> Option<Found<'p>> {
        let plain = self.step(&self.now);
        if !self.now.terms.iter().any(|term| self.can_absorb(term)) {
            return plain;
        }
        let than = plain
            .as_ref()
            .map_or_else(|| validation_losses(&self.now), |p| validation_losses(&self.model_with(p.0.term.id())));
        self.masked_by(&self.now, None, &than).or(plain)
    }

    /// A given effect with several coefficients can absorb a missing effect completely: without a viscous torque a
    /// Stribeck peak becomes negative and wide. This step searches for a candidate without that given effect. The
    /// candidate is returned if the model with both has a significantly smaller validation error than `than`.
    pub(crate) fn masked_by(&self, now: &LinearModel<'p>, but: Option<&'p str>, than: &[f64]) -> Option<Found<'p>> {
        now.terms.iter().filter(|term| self.can_absorb(term)).find_map(|given| {
            let out: Vec<&str> = self.withdrawn.iter().copied().chain([given.id()]).chain(but).collect();
            let (scored, ties) = step(&now.without(given.id()), self.library, &out, self.threshold())?;
            let losses = validation_losses(&self.canonical(now.terms.iter().map(Term::id).chain([scored.term.id()])));
            let less = 1.0 - losses.iter().sum::<f64>() / than.iter().sum::<f64>();
            let found = || (ScoredCandidate { reason: AdditionReason::Masked, ..scored }, ties);
            (less > self.options.practical_share && !is_tie(&losses, than)).then(found)
        })
    }

    /// Whether a given effect has more than one free parameter, so that it can absorb another one.
    fn can_absorb(&self, term: &Term) -> bool {
        self.initial_terms.contains(&term.id()) && term.size() > 1
    }

    /// The model with one additional effect.
    pub fn model_with(&self, id: &'p str) -> LinearModel<'p> {
        self.canonical(self.now.terms.iter().map(Term::id).chain([id]))
    }

    pub(crate) fn model_without(&self, id: &str) -> LinearModel<'p> {
        self.canonical(self.now.terms.iter().map(Term::id).filter(|other| *other != id))
    }

    /// The canonical model of these effects, from the cache if it was built before.
    fn canonical(&self, effects: impl Iterator<Item = &'p str>) -> LinearModel<'p> {
        let mut effects: Vec<&str> = effects.collect();
        effects.sort_unstable();
        let known = |cache: &BTreeMap<Vec<&str>, CachedTerms<'p>>| cache.get(&effects).cloned();
        if let Some(terms) = known(&self.cache.lock().unwrap_or_else(PoisonError::into_inner)) {
            let problem = self.now.problem;
            let terms =
                terms.into_iter().map(|(effect, form, shape)| Term::new(effect, form, shape, problem)).collect();
            return LinearModel { terms, ..self.now.clone() };
        }
        let made = fit_canonical(&self.now, &effects, self.library, self.options);
        let shapes = made.terms.iter().map(|term| (term.effect, term.form.clone(), term.shape.clone())).collect();
        self.cache.lock().unwrap_or_else(PoisonError::into_inner).insert(effects, shapes);
        made
    }

    /// Whether `scored` replaces an effect without loss and with physically possible coefficients.
    pub fn ties(&self, effect: &str, scored: &'p str) -> bool {
        let others = self.now.terms.iter().map(Term::id).filter(|id| *id != effect);
        let other = self.canonical(others.chain([scored]));
        let mut sized = other.terms.iter().zip(other.linear().coefficients);
        let is_possible = sized.all(|(term, coefficients)| term.id() != scored || term.allows(&coefficients));
        // The replacement of an effect that is kept for its bias must not bias the others.
        let is_elsewhere = self.retained_for_bias.contains(&effect) && self.is_biased_by(&other);
        is_possible && !is_elsewhere && is_tie(&validation_losses(&self.now), &validation_losses(&other))
    }

    /// Effects that explain nearly as much in place of a term, and are confounded with it.
    pub fn stand_ins(&self, term: &Term<'p>) -> Vec<&'p str> {
        let without = self.now.without(term.id());
        let partial = PartialRegression::of(&without);
        let enough = SIMPLER_GAIN * (1.0 - self.now.linear().sse / partial.sse);
        let mut near: Vec<(f64, &Regressor<'p>)> = Vec::new();
        for candidate in &self.library.candidates {
            let id = candidate.id();
            if id == term.id() || self.now.contains(id) || self.withdrawn.contains(&id) {
                continue;
            }
            let share = partial.orthogonalized(&candidate.columns).share;
            match near.iter_mut().find(|known| known.1.id() == id) {
                Some(known) if share > known.0 => *known = (share, candidate),
                None if share >= enough => near.push((share, candidate)),
                _ => {}
            }
        }
        near.retain(|(_, other)| {
            self.ties(term.id(), other.id())
                && !encompasses(&without, term, &other.term(self.now.problem), self.options)
        });
        near.into_iter().map(|(_, candidate)| candidate.id()).collect()
    }

    /// Effects that were added and are still in the model.
    pub fn added(&self) -> impl Iterator<Item = &Term<'p>> {
        self.now.terms.iter().filter(|t| !self.initial_terms.contains(&t.id()))
    }

    /// Added effects that have to be justified by the error.
    pub(crate) fn testable(&self) -> impl Iterator<Item = &Term<'p>> {
        self.added().filter(|term| !self.retained_for_bias.contains(&term.id()))
    }

    /// Effects that were removed and are not in the model, in the order of their removal.
    pub fn removals(&self) -> impl Iterator<Item = (&'p str, RemovalReason)> {
        let out = self.withdrawn.iter().copied().filter(|id| !self.now.contains(id));
        out.filter_map(|id| Some((id, *self.reasons.get(id)?)))
    }
}
