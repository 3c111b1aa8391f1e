//! The candidates of one step: which is best, whether it is more than luck, and what the run cannot tell it from.

use super::flips::{Null, Score};
use super::ground::{Ground, Own};
use super::library::Library;
use super::scatter;
use super::waves;
use crate::Options;
use crate::effect::Stage;
use crate::linear::Beside;
use crate::terms::{Term, Terms, polish};
use jointbench_instrument::Kind;
use rayon::prelude::*;

/// Candidates that are refined and held against each other at each step.
const SHORT_LIST: usize = 8;

/// A candidate of one step with its evidence.
#[derive(Clone)]
pub struct Rival<'p> {
    pub term: Term<'p>,
    /// Share of the remaining squared error.
    pub share: f64,
    /// Held-out squared error of the model with it.
    pub held_out: f64,
    pub p_value: f64,
    /// Held-out squared error of each fold.
    pub(super) losses: Vec<f64>,
}

impl<'p> Rival<'p> {
    /// A candidate that was judged apart from the others, without folds.
    pub fn alone(term: Term<'p>, share: f64, p_value: f64) -> Self {
        Self { term, share, held_out: f64::NAN, p_value, losses: Vec::new() }
    }
}

/// What an effect must explain to be worth a name.
#[derive(Clone, Copy)]
pub struct Bar<'l> {
    /// Squared error of the baseline, with what formulas explain that are exact.
    pub plain: f64,
    pub kind: Kind,
    pub options: &'l Options,
}

/// No formula fits nature better than to this share of what it explains, squared (4.5 % in RMS). But an encoder's errors
/// are waves over its own angle, steps and slopes: their formulas are no approximations.
fn form_error(kind: Kind) -> f64 {
    if kind == Kind::Encoder { 0.0 } else { 0.002 }
}

/// The formula of an effect with a memory leaves far more of what it explains: on simulated joints 2 to 17 % of the squared
/// error around reversals.
const MEMORY_FORM_ERROR: f64 = 0.17;

/// What the formulas of effects with a memory may leave of what they explain, squared.
pub(super) fn left_by_memory(now: &Terms) -> f64 {
    let remembering = now.terms.iter().filter(|term| term.effect.stage() == Stage::Memory);
    let explained = remembering.map(|term| now.without(term.id()).linear().sse - now.linear().sse);
    MEMORY_FORM_ERROR * explained.sum::<f64>()
}

/// A simpler effect is as good as another where it brings this share of what that one brings: beside noise everything is
/// near in held-out error.
pub(super) const MOST_OF_GAIN: f64 = 0.8;

/// What takes so much of the error that is left is no remainder of another effect's formula.
const UNMISTAKABLE: f64 = 0.5;

impl Bar<'_> {
    /// The least share of the squared error `energy` that an effect must take beside a model: what the formulas of its
    /// effects may leave is none.
    pub fn least_share(&self, now: &Terms, energy: f64) -> f64 {
        let remainder = form_error(self.kind) * (self.plain - energy).max(0.0) + left_by_memory(now);
        self.options.practical_share.max((remainder / energy).min(UNMISTAKABLE))
    }

    /// No friction becomes negative beside another: a wave over short strokes can look like a constant.
    fn leaves_possible(&self, now: &Terms, term: &Term) -> bool {
        if self.kind != Kind::Friction {
            return true;
        }
        let mut with = now.clone();
        with.terms.push(term.clone());
        let (was, is) = (now.linear().factors, with.linear().factors);
        let mut changes = now.terms.iter().zip(was.iter().zip(&is));
        changes.all(|(t, (was, is))| !t.allows(was) || t.allows(is)) && !is_of_its_row(&with, &is)
    }
}

/// Its delay leaves the torque between the moments of its row's position and velocity: it is as late as the row is long.
fn is_of_its_row(with: &Terms, factors: &[Vec<f64>]) -> bool {
    let factor = |id| with.terms.iter().position(|t| t.id() == id).and_then(|at| factors[at].first());
    match (with.problem.view.constants.of_row_s, factor("signal_delay"), factor("inertia")) {
        (Some([a, b]), Some(k_j), Some(j)) => (a.min(b)..=a.max(b)).contains(&(-k_j / j)),
        _ => false,
    }
}

