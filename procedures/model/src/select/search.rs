//! From a model to the model that is left when nothing more can be named.

use super::flips::{Null, Score};
use super::library::{Gain, Library, factors, gain};
use super::rivals::{encompasses, is_tie};
use crate::Options;
use crate::linear::{Basis, BlockGrams, dot};
use crate::prepare::Problem;
use crate::terms::{Term, Terms, polish};

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

pub enum Move<'p> {
    Added { rival: Box<Rival<'p>>, ties: Vec<&'p str> },
    Removed(&'p str),
}

/// A candidate that was looked for and not found.
pub struct Silence<'p> {
    pub effect: &'p str,
    /// RMS of the smallest one that would have been found with 80 % probability.
    pub detectable_rms: f64,
}

/// Held-out squared error of each fold.
pub fn held_out(terms: &Terms) -> Vec<f64> {
    let linear = terms.linear();
    losses(&terms.columns(), &linear.residual, terms.problem)
}

fn losses(columns: &[&[f64]], residual: &[f64], problem: &Problem) -> Vec<f64> {
    BlockGrams::new(columns, residual, &problem.fold, problem.folds).held_out()
}

/// Effects that are exchanged for others at most.
const EXCHANGES: usize = 2;

/// Adds the best effect again and again until none passes, and drops what lost its reason: one move at a time.
pub struct Search<'l, 'p> {
    pub now: Terms<'p>,
    library: &'l Library<'p>,
    options: &'l Options,
    /// Effects of the model that was given.
    kept: Vec<&'p str>,
    /// Effects that were withdrawn and are not tried again.
    withdrawn: Vec<&'p str>,
    left: usize,
    exchanges: usize,
}

impl<'l, 'p> Search<'l, 'p> {
    /// `most` effects are added at most.
    pub fn new(start: Terms<'p>, library: &'l Library<'p>, most: usize, options: &'l Options) -> Self {
        let kept = start.terms.iter().map(Term::id).collect();
        Self { now: start, library, options, kept, withdrawn: Vec::new(), left: most, exchanges: EXCHANGES }
    }

    /// Takes an effect back that turned out not to be the answer.
    pub fn withdraw(&mut self, id: &'p str) -> Move<'p> {
        self.withdrawn.push(id);
        self.remove(id)
    }

    fn remove(&mut self, id: &'p str) -> Move<'p> {
        self.now.terms.retain(|t| t.id() != id);
        self.now.refine();
        self.left += 1;
        Move::Removed(id)
    }

    /// An added effect in whose place another one makes the model clearly better: one effect that came first because it
    /// looks a little like two that are missing.
    fn misplaced(&self) -> Option<&'p str> {
        let present: f64 = held_out(&self.now).iter().sum();
        let ids: Vec<&'p str> = self.added().map(Term::id).collect();
        ids.into_iter().filter(|_| self.now.terms.len() > self.kept.len() + 1).find(|id| {
            let mut less = self.now.clone();
            less.terms.retain(|t| t.id() != *id);
            less.refine();
            let better = step(&less, self.library, &self.withdrawn, self.options);
            better.is_some_and(|(rival, _)| {
                rival.term.id() != *id && rival.held_out < (1.0 - self.options.practical_share) * present
            })
        })
    }

    /// Effects that were added and are still there.
    pub fn added(&self) -> impl Iterator<Item = &Term<'p>> {
        self.now.terms.iter().filter(|t| !self.kept.contains(&t.id()))
    }

    pub fn silences(&self) -> Vec<Silence<'p>> {
        silences(&self.now, self.library, &self.withdrawn, self.options)
    }
}

impl<'p> Iterator for Search<'_, 'p> {
    type Item = Move<'p>;

    fn next(&mut self) -> Option<Move<'p>> {
        if let Some((id, less)) = drop_one(&self.now, &self.kept, self.options) {
            self.now = less;
            return Some(Move::Removed(id));
        }
        let found = if self.left > 0 { step(&self.now, self.library, &self.withdrawn, self.options) } else { None };
        let Some((rival, ties)) = found else {
            self.exchanges = self.exchanges.checked_sub(1)?;
            let id = self.misplaced()?;
            return Some(self.remove(id));
        };
        self.left -= 1;
        self.now.terms.push(rival.term.clone());
        self.now.refine();
        reform(&mut self.now, self.library);
        extend(&mut self.now, self.library, self.options);
        Some(Move::Added { rival: rival.into(), ties })
    }
}

/// Most harmonics of one effect.
const MOST_HARMONICS: usize = 8;

