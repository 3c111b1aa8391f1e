//! Fits a model to a run, and evaluates a fit on another run.

use crate::effects::friction::{coulomb, direction_offset, inertia};
use crate::inference::confounding;
use crate::inference::form_error::{Nuisance, nuisance, presliding};
use crate::inference::intervals::intervals;
use crate::linear::basis::dot;
use crate::linear::condition;
use crate::prediction::{predict_effects, predict_nuisance, prepare_alike};
use crate::preprocess::{Prepared, prepare};
use crate::regression::cross_validation::validation_rms;
use crate::regression::linear_model::{LinearModel, Term};
use crate::regression::two_stage_model::TwoStageModel;
use crate::report::fit::{Evaluation, Fit, Parameter, ParameterState, Scope, Term as TermReport, TradeOff};
use crate::words::figure;
use crate::{ModelError, ModelSpec, Options, ResidualKind, UserEffect, export, settings};
use jointbench_instrument::RunTable;

/// Fits the effects of a model to a run.
///
/// Coefficients by least squares on scaled columns, nonlinear parameters by variable projection (Golub, Pereyra 2003),
/// 95 % intervals by a jackknife over blocks (MacKinnon, Nielsen, Webb 2023). Effects that the run cannot show stay in
/// the model with zero coefficients, and the notes name them.
///
/// # Errors
/// [`ModelError::Collinear`] if two effects are proportional in this data, [`ModelError::NotVisible`] if the columns of
/// an effect are zero, [`ModelError::WrongKind`] for a run of another kind, and the errors of preprocessing.
///
/// ```
/// use jointbench_instrument::{Channel, Kind, Meta, RunTable, Trace};
/// use jointbench_model::{ModelSpec, Options, ParameterState, fit};
///
/// // A joint that swings for 12 s: 30 mNm Coulomb friction, 2 mNm·s/rad viscous friction, and a little noise.
/// let mut trace = Trace::new(["time_s", "motor_position_rad", "motor_current_a"].map(Channel::new).to_vec());
/// for i in 0..3000 {
///     let t = 0.004 * f64::from(i);
///     let (position, velocity) = (5.0 * (2.0 * t).sin(), 10.0 * (2.0 * t).cos());
///     let noise = 1e-3 * (f64::from(i * i % 1009) / 1009.0 - 0.5);
///     let torque = 0.03 * velocity.signum() + 0.002 * velocity + noise;
///     trace.push_row(&[t, position, torque / 0.08]);
/// }
/// let kind = Some(Kind::Friction);
/// let run = RunTable::new(Meta { kind, torque_constant_nm_per_a: Some(0.08), ..Meta::default() }, trace).unwrap();
///
/// let model = ModelSpec::parse(Kind::Friction, "coulomb, viscous").unwrap();
/// let fit = fit(&run, &model, &Options::default()).unwrap();
/// let coulomb = fit.parameters.iter().find(|p| p.name == "tau_c").unwrap();
/// assert!((coulomb.value - 0.03).abs() < 1e-3 && coulomb.state == ParameterState::Ok);
/// assert!(fit.rms < 1e-3 && fit.unit == "Nm");
/// ```
pub fn fit(run: &RunTable, spec: &ModelSpec, options: &Options) -> Result<Fit, ModelError> {
    fit_prepared(&prepare(run, options)?, spec, options)
}

/// As [`fit`], for a run that is preprocessed once for several models: for a long run this is most of the
/// computation.
pub fn fit_prepared(prepared: &Prepared, spec: &ModelSpec, options: &Options) -> Result<Fit, ModelError> {
    if spec.settings.is_empty() {
        return report(&TwoStageModel::new(prepared, spec, options)?);
    }
    let applied = settings::apply(prepared, spec, options)?;
    let mut fit = report(&TwoStageModel::new(prepared, &applied.spec, options)?)?;
    applied.mark(&mut fit);
    Ok(fit)
}

