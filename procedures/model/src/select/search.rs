//! From a model to the model that is left when nothing more can be named.

use super::ground::Ground;
use super::library::{Candidate, Library};
use super::rivals::{Bar, Rival, significance, step};
use crate::Options;
use crate::linear::{BlockGrams, dot};
use crate::prepare::Problem;
use crate::terms::{Term, Terms, polish};

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

pub(super) fn losses(columns: &[&[f64]], residual: &[f64], problem: &Problem) -> Vec<f64> {
    BlockGrams::new(columns, residual, &problem.fold, problem.folds).held_out()
}

/// Effects that are exchanged for others at most.
const EXCHANGES: usize = 2;

/// Adds the best effect again and again until none passes, and drops what lost its reason: one move at a time.
pub struct Search<'l, 'p> {
    pub now: Terms<'p>,
    library: &'l Library<'p>,
    options: &'l Options,
    /// Squared error of the model without any effect but those of the baseline.
    plain: f64,
    /// Effects of the model that was given.
    kept: Vec<&'p str>,
    /// Effects that were withdrawn and are not tried again.
    withdrawn: Vec<&'p str>,
    left: usize,
    exchanges: usize,
    /// Something from outside the library was seen: whatever entered now would stand for it.
    pub closed: bool,
}

impl<'l, 'p> Search<'l, 'p> {
    /// `most` effects are added at most. `baseline` is what the run's own facts take for granted.
    pub fn new(
        start: Terms<'p>,
        library: &'l Library<'p>,
        baseline: &[String],
        most: usize,
        options: &'l Options,
    ) -> Self {
        let kept = start.terms.iter().map(Term::id).collect();
        let mut plain = start.clone();
        plain.terms.retain(|t| baseline.is_empty() || baseline.iter().any(|b| b == t.id()));
        plain.refine();
        let plain = plain.linear().sse;
        Self {
            now: start,
            library,
            options,
            plain,
            kept,
            withdrawn: Vec::new(),
            left: most,
            exchanges: EXCHANGES,
            closed: false,
        }
    }

    fn step(&self, now: &Terms<'p>) -> Option<(Rival<'p>, Vec<&'p str>)> {
        step(now, self.library, &self.withdrawn, Bar { plain: self.plain, options: self.options })
    }