/// The effect that makes the model best, with those that it ties with.
pub fn step<'p>(
    now: &Terms<'p>,
    library: &Library<'p>,
    withdrawn: &[&'p str],
    bar: Bar,
) -> Option<(Rival<'p>, Vec<&'p str>)> {
    let options = bar.options;
    let problem = now.problem;
    let ground = Ground::of(now);
    let Ground { basis, residual, energy, .. } = &ground;
    let energy = *energy;
    let is_open = |id| !now.contains(id) && !withdrawn.contains(&id);
    let open: Vec<usize> = (0..library.candidates.len()).filter(|i| is_open(library.candidates[*i].id())).collect();
    let gains: Vec<Own> = open.par_iter().map(|i| ground.own(&library.candidates[*i].columns)).collect();

    // The best shape of each form of each effect, the most telling first.
    let mut best: Vec<usize> = Vec::new();
    let form = |at: usize| (library.candidates[open[at]].id(), library.candidates[open[at]].form.name);
    for at in 0..open.len() {
        match best.iter_mut().find(|b| form(**b) == form(at)) {
            Some(b) if gains[at].share > gains[*b].share => *b = at,
            Some(_) => {}
            None => best.push(at),
        }
    }
    best.sort_by(|a, b| gains[*b].share.total_cmp(&gains[*a].share));
    best.truncate(SHORT_LIST);
    best.retain(|b| gains[*b].share > 0.5 * options.practical_share);
    if best.is_empty() {
        return None;
    }

    let least_share = bar.least_share(now, energy);
    let worth_it: Vec<(Term, f64)> = best
        .par_iter()
        .map(|b| {
            let mut term = [library.candidates[open[*b]].term(problem)];
            let sse = polish(&mut term, basis, residual, problem);
            let [term] = term;
            let possible = term.allows(&ground.own(&term.columns).factors()) && bar.leaves_possible(now, &term);
            let possible = possible
                && !scatter::could_be(&term, now, &ground, bar.kind, options)
                && !waves::is_none(&term, now, &ground);
            let sse = if possible { sse } else { energy };
            (term, 1.0 - sse / energy)
        })
        .filter(|(term, share)| *share >= least_share.max(waves::least_share(term)))
        .collect();
    let sets = std::iter::once([].as_slice()).chain(worth_it.iter().map(|(term, _)| term.columns.as_slice()));
    let beside = Beside::new(&now.columns(), sets, residual, &problem.fold, problem.folds);
    let present: f64 = beside.grams(0).held_out().iter().sum();
    let mut rivals: Vec<Rival> = worth_it
        .par_iter()
        .enumerate()
        .map(|(k, (term, share))| {
            let losses = beside.grams(1 + k).held_out();
            Rival { term: term.clone(), share: *share, held_out: losses.iter().sum(), p_value: 1.0, losses }
        })
        .filter(|r| r.held_out < present)
        .collect();
    rivals.sort_by(|a, b| a.held_out.total_cmp(&b.held_out));
    // The forms of one effect are one group: the best of them speaks for it.
    let mut seen: Vec<&str> = Vec::new();
    rivals.retain(|r| {
        !seen.contains(&r.term.id()) && {
            seen.push(r.term.id());
            true
        }
    });
    let first = rivals.first()?;

    let mut ties: Vec<usize> = (1..rivals.len()).filter(|i| is_tie(&first.losses, &rivals[*i].losses)).collect();
    // Of what explains the data equally well, the simplest, and of those the one that the contract names first.
    let near = |i: &usize| {
        let gain = |i: usize| present - rivals[i].held_out;
        let as_good = rivals[*i].held_out < (1.0 + options.practical_share) * rivals[0].held_out;
        as_good && gain(*i) >= MOST_OF_GAIN * gain(0)
    };
    let rank = |i: &usize| {
        let id = rivals[*i].term.id();
        (rivals[*i].term.size(), library.candidates.iter().position(|c| c.id() == id))
    };
    let winner = ties.iter().copied().filter(near).chain([0]).min_by_key(rank).unwrap_or(0);
    ties.push(0);
    ties.retain(|i| *i != winner && !encompasses(now, &rivals[winner].term, &rivals[*i].term, options));

    let ties = ties.into_iter().map(|i| rivals[i].term.id()).collect();
    let mut rival = rivals.swap_remove(winner);
    let scores =
        open.par_iter().zip(&gains).map(|(i, own)| ground.score(&library.candidates[*i].columns, own)).collect();
    rival.p_value = family_wise(&rival.term.columns, scores, &ground, options);
    (rival.p_value <= options.alpha).then_some((rival, ties))
}

/// How often noise alone would bring any candidate of the library as far as this one: the family-wise p-value.
pub fn significance(term: &Term, library: &Library, ground: &Ground, options: &Options) -> f64 {
    let scores = library.candidates.iter().map(|c| ground.score(&c.columns, &ground.own(&c.columns)));
    family_wise(&term.columns, scores.collect(), ground, options)
}

/// The p-value of one effect that nothing else was tried beside.
pub fn alone(term: &Term, ground: &Ground, options: &Options) -> f64 {
    chance(&term.columns, ground, options)
}

/// The same of its columns.
pub(super) fn chance(columns: &[Vec<f64>], ground: &Ground, options: &Options) -> f64 {
    family_wise(columns, Vec::new(), ground, options)
}

/// The same from scores that are there already.
fn family_wise(columns: &[Vec<f64>], mut scores: Vec<Score>, ground: &Ground, options: &Options) -> f64 {
    let own = ground.score(columns, &ground.own(columns));
    let z = own.z().max(ground.jackknife_z(columns).unwrap_or(f64::NEG_INFINITY));
    scores.push(own);
    Null::new(&scores, options.flips, options.seed).p_value(z)
}

/// Two models tie where the difference of their held-out errors is not larger than its own scatter over the folds.
pub fn is_tie(a: &[f64], b: &[f64]) -> bool {
    let differences: Vec<f64> = b.iter().zip(a).map(|(b, a)| b - a).collect();
    let n = differences.len() as f64;
    let mean = differences.iter().sum::<f64>() / n;
    let spread = (differences.iter().map(|d| (d - mean).powi(2)).sum::<f64>() / (n - 1.0).max(1.0)).sqrt();
    differences.iter().sum::<f64>() <= 2.0 * n.sqrt() * spread + 1e-9 * a.iter().sum::<f64>()
}

/// Whether the model with `one` leaves nothing that matters for `other`, and the other way round it does (the encompassing
/// test of Davidson and MacKinnon 1981, by sign flips of blocks). Two effects may be apart in few of the folds, and clearly.
pub(super) fn encompasses(now: &Terms, one: &Term, other: &Term, options: &Options) -> bool {
    let left_for = |beside: &Term, there: &Term| {
        let mut with = now.clone();
        with.terms.push(there.clone());
        with.refine();
        let ground = Ground::of(&with);
        (ground.own(&beside.columns).share, alone(beside, &ground, options))
    };
    let ((needed, p_value), (needless, _)) = (left_for(one, other), left_for(other, one));
    needed >= options.practical_share && p_value <= options.alpha && needless < options.practical_share
}
