//! A model on a prepared run in two stages: steady-state effects on the means, ramp and hysteresis effects on the
//! data with changing motion.

use crate::effect::Regime;
use crate::preprocess::{Prepared, Problem};
use crate::regression::candidates::{CandidateSet, CandidateSets};
use crate::regression::canonical_fit::{enter, fit_canonical};
use crate::regression::hysteresis_form::form_of;
use crate::regression::linear_model::{LinearModel, Term, columns, fixed_part};
use crate::report::reasons::Invisible;
use crate::{Effect, ModelError, ModelSpec, Options};

#[derive(Clone)]
pub struct TwoStageModel<'p> {
    pub prepared: &'p Prepared,
    /// The initial model, and the effects that it may contain.
    pub spec: &'p ModelSpec,
    /// Ids in the order of the model.
    pub effects: Vec<String>,
    pub main: LinearModel<'p>,
    pub moving: Option<LinearModel<'p>>,
    /// Torque of the ramp effects at the rows of the main part, as an offset: a slow step over gear teeth accelerates
    /// as well.
    ramp_offset: Vec<f64>,
    /// Effects of the model that this data cannot show.
    pub hidden: Vec<Invisible>,
}

impl<'p> TwoStageModel<'p> {
    /// Finds forms and nonlinear parameters of every effect. The fit is canonical: it does not depend on whether an
    /// effect was requested or found.
    pub fn new(prepared: &'p Prepared, spec: &'p ModelSpec, options: &Options) -> Result<Self, ModelError> {
        Self::of_effects(prepared, spec, spec.effects.clone(), options)
    }

    fn of_effects(
        prepared: &'p Prepared,
        spec: &'p ModelSpec,
        effects: Vec<String>,
        options: &Options,
    ) -> Result<Self, ModelError> {
        if spec.kind != prepared.kind {
            return Err(ModelError::WrongKind { run: prepared.kind, model: spec.kind });
        }
        if prepared.main.form_error.is_some() {
            return Self::decided(prepared, spec, effects);
        }
        let mut assembly = Self {
            prepared,
            spec,
            effects,
            main: LinearModel::new(&prepared.main),
            moving: prepared.moving.as_ref().map(LinearModel::new),
            ramp_offset: vec![0.0; prepared.main.rows()],
            hidden: Vec::new(),
        };
        let effects_to_fit = assembly.enter_offsets()?;
        let settled: Vec<&str> = effects_to_fit
            .iter()
            .filter(|effect| !assembly.is_apart(**effect))
            .map(|effect| effect.info().id)
            .collect();
        let library = CandidateSet::for_layout(spec, &prepared.main, prepared.regimes(), &settled);
        // The ramps depend on the steady-state part, and the steady-state part depends a little on the ramp effects.
        for _ in 0..2 {
            assembly.main.terms.clear();
            assembly.main = fit_canonical(&assembly.main, &settled, &library, options);
            assembly.enter_moving();
            if !assembly.refresh_ramp_offset() {
                break;
            }
        }
        Ok(assembly)
    }

    /// The model of a run that is judged sample by sample.
    fn decided(prepared: &'p Prepared, spec: &'p ModelSpec, effects: Vec<String>) -> Result<Self, ModelError> {
        let (unfitted, effects_to_fit) = Self::unfitted(prepared, spec, effects)?;
        let ids: Vec<&str> = effects_to_fit.iter().map(|effect| effect.info().id).collect();
        let library = CandidateSet::only(spec, unfitted.main.problem, prepared.regimes(), &ids);
        Ok(unfitted.fitted(&effects_to_fit, &library))
    }

    /// The same, from candidates that are known.
    pub fn from_candidates(sets: &CandidateSets<'p>, effects: Vec<String>) -> Result<Self, ModelError> {
        let (unfitted, effects_to_fit) = Self::unfitted(sets.prepared, sets.spec, effects)?;
        let library = sets.of(unfitted.main.problem);
        Ok(unfitted.fitted(&effects_to_fit, library))
    }

    fn fitted(mut self, effects: &[&'p dyn Effect], library: &CandidateSet<'p>) -> Self {
        self.main = crate::regression::layout::fit_canonical(&self.main, effects, library);
        self
    }

    /// The offset terms of a model, and the effects that have to be fitted.
    fn unfitted(
        prepared: &'p Prepared,
        spec: &'p ModelSpec,
        effects: Vec<String>,
    ) -> Result<(Self, Vec<&'p dyn Effect>), ModelError> {
        let main = LinearModel::new(prepared.judged(&effects));
        let mut assembly =
            Self { prepared, spec, effects, main, moving: None, ramp_offset: Vec::new(), hidden: Vec::new() };
        let mut effects_to_fit = assembly.enter_offsets()?;
        effects_to_fit.retain(|effect| !effect.traits().changes_direction);
        Ok((assembly, effects_to_fit))
    }

    /// Enters the offset terms and the effects that the run cannot show. Returns the effects that have to be fitted.
    fn enter_offsets(&mut self) -> Result<Vec<&'p dyn Effect>, ModelError> {
        let view = &self.prepared.main.view;
        let mut effects_to_fit = Vec::new();
        for id in &self.effects {
            let effect = self.spec.find(id)?;
            if let Some(user_effect) = self.spec.user_effects.iter().find(|user_effect| user_effect.id() == id) {
                user_effect.check(view)?;
            }
            if let Some(why) = effect.hidden(view) {
                self.hidden.push(Invisible::not_excited(id, why));
            } else if effect.traits().is_offset {
                let given = columns(effect, "linear", &[], self.main.problem);
                add(&mut self.main.given, &given, &[1.0]);
                self.main.offsets.push(effect);
            } else {
                effects_to_fit.push(effect);
            }
        }
        Ok(effects_to_fit)
    }

