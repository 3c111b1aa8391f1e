//! Diagnosis: the missing effects, and the unexplained structure of the final model.

pub(crate) mod evidence;
pub(crate) mod excluded_effects;
pub(crate) mod findings;
pub(crate) mod narrative;
pub(crate) mod rejected;
pub(crate) mod remaining;
pub(crate) mod reversals;

use crate::diagnosis::findings::{Findings, InLastModel};
use crate::effect::{Shape, ShapeSearch};
use crate::fit::{report, written};
use crate::inference::confounding;
use crate::preprocess::{Prepared, prepare};
use crate::regression::cross_validation::validation_rms;
use crate::regression::two_stage_model::TwoStageModel;
use crate::report::diagnosis::{Diagnosis, Discovery, Evidence, Experiment, Step, Suggestion, Verdict};
use crate::report::fit::{Parameter, ParameterState};
use crate::report::maps::{PairMap, Region};
use crate::report::text::{parts, plain};
use crate::residual_analysis::maps::Maps;
use crate::residual_analysis::maps::regions::reference;
use crate::selection;
use crate::selection::forward_step::ScoredCandidate;
use crate::selection::path::SelectionStep;
use crate::thresholds::MOST_EFFECTS;
use crate::words::{Scale, figure, list, percent, with_minus};
use crate::{Fit, ModelError, ModelSpec, Options};
use jointbench_instrument::RunTable;

/// Compares a model with a run: regions of large residuals, missing effects, and their significance.
///
/// # Errors
/// As [`crate::fit()`]. Contradicting columns and effects that the run cannot show are part of the result.
///
/// ```
/// use jointbench_instrument::{Channel, Kind, Meta, RunTable, Trace};
/// use jointbench_model::{ModelSpec, Options, Verdict, diagnose};
///
/// // A joint that swings for 40 s with Coulomb and viscous friction, and with the gravity of a link.
/// let names = ["time_s", "motor_position_rad", "motor_current_a", "link_position_rad"];
/// let mut trace = Trace::new(names.map(Channel::new).to_vec());
/// for i in 0..10_000 {
///     let t = 0.004 * f64::from(i);
///     let position = 20.0 * (0.7 * t).sin() + 5.0 * (2.0 * t).sin();
///     let velocity = 14.0 * (0.7 * t).cos() + 10.0 * (2.0 * t).cos();
///     let noise = 1e-3 * (f64::from(i * i % 1009) / 1009.0 - 0.5);
///     let torque = 0.03 * velocity.signum() + 0.002 * velocity + 0.02 * (position / 10.0).sin() + noise;
///     trace.push_row(&[t, position, torque / 0.08, position / 10.0]);
/// }
/// let (kind, torque_constant_nm_per_a) = (Some(Kind::Friction), Some(0.08));
/// let meta = Meta { kind, torque_constant_nm_per_a, gear_ratio: Some(10.0), ..Meta::default() };
/// let run = RunTable::new(meta, trace).unwrap();
///
/// let model = ModelSpec::parse(Kind::Friction, "coulomb, viscous").unwrap();
/// let found = diagnose(&run, &model, &Options::default()).unwrap();
/// assert_eq!(found.verdict, Verdict::MissingEffect, "{}", found.summary);
/// assert_eq!(found.suggestions[0].effect, "gravity");
/// ```
pub fn diagnose(run: &RunTable, spec: &ModelSpec, options: &Options) -> Result<Diagnosis, ModelError> {
    refuse_settings(spec)?;
    let prepared = prepare(run, options)?;
    let selected = selection::search(&prepared, spec, options, MOST_EFFECTS as usize)?;
    let found = Findings::of(&prepared, selected, options);
    let mut fit = report(&found.start)?;
    if found.steps.is_empty() {
        leave_open(&mut fit, &found);
    }
    let complete = report(found.end())?;
    let suggestions = suggestions(&found, &fit, &complete, spec, options)?;
    let verdict = if suggestions.is_empty() { found.end_verdict() } else { Verdict::MissingEffect };
    let undecided = narrative::undecided(&found, &[&fit, &complete], verdict, options);
    let start = &found.start.main;
    let of_start = (verdict == Verdict::MissingEffect).then(|| Maps::new(&prepared, start.linear().residual, options));
    let maps = of_start.as_ref().unwrap_or(&found.maps);
    let mut regions = regions(maps, &fit, &found, verdict == Verdict::Adequate && undecided.is_none());
    let remembering = found.ranking().into_iter().filter_map(|(step, _)| step.added.as_ref());
    let apart = remembering.filter(|scored| found.start.is_apart(scored.term.effect));
    let reach = apart.filter_map(|scored| scored.term.shape.first().copied());
    let measure = reference(&fit, Some(&found.floor));
    let reversals = reach.filter_map(|reach| reversals::region(&found.start, reach, &fit, measure.as_ref()));
    regions.splice(0..0, reversals.collect::<Vec<_>>());
    let structure = structure(&found, verdict);
    let summary = match verdict {
        Verdict::MissingEffect => narrative::missing(&found, &fit, &complete, &suggestions),
        _ => narrative::end(&found, &complete, structure.as_ref(), options, false),
    } + &narrative::nowhere(verdict, maps, &regions, &fit);
    Ok(Diagnosis {
        kind: prepared.kind,
        model: found.start.effects.clone(),
        user_effects: spec.user_effects.clone(),
        residual: fit.residual,
        noise_floor_rms: found.floor.rms,
        noise_floor: found.floor.clone(),
        verdict,
        undecided_reason: undecided.as_ref().map(|why| why.reason),
        undecided: undecided.map(|why| plain(&why.text)),
        summary: plain(&summary),
        summary_parts: parts(&summary),
        data_problems: narrative::data_problems(&found),
        shows_over: shows_over(&found),
        structure_remains: found.end_verdict() == Verdict::UnexplainedStructure,
        regions,
        structure,
        imitated: found.open.clone(),
        experiment: experiment(&found, &prepared),
        silent: found.silent(),
        not_visible: found.not_visible(),
        left_out: found.left_out(),
        suggestions,
        fit,
    })
}