    /// Takes an effect back that turned out not to be the answer.
    pub fn withdraw(&mut self, id: &'p str) -> Move<'p> {
        self.withdrawn.push(id);
        self.remove(id)
    }

    fn remove(&mut self, id: &'p str) -> Move<'p> {
        self.now = self.without(id);
        self.left += 1;
        Move::Removed(id)
    }

    /// An added effect in whose place another one makes the model clearly better: one effect that came first because it
    /// looks a little like two that are missing.
    fn misplaced(&self) -> Option<&'p str> {
        let present: f64 = held_out(&self.now).iter().sum();
        let ids: Vec<&'p str> = self.added().map(Term::id).collect();
        ids.into_iter().filter(|_| self.now.terms.len() > self.kept.len() + 1).find(|id| {
            let better = self.step(&self.without(id));
            better.is_some_and(|(rival, _)| {
                rival.term.id() != *id && rival.held_out < (1.0 - self.options.practical_share) * present
            })
        })
    }

    /// The model without one of its effects.
    pub fn without(&self, id: &str) -> Terms<'p> {
        let mut less = self.now.clone();
        less.terms.retain(|t| t.id() != id);
        less.refine();
        less
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
        if self.closed {
            return None;
        }
        let found = if self.left > 0 { self.step(&self.now) } else { None };
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

/// Gives an effect of several parts another one, as long as that explains more than any effect that is not in the model
/// and passes the same tests.
fn extend<'p>(terms: &mut Terms<'p>, library: &Library<'p>, options: &Options) {
    for at in 0..terms.terms.len() {
        while let Some(longer) = one_more(terms, at, library, options) {
            terms.terms[at] = longer;
            terms.refine();
        }
    }
}

/// The term with the part that explains most, where that is worth it.
fn one_more<'p>(terms: &Terms<'p>, at: usize, library: &Library<'p>, options: &Options) -> Option<Term<'p>> {
    let term = &terms.terms[at];
    let (part, form) = term.effect.extended(&term.form)?;
    let ground = Ground::of(terms);
    let share = |c: &Candidate| ground.own(&c.columns).share;
    let is_part = |c: &&Candidate| c.id() == term.id() && c.form.name == part && !term.shape.contains(&c.shape[0]);
    let parts = library.candidates.iter().filter(is_part).map(|c| (share(c), c));
    let (share_of_part, part) = parts.max_by(|a, b| a.0.total_cmp(&b.0))?;
    let others = library.candidates.iter().filter(|c| !terms.contains(c.id()));
    let enough = others.map(share).fold(options.practical_share, f64::max);
    if share_of_part < enough || significance(&part.term(), library, &ground, options) > options.alpha {
        return None;
    }
    let shape = term.shape.iter().chain(&part.shape).copied().collect();
    let longer = Term::new(term.effect, form, shape, terms.problem);
    let mut with = terms.clone();
    with.terms[at] = longer.clone();
    longer.allows(&with.linear().factors[at]).then_some(longer)
}

/// Another form must take this share off the squared error for each parameter that it has more.
const BETTER_FORM: f64 = 0.01;

/// Asks of every effect with several forms, or with an order that was found beside fewer effects, whether another one
/// fits better beside the effects that came in since.
fn reform<'p>(terms: &mut Terms<'p>, library: &Library<'p>) {
    for i in 0..terms.terms.len() {
        let mut others = terms.clone();
        let term = others.terms.remove(i);
        let same: Vec<_> = library.candidates.iter().filter(|c| c.id() == term.id()).collect();
        let of_order = term.form.shape.len() == 1 && term.form.shape[0].search == crate::effect::Search::Whole;
        let is_open = |form: &str| form != term.form.name || of_order;
        if !same.iter().any(|c| is_open(c.form.name)) {
            continue;
        }
        let basis = others.tangent();
        let rest = basis.rest(&terms.response());
        let ground = Ground::new(basis, rest, terms.problem);
        let sse = |term: &Term<'p>| {
            let mut one = [term.clone()];
            let sse = polish(&mut one, &ground.basis, &ground.residual, terms.problem);
            let [term] = one;
            (sse, term)
        };
        let mut best = sse(&term);
        let mut forms: Vec<&str> = same.iter().map(|c| c.form.name).filter(|f| is_open(f)).collect();
        forms.dedup();
        for form in forms {
            let share = |c: &&&Candidate| ground.own(&c.columns).share;
            let of_form = same.iter().filter(|c| c.form.name == form);
            let Some(start) = of_form.max_by(|a, b| share(a).total_cmp(&share(b))) else { continue };
            let trial = sse(&start.term());
            let more = trial.1.size().saturating_sub(best.1.size()).max(1) as f64;
            if trial.0 < best.0 * (1.0 - BETTER_FORM * more) {
                best = trial;
            }
        }
        if best.1.form.name != term.form.name || of_order && best.1.shape != term.shape {
            terms.terms[i] = best.1;
            terms.refine();
        }
    }
}

/// For each effect that is not in the model, its best form and shape: what would have been seen.
fn silences<'p>(end: &Terms<'p>, library: &Library<'p>, withdrawn: &[&'p str], options: &Options) -> Vec<Silence<'p>> {
    let ground = Ground::of(end);
    let n = end.problem.rows() as f64;
    let rms = (ground.energy / n).sqrt();
    let mut out: Vec<Silence> = Vec::new();
    let is_out = |id| !end.contains(id) && !withdrawn.contains(&id);
    for candidate in library.candidates.iter().filter(|c| is_out(c.id())) {
        let own = ground.own(&candidate.columns);
        let sums = ground.sums(&candidate.columns, &own);
        // z₀.₉₇₅ + z₀.₈ standard errors of the amplitude, and never less than the practical share.
        let noise = sums.iter().zip(own.squares()).map(|(s, square)| 2.8 * (dot(s, s) / square / n).sqrt());
        let noise = noise.fold(0.0, f64::max);
        let detectable_rms = if sums.is_empty() { f64::MAX } else { noise.max(options.practical_share.sqrt() * rms) };
        match out.iter_mut().find(|s| s.effect == candidate.id()) {
            Some(s) => s.detectable_rms = s.detectable_rms.min(detectable_rms),
            None => out.push(Silence { effect: candidate.id(), detectable_rms }),
        }
    }
    out.retain(|s| s.detectable_rms < f64::MAX);
    out
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
