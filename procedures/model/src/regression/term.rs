//! One effect of a model with its form, nonlinear parameters and columns at the rows of a problem.

use crate::effect::{Columns, Effect, Form};
use crate::preprocess::Problem;
use std::sync::Arc;

/// One effect of the model in one form.
#[derive(Clone)]
pub struct Term<'e> {
    pub effect: &'e dyn Effect,
    pub form: Arc<Form<'e>>,
    pub shape: Vec<f64>,
    pub columns: Columns,
    /// Sum of the columns whose coefficients are fixed. Empty: none is fixed.
    pub fixed: Vec<f64>,
}

impl<'e> Term<'e> {
    pub fn new(effect: &'e dyn Effect, form: impl Into<Arc<Form<'e>>>, shape: Vec<f64>, problem: &Problem) -> Self {
        let form = form.into();
        let mut term = Self { effect, form, shape, columns: Vec::new(), fixed: Vec::new() };
        term.evaluate(problem);
        term
    }

    /// Computes the columns for the current nonlinear parameters.
    pub(in crate::regression) fn evaluate(&mut self, problem: &Problem) {
        self.columns = columns(self.effect, self.form.name, &self.shape, problem);
        self.fixed = fixed_part(self, problem);
    }

    pub fn id(&self) -> &'e str {
        self.effect.info().id
    }

    /// Nonlinear parameters that are refined continuously.
    pub(in crate::regression) fn free(&self) -> impl Iterator<Item = usize> {
        let free: Vec<usize> = (0..self.shape.len()).filter(|i| self.form.shape[*i].is_smooth()).collect();
        free.into_iter()
    }

    /// Whether a refined nonlinear parameter other than an exponent lies at the bound of the identifiable range.
    pub fn is_at_edge(&self) -> bool {
        let sudden = self.effect.traits().exponent_parameter;
        let mut slots = self.form.shape.iter().zip(&self.shape);
        slots.any(|(shape, value)| shape.is_smooth() && sudden != Some(shape.name) && shape.is_edge(*value))
    }

    /// Whether the coefficients are physically possible.
    pub fn allows(&self, coefficients: &[f64]) -> bool {
        allows(self.effect, &self.form, coefficients)
    }

    /// Number of free parameters, linear and nonlinear.
    pub fn size(&self) -> usize {
        self.columns.len() + self.form.shape.iter().filter(|s| s.min < s.max).count()
    }
}

/// Whether these coefficients of an effect are physically possible.
pub fn allows(effect: &dyn Effect, form: &Form, coefficients: &[f64]) -> bool {
    let info = effect.info();
    form.linear.iter().zip(coefficients).all(|(name, value)| {
        info.parameters.iter().find(|p| p.name == *name).is_none_or(|p| (p.min..=p.max).contains(value))
    })
}

/// Columns of an effect at the rows of a problem.
pub fn columns(effect: &dyn Effect, form: &str, shape: &[f64], problem: &Problem) -> Columns {
    problem.reduce.apply_all(effect.columns(form, shape, &problem.view))
}

/// The fixed part of a term at the rows of a problem; empty without one.
pub fn fixed_part(term: &Term, problem: &Problem) -> Vec<f64> {
    let part = term.effect.fixed_part(term.form.name, &term.shape, &problem.view);
    part.map_or_else(Vec::new, |part| problem.reduce.apply(part))
}
