//! One forward step: the best candidate, its significance, and the effects that are confounded with it.

use crate::Options;
use crate::linear::augmented_gram::AugmentedGrams;
use crate::regression::candidates::{CandidateSet, Regressor};
use crate::regression::linear_model::{LinearModel, Term, varpro};
use crate::regression::partial_regression::{Orthogonalized, PartialRegression};
use crate::regression::significance::family_wise;
use crate::report::reasons::AdditionReason;
use crate::selection::acceptance::Candidate;
use crate::selection::acceptance::formula_error::AcceptanceThreshold;

use crate::regression::cross_validation::is_tie;
use crate::selection::equivalence::encompasses;
use crate::thresholds::SIMPLER_GAIN;
use rayon::prelude::*;

/// Candidates that are refined and cross-validated in each step.
const SHORT_LIST: usize = 8;

/// A candidate of one step with its evidence.
#[derive(Clone)]
pub struct ScoredCandidate<'p> {
    pub term: Term<'p>,
    /// Partial R²: share of the remaining squared error.
    pub share: f64,
    /// Squared validation error of the model with this candidate.
    pub validation_losses: f64,
    pub p_value: f64,
    pub reason: AdditionReason,
    /// `share` is relative to a model without the nuisance terms that imitate the effect.
    pub is_without_form_error: bool,
    /// Squared validation error of each fold.
    pub(crate) losses: Vec<f64>,
}

impl<'p> ScoredCandidate<'p> {
    /// A candidate that was tested alone, without folds.
    pub fn alone(term: Term<'p>, share: f64, p_value: f64, reason: AdditionReason) -> Self {
        Self {
            term,
            share,
            validation_losses: f64::NAN,
            p_value,
            reason,
            is_without_form_error: false,
            losses: Vec::new(),
        }
    }
}

/// The effect with the smallest validation error, and the effects that tie with it.
pub fn step<'p>(
    now: &LinearModel<'p>,
    library: &CandidateSet<'p>,
    withdrawn: &[&'p str],
    threshold: AcceptanceThreshold,
) -> Option<(ScoredCandidate<'p>, Vec<&'p str>)> {
    let options = threshold.options;
    let partial = PartialRegression::of(now);
    if now.is_negligible((partial.sse / now.problem.rows() as f64).sqrt(), threshold.kind) {
        return None;
    }
    let is_open = |candidate: &&Regressor| !now.contains(candidate.id()) && !withdrawn.contains(&candidate.id());
    let open: Vec<&Regressor> = library.candidates.iter().filter(is_open).collect();
    let gains: Vec<Orthogonalized> =
        open.par_iter().map(|candidate| partial.orthogonalized(&candidate.columns)).collect();
    let best = short_list(&open, &gains, options);
    if best.is_empty() {
        return None;
    }
    let acceptable = acceptable(now, &best, &partial, threshold);
    let (mut ranked, present) = cross_validated(now, &acceptable, &partial.residual);
    let (winner, ties) = winner_and_ties(now, &ranked, present, library, options)?;
    let mut scored = ranked.swap_remove(winner);
    let scores = open.par_iter().zip(&gains).map(|(candidate, own)| partial.score(&candidate.columns, own)).collect();
    scored.p_value = family_wise(&scored.term.columns, scores, &partial, options);
    (scored.p_value <= options.alpha).then_some((scored, ties))
}

/// The best grid point of each form of each effect, by decreasing partial R². Formulas of users have places of their
/// own: many of them do not displace an effect of the library.
fn short_list<'l, 'p>(
    open: &[&'l Regressor<'p>],
    gains: &[Orthogonalized],
    options: &Options,
) -> Vec<&'l Regressor<'p>> {
    let mut best: Vec<usize> = Vec::new();
    let form = |at: usize| (open[at].id(), open[at].form.name);
    for at in 0..open.len() {
        match best.iter_mut().find(|b| form(**b) == form(at)) {
            Some(b) if gains[at].share > gains[*b].share => *b = at,
            Some(_) => {}
            None => best.push(at),
        }
    }
    best.sort_by(|a, b| gains[*b].share.total_cmp(&gains[*a].share));
    best.retain(|b| gains[*b].share > 0.5 * options.practical_share);
    let (of_users, of_library): (Vec<_>, Vec<_>) =
        best.into_iter().map(|at| open[at]).partition(|candidate| candidate.effect.traits().is_user_defined);
    [of_library, of_users].into_iter().flat_map(|list| list.into_iter().take(SHORT_LIST)).collect()
}