/// The tests compare fits in which every parameter is free.
fn refuse_settings(spec: &ModelSpec) -> Result<(), ModelError> {
    if spec.settings.is_empty() { Ok(()) } else { Err(ModelError::NotDiagnosed) }
}

/// Diagnoses, adds the best effect and refits until no candidate passes or `max_effects` were added.
pub fn discover(
    run: &RunTable,
    spec: &ModelSpec,
    options: &Options,
    max_effects: usize,
) -> Result<Discovery, ModelError> {
    refuse_settings(spec)?;
    let prepared = prepare(run, options)?;
    let selected = selection::search(&prepared, spec, options, max_effects)?;
    let found = Findings::of(&prepared, selected, options);
    let made = found.steps.iter().map(|made| step(&found, &made.after, Some(made)));
    let steps: Vec<Step> = std::iter::once(step(&found, &found.start, None)).chain(made).collect();
    let is_cut = steps.iter().filter(|step| step.added.is_some()).count() >= max_effects;
    let mut fit = report(found.end())?;
    leave_open(&mut fit, &found);
    let verdict = found.end_verdict();
    let structure = structure(&found, verdict);
    let undecided = narrative::undecided(&found, &[&fit], verdict, options);
    let regions = regions(&found.maps, &fit, &found, verdict == Verdict::Adequate && undecided.is_none());
    Ok(Discovery {
        kind: prepared.kind,
        steps,
        residual: fit.residual,
        noise_floor_rms: found.floor.rms,
        noise_floor: found.floor.clone(),
        verdict,
        undecided_reason: undecided.as_ref().map(|why| why.reason),
        undecided: undecided.map(|why| plain(&why.text)),
        summary: plain(&narrative::end(&found, &fit, structure.as_ref(), options, is_cut))
            + &narrative::nowhere(verdict, &found.maps, &regions, &fit),
        shows_over: shows_over(&found),
        model: found.end().effects.clone(),
        regions,
        structure,
        imitated: found.open.clone(),
        experiment: experiment(&found, &prepared),
        silent: found.silent(),
        not_visible: found.not_visible(),
        left_out: found.left_out(),
        fit,
    })
}

/// The model after a step; ties are those of the last model.
fn step(found: &Findings, model: &TwoStageModel, made: Option<&SelectionStep>) -> Step {
    let added = made.and_then(|made| made.added.as_ref());
    Step {
        added: added.map(|scored| scored.term.id().into()),
        addition_reason: added.map(|scored| scored.reason),
        removed: made.and_then(|made| made.removed).map(|(id, _)| id.into()),
        removal_reason: made.and_then(|made| made.removed).map(|(_, why)| why),
        confounded_with: added.map_or_else(Vec::new, |scored| found.ties_of(scored.term.id())),
        model: model.effects.clone(),
        rms: (model.main.linear().sse / model.main.problem.rows() as f64).sqrt(),
        validation_rms: validation_rms(&model.main),
    }
}

