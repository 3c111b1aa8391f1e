//! A model on a run that is judged sample by sample: columns of the effects and nuisance columns for their form
//! error.

use crate::effect::Regime;
use crate::effects;
use crate::linear::basis::{Basis, dot};
use crate::linear::blocked_ridge::{BaseColumn, BlockedRidge, fitted};
use crate::preprocess::form_error::{ErrorColumn, FormError, FormErrorKind};
use crate::regression::linear_model::{Linear, LinearModel};
use crate::regression::partial_regression::LEAST_TOLERANCE;
use crate::regression::remainder::Remainder;
use crate::regression::weights::weights;
use crate::stats::jackknife;
use crate::stats::summary::rms;
use crate::thresholds::NOISE_ERRORS;
use jointbench_instrument::Kind;
use rayon::prelude::*;
use std::sync::Arc;

/// Ridge strength before the weights are known.
const FIRST_RIDGE: f64 = 1e-4;
/// How many times the weights are updated.
const REWEIGHTED: usize = 2;

/// Nuisance columns of a model: form error, by its place in the list, and other forms of the effects.
pub struct Nuisance<'a> {
    pub error: Vec<(usize, BaseColumn<'a>)>,
    pub relatives: Vec<Remainder>,
}

impl Nuisance<'_> {
    pub fn columns(&self) -> impl Iterator<Item = BaseColumn<'_>> {
        self.error.iter().map(|(_, column)| *column).chain(self.relatives.iter().map(Remainder::column))
    }
}

/// Nuisance columns of a model: its form error and other forms of its effects. Form error that an effect of the model
/// describes or imitates is omitted, and so is form error for which `leaves_out` returns true.
pub fn nuisance<'a>(
    model: &'a LinearModel,
    form_error: &'a FormError,
    leaves_out: impl Fn(FormErrorKind) -> bool,
) -> Nuisance<'a> {
    let passes_load = model.given.iter().any(|g| *g != 0.0);
    let is_out = |kind: FormErrorKind| match kind {
        FormErrorKind::Jerk => model.has_delay(),
        FormErrorKind::LoadRate => !passes_load,
        FormErrorKind::Bristle | FormErrorKind::BristleRate | FormErrorKind::Snap => false,
    };
    // On one sine the jerk is proportional to the velocity. A column without ridge penalty must not be collinear with
    // the effects.
    let effects = Basis::of(model.terms.iter().flat_map(|term| &term.columns));
    let is_own = |c: &ErrorColumn| {
        let rest = effects.rest(&c.values);
        c.kind.is_penalised() || dot(&rest, &rest) > LEAST_TOLERANCE * dot(&c.values, &c.values)
    };
    let is_nuisance = |c: &ErrorColumn| !is_out(c.kind) && !leaves_out(c.kind) && is_own(c);
    let columns = form_error.columns.iter().enumerate().filter(|(_, c)| is_nuisance(c));
    let error = columns
        .map(|(at, c)| (at, BaseColumn { values: &c.values, scale: c.scale, is_penalised: c.kind.is_penalised() }));
    // Other forms of a friction curve are no evidence of an effect of the acceleration.
    let effects: Vec<Option<&Vec<f64>>> = model
        .terms
        .iter()
        .flat_map(|term| {
            let receives = term.effect.traits().regime == Regime::SteadyState;
            term.columns.iter().map(move |column| receives.then_some(column))
        })
        .collect();
    let wholes: Vec<&Vec<f64>> = model.relatives.iter().flat_map(|relative| &relative.columns).collect();
    let relatives = wholes.into_par_iter().map(|whole| Remainder::of(whole, &effects)).collect();
    Nuisance { error: error.collect(), relatives }
}

/// The columns of the effects of a model.
pub fn effect_columns<'a>(model: &'a LinearModel) -> Vec<BaseColumn<'a>> {
    let column = |values: &'a Vec<f64>| BaseColumn { values, scale: rms(values), is_penalised: false };
    model.terms.iter().flat_map(|term| &term.columns).map(column).collect()
}

/// Coefficients of a model, with the ridge regression that gave them.
pub struct Solution {
    pub ridge: BlockedRidge,
    pub weight: Vec<f64>,
    /// Coefficients of the effects, of the form error by its place, and of other forms.
    pub coefficients: Vec<f64>,
    pub error: Vec<(usize, f64)>,
    pub relatives: Vec<f64>,
    /// Coefficients of the effects in each whole column of another form.
    pub parts: Vec<Vec<f64>>,
    pub residual: Vec<f64>,
    /// Coefficients that are held at their bound of zero, with their standard errors before.
    pub bound: Vec<(usize, f64)>,
}