/// Gives an effect of several harmonics another one, as long as that explains more than any effect that is not in the
/// model and passes the same tests.
fn extend(terms: &mut Terms, library: &Library, options: &Options) {
    let harmonic = |t: &Term| t.form.name == crate::effects::SEVERAL_HARMONICS && t.shape.len() < MOST_HARMONICS;
    while let Some(at) = terms.terms.iter().position(harmonic) {
        let basis = terms.tangent();
        let residual = basis.rest(&terms.response());
        let energy = dot(&residual, &residual);
        let own = terms.terms[at].id();
        let share = |c: &super::library::Candidate| gain(&c.columns, &basis, &residual, energy).share;
        let (mut next, mut other) = ((0.0, None), 0.0f64);
        for candidate in &library.candidates {
            if candidate.id() != own {
                if !terms.contains(candidate.id()) {
                    other = other.max(share(candidate));
                }
            } else if !terms.terms[at].shape.contains(&candidate.shape[0]) {
                let share = share(candidate);
                if share > next.0 {
                    next = (share, Some(candidate));
                }
            }
        }
        let (share, Some(candidate)) = next else { return };
        if share < options.practical_share.max(other) {
            return;
        }
        let p_value = significance(&candidate.term(), library, &basis, &residual, terms.problem, options);
        if p_value > options.alpha {
            return;
        }
        let term = &terms.terms[at];
        let shape: Vec<f64> = term.shape.iter().chain(&candidate.shape).copied().collect();
        let form = crate::effects::several_harmonics(shape.len());
        terms.terms[at] = Term::new(term.effect, form, shape, terms.problem);
    }
}

/// Another form must take this share off the squared error for each parameter that it has more.
const BETTER_FORM: f64 = 0.01;

/// Asks of every effect with several forms whether another one fits better beside the effects that came in since.
fn reform<'p>(terms: &mut Terms<'p>, library: &Library<'p>) {
    for i in 0..terms.terms.len() {
        let mut others = terms.clone();
        let term = others.terms.remove(i);
        let same: Vec<_> = library.candidates.iter().filter(|c| c.id() == term.id()).collect();
        if same.iter().all(|c| c.form.name == term.form.name) {
            continue;
        }
        let basis = others.tangent();
        let rest = basis.rest(&terms.response());
        let sse = |term: &Term<'p>| {
            let mut one = [term.clone()];
            let sse = polish(&mut one, &basis, &rest, terms.problem);
            let [term] = one;
            (sse, term)
        };
        let mut best = sse(&term);
        let mut forms: Vec<&str> = same.iter().map(|c| c.form.name).filter(|f| *f != term.form.name).collect();
        forms.dedup();
        for form in forms {
            let share = |c: &&&super::library::Candidate| gain(&c.columns, &basis, &rest, 1.0).share;
            let of_form = same.iter().filter(|c| c.form.name == form);
            let Some(start) = of_form.max_by(|a, b| share(a).total_cmp(&share(b))) else { continue };
            let trial = sse(&start.term());
            let more = trial.1.size().saturating_sub(best.1.size()).max(1) as f64;
            if trial.0 < best.0 * (1.0 - BETTER_FORM * more) {
                best = trial;
            }
        }
        if best.1.form.name != term.form.name {
            terms.terms[i] = best.1;
            terms.refine();
        }
    }
}

/// For each effect that is not in the model, its best form and shape: what would have been seen.
fn silences<'p>(end: &Terms<'p>, library: &Library<'p>, withdrawn: &[&'p str], options: &Options) -> Vec<Silence<'p>> {
    let problem = end.problem;
    let basis = end.tangent();
    let residual = basis.rest(&end.response());
    let n = problem.rows() as f64;
    let rms = (dot(&residual, &residual) / n).sqrt();
    let mut out: Vec<Silence> = Vec::new();
    let is_out = |id| !end.contains(id) && !withdrawn.contains(&id);
    for candidate in library.candidates.iter().filter(|c| is_out(c.id())) {
        let found = gain(&candidate.columns, &basis, &residual, 1.0);
        // z₀.₉₇₅ + z₀.₈ standard errors of the amplitude, and never less than the practical share.
        let noise = found
            .rest
            .iter()
            .map(|r| {
                let mut sums = vec![0.0; problem.blocks];
                r.iter().zip(&residual).zip(&problem.block).for_each(|((x, e), b)| sums[*b] += x * e);
                2.8 * (sums.iter().map(|s| s * s).sum::<f64>() / dot(r, r) / n).sqrt()
            })
            .fold(0.0, f64::max);
        let detectable_rms =
            if found.rest.is_empty() { f64::MAX } else { noise.max(options.practical_share.sqrt() * rms) };
        match out.iter_mut().find(|s| s.effect == candidate.id()) {
            Some(s) => s.detectable_rms = s.detectable_rms.min(detectable_rms),
            None => out.push(Silence { effect: candidate.id(), detectable_rms }),
        }
    }
    out.retain(|s| s.detectable_rms < f64::MAX);
    out
}

