//! Reselects the forms of the effects in the model.

use crate::Options;
use crate::effect::ShapeSearch;
use crate::preprocess::Problem;
use crate::regression::candidates::{CandidateSet, Regressor};
use crate::regression::linear_model::{LinearModel, Term, allows, varpro};
use crate::regression::partial_regression::PartialRegression;
use crate::regression::significance::significance;
use crate::stats::information_criterion::is_better;

/// Adds a component to an effect that is a sum of components. The component has to pass the same tests as a new
/// effect.
pub fn extend<'p>(terms: &mut LinearModel<'p>, library: &CandidateSet<'p>, options: &Options) {
    for at in 0..terms.terms.len() {
        while let Some(longer) = one_more(terms, at, library, options) {
            terms.terms[at] = longer;
            terms.refine();
        }
    }
}

/// The term with the component that explains most, if that component is significant.
fn one_more<'p>(terms: &LinearModel<'p>, at: usize, library: &CandidateSet<'p>, options: &Options) -> Option<Term<'p>> {
    let term = &terms.terms[at];
    let (part, form) = term.effect.extended(&term.form)?;
    let partial = PartialRegression::of(terms);
    let share = |c: &Regressor| partial.orthogonalized(&c.columns).share;
    let is_part = |c: &&Regressor| c.id() == term.id() && c.form.name == part && !term.shape.contains(&c.shape[0]);
    let parts = library.candidates.iter().filter(is_part).map(|c| (share(c), c));
    let (share_of_part, part) = parts.max_by(|a, b| a.0.total_cmp(&b.0))?;
    let part = part.term(terms.problem);
    if share_of_part < options.practical_share || significance(&part, library, &partial, options) > options.alpha {
        return None;
    }
    let shape = term.shape.iter().chain(&part.shape).copied().collect();
    let longer = Term::new(term.effect, form, shape, terms.problem);
    let mut with = terms.clone();
    with.terms[at] = longer.clone();
    longer.allows(&with.linear().coefficients[at]).then_some(longer)
}

/// Reselects the form or the order of each effect, given all other effects of the model. Returns whether a form
/// changed. A form was chosen with fewer effects in the model and may no longer be the best.
pub fn reselect_forms<'p>(terms: &mut LinearModel<'p>, library: &CandidateSet<'p>) -> bool {
    let mut changed = false;
    for i in 0..terms.terms.len() {
        let mut others = terms.clone();
        let term = others.terms.remove(i);
        let same: Vec<_> = library.candidates.iter().filter(|c| c.id() == term.id()).collect();
        let of_order = term.form.shape.len() == 1 && term.form.shape[0].search == ShapeSearch::Whole;
        let is_open = |form: &str| form != term.form.name || of_order;
        if !same.iter().any(|c| is_open(c.form.name)) {
            continue;
        }
        let basis = others.tangent();
        let rest = basis.rest(&terms.response());
        let partial = PartialRegression::new(basis, rest, terms.problem);
        let sse = |term: &Term<'p>| {
            let mut one = [term.clone()];
            let sse = varpro(&mut one, &partial.basis, &partial.residual, terms.problem);
            let [term] = one;
            (sse, term)
        };
        let mut forms: Vec<&str> = same.iter().map(|c| c.form.name).filter(|f| is_open(f)).collect();
        forms.dedup();
        let share = |c: &&&Regressor| partial.orthogonalized(&c.columns).share;
        let start = |form: &str| {
            let of_form = same.iter().filter(|c| c.form.name == form);
            of_form.max_by(|a, b| share(a).total_cmp(&share(b))).map(|c| c.term(terms.problem))
        };
        let mut best = sse(&term);
        for trial in forms.into_iter().filter_map(start).chain(two_parts(&same, &partial, terms.problem)) {
            let trial = sse(&trial);
            // An equally long form has to be better by a margin; a shorter form may be a little worse.
            let more = match trial.1.size() as f64 - best.1.size() as f64 {
                0.0 => 1.0,
                more => more,
            };
            let possible = trial.1.allows(&partial.orthogonalized(&trial.1.columns).coefficients());
            if possible && is_better(trial.0, best.0, more, terms.problem.rows()) {
                best = trial;
            }
        }
        if best.1.form.name != term.form.name || of_order && best.1.shape != term.shape {
            terms.terms[i] = best.1;
            terms.refine();
            changed = true;
        }
    }
    changed
}

/// The two components that explain most together, for an effect that is a sum of components. Two dry contacts look
/// like one contact with gradual slip, and a third component added to that does not separate them.
fn two_parts<'p>(same: &[&Regressor<'p>], partial: &PartialRegression, problem: &Problem) -> Option<Term<'p>> {
    let smooth = |c: &&&Regressor| c.form.shape.iter().all(|s| s.is_smooth());
    let extends = |c: &&Regressor<'p>| c.effect.extended(&c.form).filter(|(part, _)| *part == c.form.name);
    let (part, form) = same.iter().filter(smooth).find_map(extends)?;
    let parts: Vec<&&Regressor> = same.iter().filter(|c| c.form.name == part).collect();
    let mut best: Option<(f64, Vec<f64>)> = None;
    for (i, one) in parts.iter().enumerate() {
        for other in &parts[..i] {
            let orthogonalized = partial.orthogonalized(&[&other.columns[..], &one.columns].concat());
            if best.as_ref().is_none_or(|b| orthogonalized.share > b.0)
                && allows(one.effect, &form, &orthogonalized.coefficients())
            {
                best = Some((orthogonalized.share, [&other.shape[..], &one.shape].concat()));
            }
        }
    }
    best.map(|(_, shape)| Term::new(same[0].effect, form, shape, problem))
}