fn suggestions(
    found: &Findings,
    fit: &Fit,
    complete: &Fit,
    spec: &ModelSpec,
    options: &Options,
) -> Result<Vec<Suggestion>, ModelError> {
    let mut out = Vec::new();
    for (step, importance) in found.ranking() {
        let Some(scored) = &step.added else { continue };
        let id = scored.term.id();
        let with = spec.with(id)?;
        let alone = TwoStageModel::new(found.start.prepared, &with, options)?;
        let with = report(&alone)?;
        let apart = alone.is_apart(scored.term.effect);
        let reduction = if apart {
            1.0 - (1.0 - scored.share).max(0.0).sqrt()
        } else {
            1.0 - with.validation_rms / fit.validation_rms
        };
        let info = scored.term.effect.info();
        let confounded_with = found.ties_of(id);
        let tie = tie(found, id, &confounded_with, spec, options)?;
        let sentence = evidence_sentence(found, scored, importance, apart);
        let written = found.end().main.terms.iter().find(|term| term.id() == id).and_then(written);
        let instead = confounding::instead(scored.term.effect, found.start.prepared);
        let also: String = written.into_iter().chain(instead).map(|text| format!(" {text}.")).collect();
        let reduction_ci95 = (!apart).then(|| evidence::reduction(&found.start.main, &alone.main)).flatten();
        let InLastModel { error_reduction: together, bic_change } = found.in_last_model(id, options)?;
        let figures = match (scored.is_without_form_error, fit.effects_rms, with.effects_rms) {
            // The nuisance terms hide what the effect does.
            (true, Some(before), Some(after)) => (1.0 - after / before, None),
            _ => (reduction, reduction_ci95),
        };
        let has_size = has_size(complete, found, id);
        let (evidence, weak) = Evidence::of(scored.p_value, figures.0, figures.1, together, has_size);
        let weak = weak.map(|why| format!(" Weak evidence: {why}.")).unwrap_or_default();
        let order = open_order(complete, found, id).map(|why| format!(" The number of waves is {why}."));
        let reasons = format!("{sentence}{weak}{tie}{}{also}", order.unwrap_or_default());
        out.push(Suggestion {
            effect: id.into(),
            validation_rms: with.validation_rms,
            effects_rms: with.effects_rms,
            error_reduction: reduction,
            error_reduction_ci95: reduction_ci95,
            bic_change: (!apart).then_some(bic_change),
            p_value: scored.p_value,
            evidence,
            p_at_most: found.decided.is_none() && scored.p_value * (options.flips + 1) as f64 <= 1.001,
            error_reduction_together: together,
            parameters: complete.parameters.iter().filter(|p| p.effect == id).cloned().collect(),
            confounded_with,
            why: format!("{} {reasons}", info.sentence),
            reasons,
        });
    }
    Ok(out)
}

/// Whether the interval of one of the coefficients of an effect excludes zero.
fn has_size(complete: &Fit, found: &Findings, id: &str) -> bool {
    let Some(term) = found.end().main.terms.iter().find(|term| term.id() == id) else { return true };
    let is_coefficient = |p: &&Parameter| p.effect == id && term.form.linear.contains(&p.name.as_str());
    let mut coefficients = complete.parameters.iter().filter(is_coefficient).peekable();
    coefficients.peek().is_none() || coefficients.any(|p| p.ci95[0] > 0.0 || p.ci95[1] < 0.0)
}

/// Why the order of an added wave is not identified.
fn open_order<'f>(complete: &'f Fit, found: &Findings, id: &str) -> Option<&'f str> {
    let term = found.end().main.terms.iter().find(|term| term.id() == id)?;
    let is_order = |p: &&Parameter| {
        let is_whole = |shape: &Shape| shape.name == p.name && shape.search == ShapeSearch::Whole;
        p.effect == id && p.state == ParameterState::Unidentified && term.form.shape.iter().any(is_whole)
    };
    complete.parameters.iter().find(is_order)?.note.as_deref()
}