impl Solution {
    /// `None` for a run that is not judged sample by sample.
    pub fn of(model: &LinearModel) -> Option<Arc<Self>> {
        let form_error = model.problem.form_error.as_deref()?;
        let make = || Self::weighted(model, form_error, weighed(model, form_error), None);
        // The name of a user effect does not identify its formula, nor the values of set parameters, so that such
        // solutions are not cached.
        let mut ids = model.terms.iter().map(|term| term.id()).chain(model.offsets.iter().map(|e| e.info().id));
        match ids.all(is_of_library) && model.terms.iter().all(|term| term.effect.coefficients().is_empty()) {
            true => Some(model.problem.memo.of(name(model), make)),
            false => Some(Arc::new(make())),
        }
    }

    pub fn weighted(model: &LinearModel, form_error: &FormError, weight: Vec<f64>, strength: Option<f64>) -> Self {
        let response = model.response();
        let nuisance = nuisance(model, form_error, |_| false);
        let mut columns = effect_columns(model);
        let size = columns.len();
        columns.extend(nuisance.columns());
        let nothing = vec![0.0; response.len()];
        let mut bound = Vec::new();
        let mut ridge = BlockedRidge::new(&columns, &response, &weight, &model.problem.block, strength);
        while let Some((at, error)) = beyond(model, &ridge) {
            bound.push((at, error));
            columns[at].values = &nothing;
            ridge = BlockedRidge::new(&columns, &response, &weight, &model.problem.block, Some(ridge.strength));
        }
        let all = ridge.coefficients();
        let residual = left(&columns, &all, &response);
        let (coefficients, rest) = all.split_at(size);
        let (error, relatives) = rest.split_at(nuisance.error.len());
        Self {
            coefficients: coefficients.to_vec(),
            error: nuisance.error.iter().map(|(at, _)| *at).zip(error.iter().copied()).collect(),
            relatives: relatives.to_vec(),
            parts: nuisance.relatives.iter().map(|relative| relative.parts.clone()).collect(),
            residual,
            weight,
            ridge,
            bound,
        }
    }

    /// Standard errors of the coefficients of the effects, by a jackknife over blocks. That of a coefficient at its bound
    /// is the one without the bound.
    pub fn standard_errors(&self) -> Vec<f64> {
        let replicates: Vec<Vec<f64>> = self.ridge.replicates().collect();
        let of = |k: usize| match self.bound.iter().find(|(at, _)| *at == k) {
            Some((_, error)) => *error,
            None => jackknife::variance_about_mean(replicates.iter().map(|r| r[k])).sqrt(),
        };
        (0..self.coefficients.len()).map(of).collect()
    }

    /// Coefficients of the effects in the sum of the other forms.
    pub fn attributed(&self) -> Vec<f64> {
        let of = |k: usize| self.parts.iter().zip(&self.relatives).map(|(parts, c)| parts[k] * c).sum();
        (0..self.coefficients.len()).map(of).collect()
    }

    /// Sum of the nuisance terms at the rows.
    pub fn form_error(&self, model: &LinearModel) -> Vec<f64> {
        let mut sum = vec![0.0; model.problem.rows()];
        let mut add =
            |column: &[f64], coefficient: f64| sum.iter_mut().zip(column).for_each(|(s, c)| *s += coefficient * c);
        if let Some(form_error) = model.problem.form_error.as_deref() {
            self.error.iter().for_each(|(at, coefficient)| add(&form_error.columns[*at].values, *coefficient));
        }
        let columns = model.relatives.iter().flat_map(|relative| &relative.columns);
        columns.zip(&self.relatives).for_each(|(column, coefficient)| add(column, *coefficient));
        let effects = model.terms.iter().flat_map(|term| &term.columns);
        effects.zip(self.attributed()).for_each(|(column, part)| add(column, -part));
        sum
    }

    /// The solution as coefficients of the terms, like that of a least-squares model.
    pub fn linear(&self, model: &LinearModel) -> Linear {
        let mut next = self.coefficients.iter().copied();
        let coefficients = model.terms.iter().map(|t| next.by_ref().take(t.columns.len()).collect()).collect();
        let sse = self.residual.iter().map(|e| e * e).sum();
        Linear { coefficients, residual: self.residual.clone(), sse }
    }

    /// Squared error of each block, predicted from the other blocks.
    pub fn validation_losses(&self, model: &LinearModel) -> Vec<f64> {
        let Some(form_error) = model.problem.form_error.as_deref() else { return Vec::new() };
        let response = model.response();
        let nuisance = nuisance(model, form_error, |_| false);
        let mut columns = effect_columns(model);
        columns.extend(nuisance.columns());
        let replicates = self.ridge.replicates().zip(&self.ridge.blocks);
        let loss = |(coefficients, rows): (Vec<f64>, &std::ops::Range<usize>)| {
            let mut left = response[rows.clone()].to_vec();
            for (column, coefficient) in columns.iter().zip(coefficients) {
                left.iter_mut().zip(&column.values[rows.clone()]).for_each(|(e, x)| *e -= coefficient * x);
            }
            left.iter().map(|e| e * e).sum()
        };
        replicates.map(loss).collect()
    }
}

