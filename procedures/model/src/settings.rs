//! A fit with fixed values, bounds and start values of parameters.
//!
//! Nonlinear parameters are searched in a smaller range. A fixed coefficient has no column. Bounds of coefficients are
//! an active set (Nocedal, Wright 2006, ch. 16.5): a coefficient beyond its bound is fixed there, and freed if it
//! returns to its range.

use crate::effect::ShapeSearch;
use crate::effects::changes_direction;
use crate::inference::intervals::intervals;
use crate::preprocess::Prepared;
use crate::regression::linear_model::Term;
use crate::regression::two_stage_model::TwoStageModel;
use crate::report::fit::{Fit, Parameter, ParameterState};
use crate::report::setting::ParameterSetting;
use crate::set_effect::{Pinned, SetEffect};
use crate::words::figure;
use crate::{ModelError, ModelSpec, Options};
use jointbench_instrument::Motion;

/// The settings of a model in the form that a fit can follow.
pub struct Applied {
    /// The model with the ranges and the fixed coefficients.
    pub spec: ModelSpec,
    /// Coefficients at a bound, with the intervals that they have without it.
    at_bound: Vec<Parameter>,
}

/// A fitted term.
struct Found {
    effect: String,
    form: String,
    shape: Vec<f64>,
    coefficients: Vec<(String, f64)>,
}

/// A coefficient that is fixed, by a user or at a bound.
#[derive(Clone)]
struct Held<'s> {
    setting: &'s ParameterSetting,
    value: f64,
}

/// Applies the settings of `spec`.
pub fn apply(prepared: &Prepared, spec: &ModelSpec, options: &Options) -> Result<Applied, ModelError> {
    let mut ranged = spec.clone();
    let mut linear: Vec<&ParameterSetting> = Vec::new();
    for id in &spec.effects {
        let of_effect: Vec<&ParameterSetting> = spec.settings.iter().filter(|one| one.effect == *id).collect();
        if of_effect.is_empty() || is_hidden(prepared, spec, id, &of_effect)? {
            continue;
        }
        let mut nonlinear = Vec::new();
        for setting in of_effect {
            match is_nonlinear(prepared, spec, setting)? {
                true => nonlinear.push(setting.clone()),
                false => linear.push(setting),
            }
        }
        ranged.set.push(SetEffect::new(spec.kind, &spec.user_effects, id, nonlinear)?);
    }
    let first = TwoStageModel::new(prepared, &ranged, options)?;
    let free = found(&first);
    for setting in &spec.settings {
        check_found(&first, &free, setting)?;
    }
    linear.retain(|setting| free.iter().any(|term| term.effect == setting.effect));
    let refit = |held: &[Held]| -> Result<Vec<Found>, ModelError> {
        match held.is_empty() {
            true => Ok(found(&first)),
            false => Ok(found(&TwoStageModel::new(prepared, &pinned(&ranged, &free, held), options)?)),
        }
    };
    let held = active_set(&linear, refit)?;
    let is_bound = |p: &Parameter| held.iter().any(|one| one.setting.fixed.is_none() && is_of(one.setting, p));
    let estimates = std::iter::once(&first.main).chain(&first.moving);
    let at_bound = match held.iter().any(|one| one.setting.fixed.is_none()) {
        true => estimates.flat_map(|part| intervals(part, prepared.motion).parameters).filter(is_bound).collect(),
        false => Vec::new(),
    };
    let spec = if held.is_empty() { ranged.clone() } else { pinned(&ranged, &free, &held) };
    Ok(Applied { spec, at_bound })
}

/// Whether the run cannot show an effect with settings. A fixed value of such an effect is an error.
fn is_hidden(
    prepared: &Prepared,
    spec: &ModelSpec,
    id: &str,
    settings: &[&ParameterSetting],
) -> Result<bool, ModelError> {
    if changes_direction(id) && prepared.main.form_error.is_some() {
        return Err(refused(
            settings[0],
            "the preprocessing of this run finds presliding; remove the setting, or the effect from the model",
        ));
    }
    match spec.find(id)?.hidden(&prepared.main.view) {
        Some(why) if settings.iter().any(|setting| setting.fixed.is_some()) => {
            Err(ModelError::NotVisible { effect: id.to_owned(), why })
        }
        hidden => Ok(hidden.is_some()),
    }
}