/// What speaks for an added effect, in a sentence.
fn evidence_sentence(found: &Findings, scored: &ScoredCandidate, importance: f64, apart: bool) -> String {
    if apart {
        format!("Around reversals it reduces the squared error by {}.", percent(scored.share))
    } else if let Some(retained) = found.retained.iter().find(|u| u.effect == scored.term.id()) {
        format!("Removing it hardly changes the error, but without it {}.", narrative::elsewhere(retained, false))
    } else if found.decided.is_some() {
        let (over_all, to) = found.reduction_when_added(scored.term.id());
        let (weighted, over_all_text) = (percent(importance), percent(over_all));
        match (scored.is_without_form_error, over_all > 0.0) {
            (true, _) => format!(
                "Without the nuisance terms that imitate it, it reduces the squared validation error by {weighted}."
            ),
            (false, true) => format!(
                "Added to {to}, it reduces the squared validation error by {over_all_text} ({weighted} with less weight on \
                 reversals and rest)."
            ),
            (false, false) => {
                format!(
                    "With less weight on reversals and rest, it reduces the squared validation error by {weighted}."
                )
            }
        }
    } else {
        let times = 1.0 / (1.0 - importance).max(f64::MIN_POSITIVE);
        let by = match times {
            ..1.1 => format!("by {}", percent(times - 1.0)),
            ..=1000.0 => format!("{times:.1}-fold"),
            _ => "over 1000-fold".to_owned(),
        };
        format!("Removing it from the final model increases the squared error of the fit {by}.")
    }
}

/// The effects that are confounded with an added one, in a sentence. Their contributions are compared in the final model.
fn tie(
    found: &Findings,
    id: &str,
    confounded_with: &[String],
    spec: &ModelSpec,
    options: &Options,
) -> Result<String, ModelError> {
    if confounded_with.is_empty() {
        return Ok(String::new());
    }
    let others = found.end().effects.iter().filter(|effect| *effect != id).cloned();
    let base = ModelSpec::with_user_effects(spec.kind, others, spec.user_effects.clone())?;
    let prepared = found.start.prepared;
    let without = TwoStageModel::new(prepared, &base, options)?;
    let with_effect = base.with(id)?;
    let with_effect = TwoStageModel::new(prepared, &with_effect, options)?;
    let scale = Scale::of(validation_rms(&with_effect.main), &prepared.unit());
    let instead = |rival: &String| {
        let other = base.with(rival)?;
        let other = TwoStageModel::new(prepared, &other, options)?;
        let correlation = evidence::correlation(&without.main, &with_effect.main, &other.main);
        Ok(format!(
            "{} with {rival} (correlation of the contributions {})",
            scale.figure(validation_rms(&other.main)),
            with_minus(&format!("{correlation:.2}"))
        ))
    };
    let instead = confounded_with.iter().map(instead).collect::<Result<Vec<String>, ModelError>>()?;
    Ok(format!(
        " This run cannot distinguish it from others: in its place, the validation error is {} instead of {}.",
        list(&instead),
        scale.figure(validation_rms(&with_effect.main))
    ))
}

/// The interval of a parameter assumes that no effect is missing. If an effect may be present as well, the interval
/// is extended to the value with that effect.
fn leave_open(fit: &mut Fit, found: &Findings) {
    let Some(open) = &found.open else { return };
    let is_meant = |p: &&mut Parameter| format!("{}.{}", p.effect, p.name) == open.parameter;
    if let Some(parameter) = fit.parameters.iter_mut().find(is_meant) {
        parameter.ci95 = [parameter.ci95[0].min(open.with), parameter.ci95[1].max(open.with)];
        let with = figure(open.with, &open.unit);
        parameter.note = Some(format!("would be {with} with {}, which this run does not exclude", open.effect));
    }
}

/// Regions of large residuals. None for an adequate model.
fn regions(maps: &Maps, fit: &Fit, found: &Findings, is_adequate: bool) -> Vec<Region> {
    match is_adequate {
        true => Vec::new(),
        false => maps.regions(&fit.unit, reference(fit, Some(&found.floor)).as_ref()),
    }
}

fn structure(found: &Findings, verdict: Verdict) -> Option<PairMap> {
    (verdict == Verdict::UnexplainedStructure).then(|| found.maps.structure(&found.start.prepared.main))?
}

/// The columns that the summary names for structure that remains with all suggestions.
fn shows_over(found: &Findings) -> Vec<String> {
    if found.end_verdict() != Verdict::UnexplainedStructure {
        return Vec::new();
    }
    let shown = found.maps.structure(&found.start.prepared.main);
    remaining::shown_over(found, shown.as_ref()).unwrap_or_default().0
}

/// The recommended next run.
fn experiment(found: &Findings, prepared: &Prepared) -> Option<Experiment> {
    if found.floor.rms.is_none() && prepared.data_errors.is_empty() {
        let mut parameters = serde_json::Map::new();
        parameters.insert("repeats".into(), 3.into());
        return Some(Experiment {
            procedure: prepared.kind.name().into(),
            parameters,
            why: "without repeats of the same motion the noise floor is not known".into(),
            expected_z: None,
            expected_duration_s: None,
            separates: Vec::new(),
        });
    }
    None
}
