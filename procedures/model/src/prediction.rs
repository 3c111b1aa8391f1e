//! Prediction of a fit on a run that is preprocessed like the fitted one.

use crate::effects::changes_direction;
use crate::preprocess::{Prepared, Problem, prepare_with};
use crate::regression::linear_model::columns;
use crate::report::fit::{Fit, Term};
use crate::user_effects::find_with_user_effects;
use crate::view::View;
use crate::{ModelError, Options};
use jointbench_instrument::RunTable;

pub(crate) fn prepare_alike(fit: &Fit, run: &RunTable) -> Result<Prepared, ModelError> {
    if run.kind() != fit.kind {
        return Err(ModelError::WrongKind { run: run.kind(), model: fit.kind });
    }
    let about = &fit.preparation;
    let options = Options {
        residual: Some(about.residual),
        cutoff_hz: about.cutoff_hz,
        decimation: Some(about.decimation),
        chunk_s: about.chunk_s,
        ..Options::default()
    };
    prepare_with(run, &options, about.bristles.as_ref())
}

/// Prediction of a fit at the rows of a problem: its effects and its nuisance terms.
pub(crate) fn predict(fit: &Fit, problem: &Problem) -> Result<Vec<f64>, ModelError> {
    let (effects, nuisance) = (predict_effects(fit, problem)?, predict_nuisance(fit, problem)?);
    Ok(effects.iter().zip(&nuisance).map(|(effects, nuisance)| effects + nuisance).collect())
}

/// Prediction of the effects of a fit at the rows of a problem.
pub(crate) fn predict_effects(fit: &Fit, problem: &Problem) -> Result<Vec<f64>, ModelError> {
    // The direction signal of sampled runs already contains presliding.
    let is_column = |term: &&Term| problem.form_error.is_none() || !changes_direction(&term.effect);
    let sampled = Fit { terms: fit.terms.iter().filter(is_column).cloned().collect(), ..fit.clone() };
    predict_on(&sampled, &problem.view, problem.rows(), |column| problem.reduce.apply(column))
}

/// Prediction of the nuisance terms of a fit at the rows of a problem.
pub(crate) fn predict_nuisance(fit: &Fit, problem: &Problem) -> Result<Vec<f64>, ModelError> {
    let mut predicted = vec![0.0; problem.rows()];
    let Some(form_error) = problem.form_error.as_deref() else { return Ok(predicted) };
    let mut add =
        |column: &[f64], coefficient: f64| predicted.iter_mut().zip(column).for_each(|(p, c)| *p += coefficient * c);
    for term in &fit.form_error {
        match find_with_user_effects(fit.kind, &fit.user_effects, &term.name) {
            Ok(effect) => {
                let columns = columns(effect, &term.form, &term.shape, problem);
                columns.iter().zip(&term.linear).for_each(|(column, coefficient)| add(column, *coefficient));
            }
            Err(_) => {
                let place = term.shape.first().map_or(0, |place| *place as usize);
                let mut columns_of_kind = form_error.columns.iter().filter(|column| column.kind.name() == term.name);
                let column = columns_of_kind.nth(place).zip(term.linear.first());
                column.into_iter().for_each(|(column, coefficient)| add(&column.values, *coefficient));
            }
        }
    }
    Ok(predicted)
}

/// Prediction at the points of a view, each column reduced to rows.
pub(crate) fn predict_on(
    fit: &Fit,
    view: &View,
    rows: usize,
    reduce: impl Fn(Vec<f64>) -> Vec<f64>,
) -> Result<Vec<f64>, ModelError> {
    let mut predicted = vec![0.0; rows];
    let mut add = |columns: Vec<Vec<f64>>, coefficients: &[f64]| {
        for (column, coefficient) in columns.into_iter().zip(coefficients) {
            predicted.iter_mut().zip(reduce(column)).for_each(|(p, c)| *p += coefficient * c);
        }
    };
    for id in &fit.effects {
        let effect = find_with_user_effects(fit.kind, &fit.user_effects, id)?;
        if effect.traits().is_offset && effect.missing(view).is_none() {
            add(effect.columns("linear", &[], view), &[1.0]);
        }
    }
    for term in &fit.terms {
        let effect = find_with_user_effects(fit.kind, &fit.user_effects, &term.effect)?;
        if let Some(column) = effect.missing(view) {
            let why = format!("there is no column {column}");
            return Err(ModelError::NotVisible { effect: term.effect.clone(), why });
        }
        let found = effect.columns(&term.form, &term.shape, view);
        if found.len() != term.linear.len() {
            return Err(ModelError::UnknownForm { effect: term.effect.clone(), form: term.form.clone() });
        }
        add(found, &term.linear);
    }
    Ok(predicted)
}