/// Whether the parameter is nonlinear in the forms of its effect. Refuses start values that have no influence.
fn is_nonlinear(prepared: &Prepared, spec: &ModelSpec, setting: &ParameterSetting) -> Result<bool, ModelError> {
    let forms = spec.find(&setting.effect)?.forms(&prepared.main.view);
    let nonlinear = forms.iter().flat_map(|form| &form.shape).find(|shape| shape.name == setting.name);
    match nonlinear {
        Some(shape) if shape.search == ShapeSearch::Whole && setting.start.is_some() => Err(refused(
            setting,
            "it is an integer, which is searched over its whole range; a start value has no influence: fix it, or give bounds",
        )),
        Some(_) => Ok(true),
        None if !forms.iter().any(|form| form.linear.contains(&setting.name.as_str())) => {
            Err(refused(setting, "no form of the effect that this run can show has this parameter; remove the setting"))
        }
        None if setting.start.is_some() => Err(refused(
            setting,
            "it is linear, so that least squares finds it without a search; a start value has no influence: remove it",
        )),
        None => Ok(false),
    }
}

/// Refuses settings of a parameter that the fitted form does not have.
fn check_found(model: &TwoStageModel, terms: &[Found], setting: &ParameterSetting) -> Result<(), ModelError> {
    if let Some(hidden) = model.hidden.iter().find(|hidden| hidden.effect == setting.effect) {
        return match setting.fixed {
            Some(_) => Err(ModelError::NotVisible { effect: setting.effect.clone(), why: hidden.why.clone() }),
            None => Ok(()),
        };
    }
    let term = terms.iter().find(|term| term.effect == setting.effect);
    let names = std::iter::once(&model.main).chain(&model.moving).flat_map(|part| &part.terms);
    let is_shape = |term: &Term| term.form.shape.iter().any(|shape| shape.name == setting.name);
    let is_nonlinear = names.filter(|term| term.id() == setting.effect).any(is_shape);
    let is_linear = term.is_some_and(|term| term.coefficients.iter().any(|(name, _)| *name == setting.name));
    match is_nonlinear || is_linear {
        true => Ok(()),
        false if term.is_none() => Err(refused(setting, "no form of the effect has such values; change the setting")),
        false => Err(refused(setting, "the form that fits this run best does not have it; remove the setting")),
    }
}

fn refused(setting: &ParameterSetting, why: &str) -> ModelError {
    ModelError::BadSetting { effect: setting.effect.clone(), name: setting.name.clone(), why: why.into() }
}

fn is_of(setting: &ParameterSetting, parameter: &Parameter) -> bool {
    setting.effect == parameter.effect && setting.name == parameter.name
}

/// The terms of a fitted model, with all coefficients.
fn found(model: &TwoStageModel) -> Vec<Found> {
    let mut all = Vec::new();
    for part in std::iter::once(&model.main).chain(&model.moving) {
        for (term, coefficients) in part.terms.iter().zip(part.linear().coefficients) {
            all.push(Found {
                effect: term.id().into(),
                form: term.form.name.into(),
                shape: term.shape.clone(),
                coefficients: named(term, coefficients),
            });
        }
    }
    all
}

/// All coefficients of a term: the fitted ones and the fixed ones.
fn named(term: &Term, coefficients: Vec<f64>) -> Vec<(String, f64)> {
    let mut fitted = coefficients.into_iter();
    match term.effect.coefficients() {
        [] => term.form.linear.iter().map(|name| (*name).to_owned()).zip(fitted).collect(),
        all => {
            let value = |fixed: &Option<f64>| fixed.or_else(|| fitted.next()).unwrap_or(0.0);
            let mut value = value;
            all.iter().map(|(name, fixed)| (name.clone(), value(fixed))).collect()
        }
    }
}

/// All coefficients of a term, and the parameters of the fixed ones.
pub fn whole(term: &Term, coefficients: Vec<f64>, motion: Motion) -> (Vec<(String, f64)>, Vec<Parameter>) {
    let fixed = term.effect.coefficients().iter().filter_map(|(name, fixed)| {
        let value = (*fixed)?;
        Some(Parameter {
            effect: term.id().into(),
            name: name.clone(),
            value,
            unit: motion.label(term.effect.info().unit(name)),
            ci95: [value, value],
            state: ParameterState::Fixed,
            note: None,
        })
    });
    let fixed = fixed.collect();
    (named(term, coefficients), fixed)
}