/// The refined candidates that no acceptance rule refuses, each with its partial R².
fn acceptable<'p>(
    now: &LinearModel<'p>,
    best: &[&Regressor<'p>],
    partial: &PartialRegression,
    threshold: AcceptanceThreshold,
) -> Vec<(Term<'p>, f64)> {
    best.par_iter()
        .filter_map(|candidate| {
            let mut term = [candidate.term(now.problem)];
            let sse = varpro(&mut term, &partial.basis, &partial.residual, now.problem);
            let [term] = term;
            let share = 1.0 - sse / partial.sse;
            let is_acceptable = Candidate { term: &term, share, now, partial, threshold }.is_acceptable();
            is_acceptable.then_some((term, share))
        })
        .collect()
}

/// The candidates that reduce the validation error, by increasing error, and the present error. The best form of an
/// effect represents all its forms.
fn cross_validated<'p>(
    now: &LinearModel<'p>,
    candidates: &[(Term<'p>, f64)],
    residual: &[f64],
) -> (Vec<ScoredCandidate<'p>>, f64) {
    let problem = now.problem;
    let sets = std::iter::once([].as_slice()).chain(candidates.iter().map(|(term, _)| term.columns.as_slice()));
    let grams = AugmentedGrams::new(&now.columns(), sets, residual, &problem.fold, problem.folds);
    let present: f64 = grams.grams(0).validation_losses().iter().sum();
    let mut ranked: Vec<ScoredCandidate> = candidates
        .par_iter()
        .enumerate()
        .map(|(k, (term, share))| {
            let losses = grams.grams(1 + k).validation_losses();
            ScoredCandidate {
                term: term.clone(),
                share: *share,
                validation_losses: losses.iter().sum(),
                p_value: 1.0,
                reason: AdditionReason::ErrorReduction,
                is_without_form_error: false,
                losses,
            }
        })
        .filter(|r| r.validation_losses < present)
        .collect();
    ranked.sort_by(|a, b| a.validation_losses.total_cmp(&b.validation_losses));
    let mut seen: Vec<&str> = Vec::new();
    ranked.retain(|r| {
        !seen.contains(&r.term.id()) && {
            seen.push(r.term.id());
            true
        }
    });
    (ranked, present)
}

/// Among equal candidates an effect of the library wins over a formula of a user, then the one with the fewest columns,
/// then the first one in the order of the library.
fn winner_and_ties<'p>(
    now: &LinearModel<'p>,
    ranked: &[ScoredCandidate<'p>],
    present: f64,
    library: &CandidateSet,
    options: &Options,
) -> Option<(usize, Vec<&'p str>)> {
    let first = ranked.first()?;
    let mut ties: Vec<usize> = (1..ranked.len()).filter(|i| is_tie(&first.losses, &ranked[*i].losses)).collect();
    let is_own = |i: usize| ranked[i].term.effect.traits().is_user_defined;
    // A formula of a user has to explain more than an effect of the library, not only to fit this data slightly better.
    let explains_the_same =
        |i: usize| is_own(0) && !is_own(i) && !encompasses(now, &first.term, &ranked[i].term, options);
    let near = |i: &usize| {
        let gain = |i: usize| present - ranked[i].validation_losses;
        let as_good = ranked[*i].validation_losses < (1.0 + options.practical_share) * first.validation_losses;
        gain(*i) >= SIMPLER_GAIN * gain(0) && (as_good || explains_the_same(*i))
    };
    let rank = |i: &usize| {
        let id = ranked[*i].term.id();
        (is_own(*i), ranked[*i].term.size(), library.candidates.iter().position(|c| c.id() == id))
    };
    let winner = ties.iter().copied().filter(near).chain([0]).min_by_key(rank).unwrap_or(0);
    ties.push(0);
    ties.retain(|i| *i != winner && !encompasses(now, &ranked[winner].term, &ranked[*i].term, options));
    Some((winner, ties.into_iter().map(|i| ranked[i].term.id()).collect()))
}