/// The report of a fitted model.
pub(crate) fn report(assembly: &TwoStageModel) -> Result<Fit, ModelError> {
    let prepared = assembly.prepared;
    let main = &assembly.main;
    let linear = main.linear();
    let n = linear.residual.len() as f64;
    let condition = check_columns(main)?;
    if let Some(moving) = &assembly.moving {
        check_columns(moving)?;
    }
    let (mut terms, mut parameters, trade_offs) = fitted_terms(assembly);
    if let Some((term, found)) = presliding(assembly, &parameters) {
        terms.push(term);
        parameters.extend(found);
    }
    let is_set = |effect: &str| assembly.spec.settings.iter().any(|setting| setting.effect == effect);
    let undetermined = match is_set(inertia::ID) {
        true => None,
        false => stated_inertia(&mut terms, &mut parameters, prepared),
    };
    let nuisance = nuisance(main, &prepared.unit());
    parameters.extend(assembly.hidden.iter().flat_map(|h| unseen(assembly, &h.effect, &h.why)));
    let order = |effect: &str| assembly.effects.iter().position(|e| e == effect);
    parameters.sort_by_key(|p| order(&p.effect));
    terms.sort_by_key(|t| order(&t.effect));

    let target = &prepared.main.target;
    let notes = notes(assembly, nuisance.as_ref(), undetermined);
    let user_effects: Vec<UserEffect> =
        assembly.spec.user_effects.iter().filter(|o| assembly.effects.iter().any(|e| e == o.id())).cloned().collect();
    let scope = Scope::of(prepared, &user_effects);
    let mut fit = Fit {
        kind: prepared.kind,
        effects: assembly.effects.clone(),
        user_effects,
        settings: assembly.spec.settings.clone(),
        rms: (linear.sse / n).sqrt(),
        validation_rms: validation_rms(main),
        effects_rms: nuisance.as_ref().map(|nuisance| nuisance.effects_rms),
        unit: prepared.unit(),
        residual: prepared.about.residual,
        relative_error: (linear.sse / dot(target, target)).sqrt(),
        parameters,
        trade_offs,
        condition,
        notes,
        preparation: prepared.about.clone(),
        terms,
        form_error: nuisance.map(|nuisance| nuisance.terms).unwrap_or_default(),
        scope: Some(scope),
    };
    export::measure(&mut fit, &prepared.main)?;
    Ok(fit)
}

/// The terms of both stages, with their parameters and the trade-offs between these.
fn fitted_terms(assembly: &TwoStageModel) -> (Vec<TermReport>, Vec<Parameter>, Vec<TradeOff>) {
    let (mut terms, mut parameters, mut trade_offs) = (Vec::new(), Vec::new(), Vec::new());
    for part in std::iter::once(&assembly.main).chain(&assembly.moving) {
        let found = intervals(part, assembly.prepared.motion);
        parameters.extend(found.parameters);
        trade_offs.extend(found.trade_offs);
        for (term, coefficients) in part.terms.iter().zip(part.linear().coefficients) {
            let (linear, fixed) = settings::whole(term, coefficients, assembly.prepared.motion);
            parameters.extend(fixed);
            let names = linear.iter().map(|(name, _)| name.as_str()).chain(term.form.shape.iter().map(|s| s.name));
            terms.push(TermReport {
                effect: term.id().into(),
                form: term.form.name.into(),
                shape: term.shape.clone(),
                names: names.map(String::from).collect(),
                linear: linear.into_iter().map(|(_, value)| value).collect(),
            });
        }
    }
    (terms, parameters, trade_offs)
}

/// Notes on a fit for its reader, in sentences.
fn notes(assembly: &TwoStageModel, nuisance: Option<&Nuisance>, undetermined: Option<String>) -> Vec<String> {
    let (prepared, main) = (assembly.prepared, &assembly.main);
    let mut notes: Vec<String> = prepared.data_errors.all().chain(&prepared.warnings).cloned().collect();
    notes.extend(nuisance.map(|nuisance| nuisance.note.clone()));
    notes.extend(assembly.hidden.iter().map(|h| format!("{} is not testable with this run: {}", h.effect, h.why)));
    if assembly.effects.iter().any(|e| e == direction_offset::ID) {
        notes.push("on a moving joint a direction offset is the same as a constant torque offset".into());
    }
    if prepared.main.view.is_one_directional() && main.contains(coulomb::ID) {
        let note = "the motion has one direction only (less than a tenth of a trajectory in the other is omitted): Coulomb \
                    friction and an offset are confounded, and tau_c contains both; measure the other direction as well";
        notes.push(note.into());
    }
    notes.extend(undetermined);
    notes.extend(main.terms.iter().filter_map(written));
    let mut instead = main.terms.iter().map(|term| confounding::instead(term.effect, prepared));
    notes.extend(instead.find(|text| !text.is_empty()).unwrap_or_default());
    notes
}