/// The model with fixed coefficients. Their effects keep the form and the nonlinear parameters of the free fit as start
/// values.
fn pinned(spec: &ModelSpec, free: &[Found], held: &[Held]) -> ModelSpec {
    let mut pinned = spec.clone();
    for set in &mut pinned.set {
        let id = crate::effect::Effect::info(set).id.to_owned();
        let of_effect: Vec<&Held> = held.iter().filter(|one| one.setting.effect == id).collect();
        let Some(term) = free.iter().find(|term| term.effect == id).filter(|_| !of_effect.is_empty()) else { continue };
        let fixed = |name: &str| of_effect.iter().find(|one| one.setting.name == name).map(|one| one.value);
        let coefficients = term.coefficients.iter().map(|(name, _)| (name.clone(), fixed(name))).collect();
        *set = set.pinned(Pinned { form: term.form.clone(), start: term.shape.clone(), coefficients });
    }
    pinned
}

/// The coefficients that are fixed at the optimum within all bounds.
fn active_set<'s>(
    settings: &[&'s ParameterSetting],
    refit: impl Fn(&[Held]) -> Result<Vec<Found>, ModelError>,
) -> Result<Vec<Held<'s>>, ModelError> {
    let fixed = settings.iter().filter_map(|setting| setting.fixed.map(|value| Held { setting, value }));
    let mut held: Vec<Held<'s>> = fixed.collect();
    // Each round fixes or frees one coefficient.
    for _ in 0..3 * settings.len() {
        let terms = refit(&held)?;
        let is_held = |setting: &ParameterSetting| held.iter().any(|one| std::ptr::eq(one.setting, setting));
        let beyond = settings.iter().filter(|setting| !is_held(setting)).filter_map(|setting| {
            let value = value_of(&terms, setting)?;
            let bound = setting.nearest(value);
            let excess = (value - bound).abs() / (value.abs() + bound.abs()).max(f64::MIN_POSITIVE);
            (value != bound).then_some((excess, Held { setting, value: bound }))
        });
        if let Some((_, worst)) = beyond.max_by(|a, b| a.0.total_cmp(&b.0)) {
            held.push(worst);
            continue;
        }
        let Some(fewer) = released(&held, &refit)? else { break };
        held = fewer;
    }
    Ok(held)
}

/// Without a bound that no longer holds its coefficient. A single bound always does.
fn released<'s>(
    held: &[Held<'s>],
    refit: impl Fn(&[Held]) -> Result<Vec<Found>, ModelError>,
) -> Result<Option<Vec<Held<'s>>>, ModelError> {
    let at_bound: Vec<usize> = (0..held.len()).filter(|at| held[*at].setting.fixed.is_none()).collect();
    for at in at_bound.iter().filter(|_| at_bound.len() > 1) {
        let mut fewer = held.to_vec();
        let one = fewer.remove(*at);
        if value_of(&refit(&fewer)?, one.setting).is_some_and(|value| one.setting.nearest(value) == value) {
            return Ok(Some(fewer));
        }
    }
    Ok(None)
}

fn value_of(terms: &[Found], setting: &ParameterSetting) -> Option<f64> {
    let term = terms.iter().find(|term| term.effect == setting.effect)?;
    term.coefficients.iter().find(|(name, _)| *name == setting.name).map(|(_, value)| *value)
}

impl Applied {
    /// Marks the set parameters of a fit: fixed, or at a bound. No interval crosses a bound.
    pub fn mark(&self, fit: &mut Fit) {
        for p in &mut fit.parameters {
            let Some(setting) = self.spec.settings.iter().find(|setting| is_of(setting, p)) else { continue };
            if !fit.terms.iter().any(|term| term.effect == p.effect) {
                continue;
            }
            if setting.fixed.is_some() {
                (p.ci95, p.state, p.note) = ([p.value, p.value], ParameterState::Fixed, None);
                continue;
            }
            if let Some(free) = self.at_bound.iter().find(|free| is_of(setting, free)) {
                p.ci95 = free.ci95;
            }
            p.ci95 = p.ci95.map(|end| setting.nearest(end));
            let is_at = |bound: Option<f64>| bound.is_some_and(|bound| (p.value - bound).abs() <= 1e-3 * bound.abs());
            if is_at(setting.min) || is_at(setting.max) {
                p.state = ParameterState::AtBound;
                p.note = Some(format!("at its bound of {}, which was set", figure(p.value, &p.unit)));
            }
        }
        let place = |p: &Parameter| {
            let term = fit.terms.iter().find(|term| term.effect == p.effect);
            term.and_then(|term| term.names.iter().position(|name| *name == p.name))
        };
        // Parameters of one effect are neighbours; a fixed one returns to its place in the effect.
        fit.parameters.chunk_by_mut(|a, b| a.effect == b.effect).for_each(|chunk| chunk.sort_by_key(place));
    }
}
