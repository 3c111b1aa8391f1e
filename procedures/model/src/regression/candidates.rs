//! Candidate regressors: every effect that is not in the model, in every form, at every grid point of its nonlinear
//! parameters.

use crate::ModelSpec;
use crate::effect::{Columns, Effect, Form, Regime};
use crate::preprocess::filter::ABREAST;
use crate::preprocess::{Prepared, Problem};
use crate::regression::linear_model::Term;
use crate::report::reasons::Invisible;
use jointbench_instrument::Kind;
use rayon::prelude::*;
use std::cell::OnceCell;
use std::sync::Arc;

/// An effect in one form at one grid point.
pub struct Regressor<'e> {
    pub effect: &'e dyn Effect,
    pub form: Arc<Form<'e>>,
    pub shape: Vec<f64>,
    /// In single precision to save memory: there are many candidates, and they only select what is computed in full
    /// precision.
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
    /// Every effect of the kind, in the order of the library.
    pub effects: Vec<&'e dyn Effect>,
    pub candidates: Vec<Regressor<'e>>,
    pub invisible: Vec<Invisible>,
}

impl<'e> CandidateSet<'e> {
    /// All candidates of the regimes that this problem can judge.
    pub fn new(spec: &'e ModelSpec, problem: &Problem, regimes: &[Regime]) -> Self {
        Self::of(spec, problem, regimes, |_| true)
    }

    /// Only the candidates that the canonical fit of these effects needs: their own forms. All effects are included
    /// if one of these can get an additional component, because a component competes with every other effect.
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
            if effect.traits().is_offset || !regimes.contains(&effect.traits().regime) || !wanted(effect) {
                continue;
            }
            if let Some(why) = effect.hidden(&problem.view) {
                library.invisible.push(Invisible::not_excited(effect.info().id, why));
                continue;
            }
            for form in effect.forms(&problem.view).into_iter().map(Arc::new) {
                library.candidates.par_extend(form.grid.par_chunks(ABREAST).flat_map_iter(|shapes| {
                    let at_points = shapes.iter().map(|shape| effect.columns(form.name, shape, &problem.view));
                    let at_points: Vec<Columns> = at_points.collect();
                    let each = at_points.first().map_or(0, Vec::len);
                    let rows = problem.reduce.apply_all(at_points.into_iter().flatten().collect());
                    let candidate = |(shape, columns): (&Vec<f64>, &[Vec<f64>])| Regressor {
                        effect,
                        form: form.clone(),
                        shape: shape.clone(),
                        columns: columns.iter().map(|c| c.iter().map(|v| *v as f32).collect()).collect(),
                    };
                    let of_shape = |at: usize| &rows[at * each..(at + 1) * each];
                    let each_shape = shapes.iter().enumerate().map(|(at, shape)| (shape, of_shape(at)));
                    each_shape.map(candidate).collect::<Vec<_>>()
                }));
            }
        }
        library
    }
}

/// Candidate sets of a run that is judged sample by sample: for a friction direction that switches at once, and for one
/// with presliding. Each is computed once, because filtering the columns of all forms takes longer than their
/// regression.
pub struct CandidateSets<'p> {
    pub prepared: &'p Prepared,
    pub spec: &'p ModelSpec,
    plain: OnceCell<CandidateSet<'p>>,
    bristled: OnceCell<CandidateSet<'p>>,
}

impl<'p> CandidateSets<'p> {
    pub fn new(prepared: &'p Prepared, spec: &'p ModelSpec) -> Self {
        Self { prepared, spec, plain: OnceCell::new(), bristled: OnceCell::new() }
    }

    /// The candidate set with the friction direction of this problem.
    pub fn of(&self, problem: &'p Problem) -> &CandidateSet<'p> {
        let is_plain = std::ptr::eq(problem, &self.prepared.main);
        let known = if is_plain { &self.plain } else { &self.bristled };
        known.get_or_init(|| CandidateSet::new(self.spec, problem, self.prepared.regimes()))
    }
}
