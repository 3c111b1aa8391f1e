//! Canonical fit: a set of effects gives the same model, independent of the order in which they were added.

use crate::Options;
use crate::effect::{Effect, Form, Shape};
use crate::preprocess::Problem;
use crate::regression::candidates::{CandidateSet, Regressor};
use crate::regression::form_selection::{extend, reselect_forms};
use crate::regression::linear_model::{LinearModel, Term, varpro};
use crate::regression::partial_regression::PartialRegression;
use crate::stats::information_criterion::is_better;
use rayon::prelude::*;

/// How many times the forms are reselected, each together with all other effects.
const PASSES: usize = 3;

/// Fits effects to the problem of `bare`: effects with a single form first, then repeatedly the effect that explains
/// most.
pub fn fit_canonical<'p>(
    bare: &LinearModel<'p>,
    effects: &[&str],
    library: &CandidateSet<'p>,
    options: &Options,
) -> LinearModel<'p> {
    let mut model = LinearModel { terms: Vec::new(), ..bare.clone() };
    let wanted = library.effects.iter().copied().filter(|e| effects.contains(&e.info().id));
    let (fixed, mut open): (Vec<_>, Vec<_>) = wanted.partition(|e| is_fixed(*e, model.problem));
    fixed.into_iter().for_each(|effect| enter(&mut model, effect));
    while !open.is_empty() {
        let partial = PartialRegression::of(&model);
        let best: Vec<Vec<(f64, &Regressor)>> = open.iter().map(|e| best_of_forms(*e, library, &partial)).collect();
        let share = |forms: &Vec<(f64, &Regressor)>| forms.iter().map(|f| f.0).fold(0.0, f64::max);
        let most = best.iter().map(share).enumerate().max_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |most| most.0);
        open.remove(most);
        let terms = best[most].iter().map(|(_, candidate)| candidate.term(model.problem)).collect();
        model.terms.extend(choose(terms, &partial, model.problem));
        model.refine();
    }
    for _ in 0..PASSES {
        if !reselect_forms(&mut model, library) {
            break;
        }
    }
    extend(&mut model, library, options);
    model
}

/// Whether the effect has only one form and one grid point. The single grid point of a set effect may be the start of a
/// search.
fn is_fixed(effect: &dyn Effect, problem: &Problem) -> bool {
    let is_start = |form: &Form| effect.traits().is_set && form.shape.iter().any(Shape::is_smooth);
    matches!(&effect.forms(&problem.view)[..], [form] if form.grid.len() == 1 && !is_start(form))
}

/// The best grid point of each form of an effect, with its partial R².
fn best_of_forms<'l, 'p>(
    effect: &dyn Effect,
    library: &'l CandidateSet<'p>,
    partial: &PartialRegression,
) -> Vec<(f64, &'l Regressor<'p>)> {
    let mut best: Vec<(f64, &Regressor)> = Vec::new();
    for candidate in library.candidates.iter().filter(|c| c.id() == effect.info().id) {
        let share = partial.orthogonalized(&candidate.columns).share;
        match best.iter_mut().find(|b| b.1.form.name == candidate.form.name) {
            Some(b) if share > b.0 => *b = (share, candidate),
            Some(_) => {}
            None => best.push((share, candidate)),
        }
    }
    best
}

/// Adds an effect in the form that explains most of the residual, each form at its best grid point.
pub fn enter<'p>(terms: &mut LinearModel<'p>, effect: &'p dyn Effect) {
    let problem: &Problem = terms.problem;
    let forms = effect.forms(&problem.view);
    if let [form] = &forms[..]
        && form.grid.len() == 1
    {
        terms.terms.push(Term::new(effect, form.clone(), form.grid[0].clone(), problem));
        return;
    }
    let partial = PartialRegression::of(terms);
    let mut best: Vec<Term<'p>> = Vec::new();
    for form in forms {
        let shapes = form.grid.iter().map(|shape| Term::new(effect, form.clone(), shape.clone(), problem));
        let shares = shapes.map(|term| (partial.orthogonalized(&term.columns).share, term));
        best.extend(shares.max_by(|a, b| a.0.total_cmp(&b.0)).map(|b| b.1));
    }
    terms.terms.extend(choose(best, &partial, problem));
}

/// The form that explains most. A form with more parameters has to explain sufficiently more. A physically impossible
/// form is chosen only if no form is possible.
fn choose<'p>(mut forms: Vec<Term<'p>>, partial: &PartialRegression, problem: &Problem) -> Option<Term<'p>> {
    forms.sort_by_key(Term::size);
    let polished = |term: Term<'p>| {
        let mut term = [term];
        let sse = varpro(&mut term, &partial.basis, &partial.residual, problem);
        let [term] = term;
        (term.allows(&partial.orthogonalized(&term.columns).coefficients()), sse, term)
    };
    let forms: Vec<(bool, f64, Term<'p>)> = forms.into_par_iter().map(polished).collect();
    let mut chosen: Option<(bool, f64, Term<'p>)> = None;
    for (possible, sse, term) in forms {
        let is_better = chosen.as_ref().is_none_or(|(as_possible, least, simple)| {
            let more = term.size().saturating_sub(simple.size()) as f64;
            possible == *as_possible && is_better(sse, *least, more, problem.rows()) || possible && !as_possible
        });
        if is_better {
            chosen = Some((possible, sse, term));
        }
    }
    chosen.map(|c| c.2)
}
