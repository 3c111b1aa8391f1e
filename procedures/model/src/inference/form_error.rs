//! Results of a fit that is judged sample by sample: presliding, and the nuisance terms of the form error.

use crate::effect::{Effect, Form};
use crate::effects::friction::coulomb;
use crate::effects::{self, changes_direction};
use crate::inference::parameter_state;
use crate::regression::linear_model::LinearModel;
use crate::regression::solution::Solution;
use crate::regression::two_stage_model::TwoStageModel;
use crate::report::fit::{FormErrorTerm, Parameter, ParameterState, Term};
use crate::stats::summary::rms;
use crate::words::{figure, percent};
use jointbench_instrument::Kind;

/// Presliding as one form of the library, applied to the dry friction. It is no additive term: it replaces the
/// direction signal of all friction terms.
pub fn presliding(model: &TwoStageModel, parameters: &[Parameter]) -> Option<(Term, Vec<Parameter>)> {
    let id = model.effects.iter().find(|id| changes_direction(id))?;
    let is_hidden = model.hidden.iter().any(|hidden| hidden.effect == *id);
    let bristles = model.prepared.about.bristles.as_ref().filter(|_| !is_hidden)?;
    let (form, reach, ends) = bristles.single()?;
    let dry = parameters.iter().find(|p| p.effect == coulomb::ID);
    let (value, ci95) = dry.map_or((0.0, [0.0, 0.0]), |dry| (dry.value, dry.ci95));
    let info = effects::find(Kind::Friction, id).ok()?.info();
    let unit = |name| model.prepared.motion.label(info.unit(name));
    let parameter = |name: &'static str, value, ci95, (state, note)| Parameter {
        effect: id.clone(),
        name: name.into(),
        value,
        unit: unit(name),
        ci95,
        state,
        note,
    };
    let state = if dry.is_some() { ParameterState::Ok } else { ParameterState::Unidentified };
    let searched = [*bristles.reaches_rad.first()?, *bristles.reaches_rad.last()?];
    let of_reach = match searched.contains(&reach) {
        true => parameter_state::at_end(searched, &unit("theta_p")),
        false => (ParameterState::Ok, None),
    };
    let term = Term {
        effect: id.clone(),
        form: form.into(),
        shape: vec![reach],
        linear: vec![value],
        names: vec!["tau_p".into(), "theta_p".into()],
    };
    let all = vec![parameter("tau_p", value, ci95, (state, None)), parameter("theta_p", reach, ends, of_reach)];
    Some((term, all))
}

/// Nuisance terms of a model, and what they explain.
pub struct Nuisance {
    pub terms: Vec<FormErrorTerm>,
    /// RMS error of the effects alone.
    pub effects_rms: f64,
    /// Both sizes, in a sentence.
    pub note: String,
}

fn form_error_term(effect: &dyn Effect, form: &Form, shape: &[f64], linear: Vec<f64>) -> FormErrorTerm {
    FormErrorTerm { name: effect.info().id.into(), form: form.name.into(), shape: shape.to_vec(), linear }
}

/// `None` of a model that is fitted without nuisance terms.
pub fn nuisance(model: &LinearModel, unit: &str) -> Option<Nuisance> {
    let (solution, form_error) = (Solution::of(model)?, model.problem.form_error.as_deref()?);
    let mut terms = Vec::new();
    for (at, coefficient) in &solution.error {
        let column = &form_error.columns[*at];
        let place = form_error.columns[..*at].iter().filter(|other| other.kind == column.kind).count();
        terms.push(FormErrorTerm {
            name: column.kind.name().into(),
            form: String::new(),
            shape: vec![place as f64],
            linear: vec![*coefficient],
        });
    }
    let mut coefficients = solution.relatives.iter();
    for relative in model.relatives.iter() {
        let linear: Vec<f64> = coefficients.by_ref().take(relative.columns.len()).copied().collect();
        terms.push(form_error_term(relative.effect, &relative.form, &relative.shape, linear));
    }
    // What the other forms have in common with the effects counts as size of these.
    let mut parts = solution.attributed().into_iter();
    for term in &model.terms {
        let linear: Vec<f64> = parts.by_ref().take(term.columns.len()).map(|part| -part).collect();
        if linear.iter().any(|part| *part != 0.0) {
            terms.push(form_error_term(term.effect, &term.form, &term.shape, linear));
        }
    }
    let sum = solution.form_error(model);
    let (size, whole) = (rms(&sum), rms(&model.problem.target));
    let alone: Vec<f64> = solution.residual.iter().zip(&sum).map(|(residual, nuisance)| residual + nuisance).collect();
    let effects_rms = rms(&alone);
    let worse = if effects_rms > whole { ", more than without a model" } else { "" };
    let note = format!(
        "nuisance terms (transients and other forms of the effects) have {} RMS, {} of that of the torque; an exported model \
         has the effects only, and its error on this run is {} RMS{worse}",
        figure(size, unit),
        percent(size / whole.max(f64::MIN_POSITIVE)),
        figure(effects_rms, unit)
    );
    Some(Nuisance { terms, effects_rms, note })
}
