//! Every effect that the model does not have, in every form, at every starting point of its shape.

use crate::ModelSpec;
use crate::effect::{Columns, Effect, Form, Regime};
use crate::preprocess::Problem;
use crate::preprocess::filter::ABREAST;
use crate::regression::linear_model::Term;
use crate::report::diagnosis::Invisible;
use jointbench_instrument::Kind;
use rayon::prelude::*;
use std::sync::Arc;

/// An effect in one form at one shape.
pub struct Regressor<'e> {
    pub effect: &'e dyn Effect,
    pub form: Arc<Form<'e>>,
    pub shape: Vec<f64>,
    /// In single precision: they are many, and choose only where to look closer.
    pub columns: Vec<Vec<f32>>,
}

impl<'e> Regressor<'e> {
    pub fn id(&self) -> &'e str {
        self.effect.info().id
    }

    pub fn term(&self, problem: &Problem) -> Term<'e> {
        Term::new(self.effect, self.form.clone(), self.shape.clone(), problem)
    }
}

pub struct CandidateSet<'e> {
    pub kind: Kind,
    /// Every effect of the kind, in the order of the contract.
    pub effects: Vec<&'e dyn Effect>,
    pub candidates: Vec<Regressor<'e>>,
    pub invisible: Vec<Invisible>,
}

impl<'e> CandidateSet<'e> {
    /// All candidates of the stages that this problem can judge.
    pub fn new(spec: &'e ModelSpec, problem: &Problem, regimes: &[Regime]) -> Self {
        Self::of(spec, problem, regimes, |_| true)
    }

    /// Only what it takes to lay these effects out: their own forms, and those of all where one of these may get another
    /// part, which is held against all.
    pub fn for_layout(spec: &'e ModelSpec, problem: &Problem, regimes: &[Regime], effects: &[&str]) -> Self {
        let is_in = |effect: &dyn Effect| effects.contains(&effect.info().id);
        let grows = |effect: &dyn Effect| effect.forms(&problem.view).iter().any(|f| effect.extended(f).is_some());
        let one_grows = spec.known().any(|effect| is_in(effect) && grows(effect));
        Self::of(spec, problem, regimes, |effect| one_grows || is_in(effect))
    }

    /// Only the forms of these effects.
    pub fn only(spec: &'e ModelSpec, problem: &Problem, regimes: &[Regime], effects: &[&str]) -> Self {
        Self::of(spec, problem, regimes, |effect| effects.contains(&effect.info().id))
    }

    fn of(spec: &'e ModelSpec, problem: &Problem, regimes: &[Regime], wanted: impl Fn(&dyn Effect) -> bool) -> Self {
        let mut library =
            Self { kind: spec.kind, effects: spec.known().collect(), candidates: Vec::new(), invisible: Vec::new() };
        for effect in spec.known() {
            if effect.is_offset() || !regimes.contains(&effect.regime()) || !wanted(effect) {
                continue;
            }
            if let Some(why) = effect.hidden(&problem.view) {
                library.invisible.push(Invisible { effect: effect.info().id.into(), why });
                continue;
            }
            for form in effect.forms(&problem.view).into_iter().map(Arc::new) {
                library.candidates.par_extend(form.grid.par_chunks(ABREAST).flat_map_iter(|shapes| {
                    let at_points = shapes.iter().map(|shape| effect.columns(form.name, shape, &problem.view));
                    let at_points: Vec<Columns> = at_points.collect();
                    let each = at_points.first().map_or(1, Vec::len).max(1);
                    let rows = problem.reduce.apply_all(at_points.into_iter().flatten().collect());
                    let candidate = |(shape, columns): (&Vec<f64>, &[Vec<f64>])| Regressor {
                        effect,
                        form: form.clone(),
                        shape: shape.clone(),
                        columns: columns.iter().map(|c| c.iter().map(|v| *v as f32).collect()).collect(),
                    };
                    shapes.iter().zip(rows.chunks(each)).map(candidate).collect::<Vec<_>>()
                }));
            }
        }
        library
    }
}