/// A steady-state run accelerates only between its plateaus, in steps of the set-point. The torque of a step passes
/// between two samples, so that the fitted inertia is too small by an unknown amount. If the set-up states the inertia,
/// it is used. The interval reaches from zero to twice its value, and contains all of the fitted one.
fn stated_inertia(terms: &mut [TermReport], parameters: &mut [Parameter], prepared: &Prepared) -> Option<String> {
    let stated = prepared.main.view.constants.rotor_inertia.filter(|_| prepared.main.settled)?;
    let p = parameters.iter_mut().find(|p| p.effect == inertia::ID)?;
    let half = p.ci95.map(|end| (end - stated).abs()).into_iter().fold(stated, f64::max);
    *p = Parameter {
        value: stated,
        ci95: [(stated - half).max(0.0), stated + half],
        state: ParameterState::Unidentified,
        note: Some("not determined by this run; the value of the set-up".into()),
        ..p.clone()
    };
    terms.iter_mut().filter(|term| term.effect == inertia::ID).for_each(|term| term.linear = vec![stated]);
    Some(format!(
        "the run does not determine the inertia: it accelerates only between constant speeds. The model uses the {} \
         that the set-up states; record a trajectory",
        figure(stated, &p.unit)
    ))
}

/// The formula of an effect in this data, if it differs from the library.
pub fn written(term: &Term) -> Option<String> {
    let (info, formula) = (term.effect.info(), term.effect.formula_of(term.form.name));
    (formula != info.formula).then(|| format!("{} is {formula} in this data", info.id))
}

/// The square of a larger number overflows.
const LARGEST: f64 = 1e150;

/// Condition number of the scaled columns by QR; linearly dependent columns are an error.
fn check_columns(terms: &LinearModel) -> Result<f64, ModelError> {
    let columns = terms.columns();
    let found = condition(&columns);
    let owner = |column: usize| {
        let mut names = terms.terms.iter().flat_map(|t| t.columns.iter().map(|_| t.id()));
        names.nth(column).unwrap_or_default().to_owned()
    };
    match found.dependent {
        Some((a, b)) if a == b => {
            let is_finite = columns[a].iter().all(|v| v.abs() < LARGEST);
            let why =
                if is_finite { "its signal never changes" } else { "its formula gives more than numbers can hold" };
            Err(ModelError::NotVisible { effect: owner(a), why: why.into() })
        }
        Some((a, b)) => Err(ModelError::Collinear { first: owner(a), second: owner(b) }),
        None => Ok(found.number),
    }
}

fn unseen(assembly: &TwoStageModel, id: &str, why: &str) -> Vec<Parameter> {
    let Ok(effect) = assembly.spec.find(id) else { return Vec::new() };
    effect
        .info()
        .parameters
        .iter()
        .map(|p| Parameter {
            effect: id.into(),
            name: p.name.to_string(),
            value: 0.0,
            unit: assembly.prepared.motion.label(&p.unit),
            ci95: [0.0, 0.0],
            state: ParameterState::Unidentified,
            note: Some(format!("not visible in this data: {why}")),
        })
        .collect()
}

/// Evaluates a fit on a run that was not used for it. The run is preprocessed as the fitted one.
pub fn evaluate(fit: &Fit, run: &RunTable) -> Result<Evaluation, ModelError> {
    let prepared = prepare_alike(fit, run)?;
    let problem = prepared.judged(&fit.effects);
    let (effects, nuisance) = (predict_effects(fit, problem)?, predict_nuisance(fit, problem)?);
    let target = &prepared.main.target;
    let error = |predicted: &[f64]| target.iter().zip(predicted).map(|(y, p)| (y - p).powi(2)).sum::<f64>();
    let whole: Vec<f64> = effects.iter().zip(&nuisance).map(|(effects, nuisance)| effects + nuisance).collect();
    let sse = error(&whole);
    let settled = prepared.main.view.chunks.iter().map(|c| c.len()).sum::<usize>() as f64;
    Ok(Evaluation {
        rms: (sse / target.len() as f64).sqrt(),
        effects_rms: (!fit.form_error.is_empty()).then(|| (error(&effects) / target.len() as f64).sqrt()),
        unit: prepared.unit(),
        residual: prepared.about.residual,
        relative_error: (sse / dot(target, target)).sqrt(),
        rows: target.len(),
        samples: run.len(),
        settled_share: (prepared.about.residual == ResidualKind::PlateauMean).then(|| settled / run.len() as f64),
        notes: fit.scope.iter().flat_map(|scope| scope.notes(fit, &prepared)).collect(),
    })
}