fn step<'p>(
    now: &Terms<'p>,
    library: &Library<'p>,
    withdrawn: &[&'p str],
    options: &Options,
) -> Option<(Rival<'p>, Vec<&'p str>)> {
    let problem = now.problem;
    let basis = now.tangent();
    let residual = basis.rest(&now.response());
    let energy = dot(&residual, &residual);
    let is_open = |id| !now.contains(id) && !withdrawn.contains(&id);
    let open: Vec<usize> = (0..library.candidates.len()).filter(|i| is_open(library.candidates[*i].id())).collect();
    let gains: Vec<Gain> =
        open.iter().map(|i| gain(&library.candidates[*i].columns, &basis, &residual, energy)).collect();

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

    let present: f64 = losses(&now.columns(), &residual, problem).iter().sum();
    let mut rivals: Vec<Rival> = best
        .iter()
        .map(|b| {
            let mut term = [library.candidates[open[*b]].term()];
            let sse = polish(&mut term, &basis, &residual, problem);
            let [term] = term;
            let possible = term.allows(&factors(&term.columns, &basis, &residual));
            let sse = if possible { sse } else { energy };
            let mut columns = now.columns();
            columns.extend(term.columns.iter().map(Vec::as_slice));
            let losses = losses(&columns, &residual, problem);
            Rival { share: 1.0 - sse / energy, held_out: losses.iter().sum(), p_value: 1.0, losses, term }
        })
        .filter(|r| r.share >= options.practical_share && r.held_out < present)
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

    let mut ties: Vec<usize> = (1..rivals.len()).filter(|i| is_tie(first, &rivals[*i])).collect();
    // Of what explains the data equally well, the simplest, and of those the one that the contract names first.
    let near = |i: &usize| rivals[*i].held_out < (1.0 + options.practical_share) * rivals[0].held_out;
    let rank = |i: &usize| {
        let id = rivals[*i].term.id();
        (rivals[*i].term.size(), library.candidates.iter().position(|c| c.id() == id))
    };
    let winner = ties.iter().copied().filter(near).chain([0]).min_by_key(rank).unwrap_or(0);
    ties.push(0);
    ties.retain(|i| *i != winner && !encompasses(now, &rivals[winner].term, &rivals[*i].term, options));

    let ties = ties.into_iter().map(|i| rivals[i].term.id()).collect();
    let mut rival = rivals.swap_remove(winner);
    let scores = gains.iter().map(|g| Score::new(&g.rest, &residual, &problem.block, problem.blocks)).collect();
    rival.p_value = family_wise(&rival.term, scores, &basis, &residual, problem, options);
    (rival.p_value <= options.alpha).then_some((rival, ties))
}

/// How often noise alone would bring any candidate of the library as far as this one: the family-wise p-value.
pub fn significance(
    term: &Term,
    library: &Library,
    basis: &Basis,
    residual: &[f64],
    problem: &Problem,
    options: &Options,
) -> f64 {
    let score = |columns: &[Vec<f64>]| {
        Score::new(&gain(columns, basis, residual, 1.0).rest, residual, &problem.block, problem.blocks)
    };
    let scores = library.candidates.iter().map(|c| score(&c.columns)).collect();
    family_wise(term, scores, basis, residual, problem, options)
}

/// The same from scores that are there already.
pub(super) fn family_wise(
    term: &Term,
    mut scores: Vec<Score>,
    basis: &Basis,
    residual: &[f64],
    problem: &Problem,
    options: &Options,
) -> f64 {
    let own = gain(&term.columns, basis, residual, 1.0);
    let own = Score::new(&own.rest, residual, &problem.block, problem.blocks);
    let z = own.z();
    scores.push(own);
    Null::new(&scores, problem.blocks, options.flips, options.seed).p_value(z)
}

/// The added term without which the model is as good, with the model without it.
fn drop_one<'p>(now: &Terms<'p>, kept: &[&'p str], options: &Options) -> Option<(&'p str, Terms<'p>)> {
    let full = now.linear().sse;
    let mut worst: Option<(f64, usize, Terms)> = None;
    for i in 0..now.terms.len() {
        if kept.contains(&now.terms[i].id()) || i + 1 == now.terms.len() {
            continue;
        }
        let mut less = now.clone();
        less.terms.remove(i);
        less.refine();
        let sse = less.linear().sse;
        let share = 1.0 - full / sse;
        if share < options.practical_share && worst.as_ref().is_none_or(|w| share < w.0) {
            worst = Some((share, i, less));
        }
    }
    worst.map(|(_, i, less)| (now.terms[i].id(), less))
}
