//! Canonical model of a run that is judged sample by sample: the same set of effects gives the same model,
//! independent of their order.

use crate::effect::{Effect, ShapeSearch};
use crate::regression::candidates::{CandidateSet, Regressor};
use crate::regression::evidence::{errors, visible};
use crate::regression::linear_model::{LinearModel, Term, allows};
use crate::regression::solution::Solution;
use crate::thresholds::{DECISION_SHARE, ONE_ERROR};
use rayon::prelude::*;
use std::sync::Arc;

/// Fits effects in addition to the offset terms of `bare`: effects with a single form first, then repeatedly the
/// effect that explains most. The other forms of an effect are added with a ridge penalty, so that the grid need not
/// be fine.
pub fn fit_canonical<'p>(
    bare: &LinearModel<'p>,
    effects: &[&'p dyn Effect],
    library: &CandidateSet<'p>,
) -> LinearModel<'p> {
    let problem = bare.problem;
    let mut model = LinearModel { terms: Vec::new(), relatives: Arc::default(), ..bare.clone() };
    let forms_of = |effect: &dyn Effect| -> Vec<&Regressor<'p>> {
        library.candidates.iter().filter(|c| c.id() == effect.info().id).collect()
    };
    let mut open: Vec<Vec<&Regressor<'p>>> = Vec::new();
    for effect in effects {
        match &forms_of(*effect)[..] {
            [] => {}
            [only] => model.terms.push(only.term(problem)),
            several => open.push(several.to_vec()),
        }
    }
    while !open.is_empty() {
        let best: Vec<(f64, usize)> = match Solution::of(&model) {
            Some(solution) => open.iter().map(|forms| best_form(&solution, forms)).collect(),
            None => open.iter().map(|_| (0.0, 0)).collect(),
        };
        let most = (0..open.len()).max_by(|a, b| best[*a].0.total_cmp(&best[*b].0)).unwrap_or(0);
        let forms = open.remove(most);
        let chosen = forms[best[most].1];
        model.terms.push(chosen.term(problem));
        let parts = extend(&mut model, chosen, &forms);
        let is_part = |form: &Regressor| parts.iter().any(|part| std::ptr::eq(*part, form));
        let others = forms.iter().filter(|form| !is_part(form) && is_form_error(form, &parts));
        let others = others.map(|form| relative(form));
        let relatives = model.relatives.iter().cloned().chain(others).collect();
        model.relatives = Arc::new(relatives);
    }
    // In the order of the library, independent of the order of entry.
    let place = |term: &Term| library.effects.iter().position(|effect| effect.info().id == term.id());
    model.terms.sort_by_key(place);
    model
}

/// Adds components to the last entered effect, if it is a sum of components, while they reduce the validation error
/// sufficiently. Returns the components. Components belong to the form of the effect, like its nonlinear parameters.
fn extend<'l, 'p>(
    model: &mut LinearModel<'p>,
    chosen: &'l Regressor<'p>,
    forms: &[&'l Regressor<'p>],
) -> Vec<&'l Regressor<'p>> {
    let mut parts = vec![chosen];
    while let Some(last) = model.terms.last().cloned()
        && let Some((_, longer)) = last.effect.extended(&last.form)
        && let Some(solution) = Solution::of(model)
    {
        let judged = forms.par_iter().filter(|form| !parts.iter().any(|part| std::ptr::eq(*part, **form)));
        let judged = judged.filter_map(|form| {
            let added = visible(&solution.ridge, form)?;
            let gains: Vec<f64> = added.gains(0.0, |_| true).iter().map(|gain| gain.validation_losses).collect();
            let gain: f64 = gains.iter().sum();
            (gain > DECISION_SHARE * solution.ridge.loss() && errors(&gains) > ONE_ERROR).then_some((gain, *form))
        });
        let Some((_, next)) = judged.max_by(|a, b| a.0.total_cmp(&b.0)) else { break };
        let shape = last.shape.iter().chain(&next.shape).copied().collect();
        model.terms.pop();
        model.terms.push(Term::new(last.effect, longer, shape, model.problem));
        parts.push(next);
    }
    parts
}

/// The form that explains most of the residual, and how much it explains. Physically possible forms are preferred.
fn best_form(solution: &Solution, forms: &[&Regressor]) -> (f64, usize) {
    let taken = |form: &&Regressor| {
        let added = visible(&solution.ridge, form)?;
        let possible = allows(form.effect, &form.form, &added.coefficients());
        Some((possible, added.taken()))
    };
    let taken: Vec<Option<(bool, f64)>> = forms.par_iter().map(taken).collect();
    let order = |at: &usize| taken[*at].unwrap_or((false, f64::NEG_INFINITY));
    let best = (0..forms.len()).max_by(|a, b| {
        let (a, b) = (order(a), order(b));
        a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
    });
    best.map_or((0.0, 0), |at| (order(&at).1, at))
}

/// Whether a form belongs to the form error of an effect in these components. The grid of a nonlinear parameter is coarse,
/// so that every other form does. The order of a wave is exact: only its second and third harmonic do, and its
/// neighbouring orders, which are a modulation once a turn.
fn is_form_error(form: &Regressor, parts: &[&Regressor]) -> bool {
    let is_near = |part: &f64, order: &f64| (part - order).abs() <= 1.0 || [2.0, 3.0].contains(&(order / part));
    form.form.shape.iter().zip(&form.shape).all(|(shape, order)| {
        shape.search != ShapeSearch::Whole || parts.iter().flat_map(|part| &part.shape).any(|part| is_near(part, order))
    })
}

/// The form as a nuisance term.
fn relative<'p>(form: &Regressor<'p>) -> Term<'p> {
    let columns = form.columns.iter().map(|c| c.iter().map(|v| f64::from(*v)).collect()).collect();
    Term { effect: form.effect, form: form.form.clone(), shape: form.shape.clone(), columns, fixed: Vec::new() }
}