/// The most negative of the coefficients that cannot be negative, if it is negative by chance, with its standard error. A
/// significantly negative coefficient contradicts physics and has to be reported, so it is not held at zero.
fn beyond(model: &LinearModel, ridge: &BlockedRidge) -> Option<(usize, f64)> {
    let names =
        model.terms.iter().flat_map(|term| term.form.linear.iter().map(move |name| term.effect.info().bounds(name).0));
    let coefficients = ridge.coefficients();
    let below: Vec<usize> =
        names.enumerate().filter(|(at, least)| *least == 0.0 && coefficients[*at] < 0.0).map(|(at, _)| at).collect();
    if below.is_empty() {
        return None;
    }
    let replicates: Vec<Vec<f64>> = ridge.replicates().collect();
    let groups = replicates.len() as f64;
    let with_error = |at: usize| {
        let square: f64 = replicates.iter().map(|r| (r[at] - coefficients[at]).powi(2)).sum();
        (at, ((groups - 1.0) / groups * square).sqrt().max(f64::MIN_POSITIVE))
    };
    let errors = |(at, error): &(usize, f64)| coefficients[*at] / error;
    let chance = below.into_iter().map(with_error).filter(|one| errors(one) > -NOISE_ERRORS);
    chance.min_by(|a, b| errors(a).total_cmp(&errors(b)))
}

/// Weights of the rows, from the residual of the model.
pub fn weighed(model: &LinearModel, form_error: &FormError) -> Vec<f64> {
    let mut weight = vec![1.0; model.problem.rows()];
    let response = model.response();
    let nuisance = nuisance(model, form_error, |_| false);
    let mut columns = effect_columns(model);
    columns.extend(nuisance.columns());
    for _ in 0..REWEIGHTED {
        let coefficients = fitted(&columns, &response, &weight, FIRST_RIDGE);
        weight = weights(form_error, &left(&columns, &coefficients, &response));
    }
    weight
}

fn is_of_library(id: &str) -> bool {
    effects::find(Kind::Friction, id).is_ok()
}

/// The effects, forms and nonlinear parameters of a model, as a key of the cache.
fn name(model: &LinearModel) -> String {
    let mut name = String::new();
    model.offsets.iter().for_each(|effect| name.push_str(effect.info().id));
    for term in &model.terms {
        name.push_str(&format!("+{} {} {:?}", term.id(), term.form.name, term.shape));
    }
    for relative in model.relatives.iter() {
        name.push_str(&format!("~{} {} {:?}", relative.id(), relative.form.name, relative.shape));
    }
    name
}

fn left(columns: &[BaseColumn], coefficients: &[f64], response: &[f64]) -> Vec<f64> {
    let mut left = response.to_vec();
    for (column, coefficient) in columns.iter().zip(coefficients) {
        left.iter_mut().zip(column.values).for_each(|(e, x)| *e -= coefficient * x);
    }
    left
}

/// The first coefficient of an effect.
pub fn effect_coefficient(model: &LinearModel, solution: &Solution, id: &str) -> Option<f64> {
    let (_, places) = model.term(id)?;
    solution.coefficients.get(places.start).copied()
}

/// The ridge regression without one kind of form error.
pub fn without(model: &LinearModel, solution: &Solution, kind: FormErrorKind) -> BlockedRidge {
    let form_error = model.problem.form_error.as_deref();
    let nuisance = form_error.map(|form_error| nuisance(model, form_error, |other| other == kind));
    let mut columns = effect_columns(model);
    columns.extend(nuisance.iter().flat_map(Nuisance::columns));
    // The weights are smallest at the rows that show such an effect.
    let even = vec![1.0; model.problem.rows()];
    BlockedRidge::new(&columns, &model.response(), &even, &model.problem.block, Some(solution.ridge.strength))
}

/// The ridge regression of a model with the weights and the ridge strength of another solution.
pub fn weighted_like(model: &LinearModel, solution: &Solution) -> BlockedRidge {
    let nuisance = model.problem.form_error.as_deref().map(|form_error| nuisance(model, form_error, |_| false));
    let mut columns = effect_columns(model);
    columns.extend(nuisance.iter().flat_map(Nuisance::columns));
    let strength = Some(solution.ridge.strength);
    BlockedRidge::new(&columns, &model.response(), &solution.weight, &model.problem.block, strength)
}