    /// Whether steady-state means cannot show the effect, so that it is fitted where the motion changes.
    pub fn is_apart(&self, effect: &dyn Effect) -> bool {
        !self.prepared.regimes().contains(&effect.traits().regime)
    }

    /// Prediction of the model at the rows of another problem of the same run.
    pub fn predict(&self, problem: &Problem) -> Vec<f64> {
        let mut sum = vec![0.0; problem.rows()];
        for id in &self.effects {
            let Ok(effect) = self.spec.find(id) else { continue };
            if effect.traits().is_offset && !self.hidden.iter().any(|h| h.effect == *id) {
                add(&mut sum, &columns(effect, "linear", &[], problem), &[1.0]);
            }
        }
        for part in std::iter::once(&self.main).chain(&self.moving) {
            for (term, coefficients) in part.terms.iter().zip(part.linear().coefficients) {
                add_term(&mut sum, term, &coefficients, problem);
            }
        }
        sum
    }

    /// Sets the prediction of the steady-state part as the offset of the moving problem, and removes all other terms
    /// from it.
    fn offset_moving(&mut self) {
        let Some(moving) = &mut self.moving else { return };
        moving.given.fill(0.0);
        moving.terms.clear();
        for id in &self.effects {
            let Ok(effect) = self.spec.find(id) else { continue };
            if effect.traits().is_offset && !self.hidden.iter().any(|h| h.effect == *id) {
                add(&mut moving.given, &columns(effect, "linear", &[], moving.problem), &[1.0]);
            }
        }
        for (term, coefficients) in self.main.terms.iter().zip(self.main.linear().coefficients) {
            add_term(&mut moving.given, term, &coefficients, moving.problem);
        }
    }

    /// Adds the effects that are fitted where the motion changes.
    fn enter_moving(&mut self) {
        let is_in = |id: &str| self.effects.iter().any(|e| e == id) && !self.hidden.iter().any(|h| h.effect == id);
        let apart = self.spec.known().filter(|e| self.is_apart(*e) && is_in(e.info().id));
        let (remembering, ramps): (Vec<&'p dyn Effect>, Vec<_>) =
            apart.partition(|e| e.traits().regime == Regime::Hysteresis);
        if self.moving.is_none() {
            let why = "the run has no ramps or reversals that could show it".to_owned();
            let apart = ramps.iter().chain(&remembering);
            self.hidden.extend(apart.map(|e| Invisible::not_excited(e.info().id, why.clone())));
            return;
        }
        self.offset_moving();
        let Some(moving) = &mut self.moving else { return };
        ramps.into_iter().for_each(|effect| enter(moving, effect));
        moving.refine();
        for effect in remembering {
            let form = self
                .prepared
                .memory
                .as_ref()
                .and_then(|problem| form_of(problem, self.predict(problem), self.spec, effect.info().id));
            let Some(moving) = &mut self.moving else { return };
            match form {
                Some(term) => moving.terms.push(Term::new(effect, term.form, term.shape, moving.problem)),
                None => enter(moving, effect),
            }
            moving.refine();
        }
    }

    /// Adds the torque of the ramp effects to the main part as an offset. Returns whether it is not zero there.
    fn refresh_ramp_offset(&mut self) -> bool {
        let mut ramp_offset = vec![0.0; self.ramp_offset.len()];
        if let Some(moving) = &self.moving {
            let fitted = moving.terms.iter().zip(moving.linear().coefficients);
            for (term, coefficients) in fitted.filter(|(term, _)| term.effect.traits().regime == Regime::Transient) {
                add_term(&mut ramp_offset, term, &coefficients, self.main.problem);
            }
        }
        add(&mut self.main.given, &[std::mem::replace(&mut self.ramp_offset, ramp_offset.clone())], &[-1.0]);
        add(&mut self.main.given, &[ramp_offset], &[1.0]);
        self.ramp_offset.iter().any(|torque| *torque != 0.0)
    }

    /// Refits the model from scratch if ramp effects contribute to the main part. Otherwise the order of entry would
    /// change the last digits.
    pub fn canonical(self, options: &Options) -> Result<Self, ModelError> {
        match self.ramp_offset.iter().any(|torque| *torque != 0.0) {
            true => Self::of_effects(self.prepared, self.spec, self.effects, options),
            false => Ok(self),
        }
    }

    /// The model of other effects whose steady-state part is given.
    pub fn of(&self, main: LinearModel<'p>, effects: Vec<String>) -> Self {
        let mut next = Self { main, effects, ..self.clone() };
        next.enter_moving();
        next.refresh_ramp_offset();
        next
    }
}

/// Adds the contribution of a term at the rows of a problem.
fn add_term(sum: &mut [f64], term: &Term, coefficients: &[f64], problem: &Problem) {
    add(sum, &columns(term.effect, term.form.name, &term.shape, problem), coefficients);
    add(sum, &[fixed_part(term, problem)], &[1.0]);
}

fn add(sum: &mut [f64], columns: &[Vec<f64>], coefficients: &[f64]) {
    for (column, coefficient) in columns.iter().zip(coefficients) {
        sum.iter_mut().zip(column).for_each(|(s, c)| *s += coefficient * c);
    }
}
