//! A diagnosis in plain sentences, with marked ids of effects.

use crate::diagnosis::findings::Findings;
use crate::diagnosis::rejected::rejected;
use crate::diagnosis::remaining::structure;
use crate::effect::Regime;
use crate::report::diagnosis::{Evidence, Imitated, Suggestion, UndecidedReason, Verdict};
use crate::report::fit::{Parameter, ParameterState};
use crate::report::maps::{PairMap, Region};
use crate::report::text::{all_marked, marked};
use crate::residual_analysis::maps::Maps;
use crate::selection::removal::Withdrawn;
use crate::thresholds::{LISTED_LOSS, NOTHING_IN_COMMON, SMALL_REDUCTION};
use crate::words::{Scale, figure, percent};
use crate::{Fit, Options};

/// The missing effects, and the structure that remains with them. `fit` is the given model, `complete` the one with
/// all suggestions.
pub fn missing(found: &Findings, fit: &Fit, complete: &Fit, suggestions: &[Suggestion]) -> String {
    let is_weak = |suggestion: &Suggestion| suggestion.evidence == Evidence::Weak;
    let all_weak = suggestions.iter().all(is_weak);
    let name = |suggestion: &Suggestion| {
        let weak = if is_weak(suggestion) && !all_weak { " (weak evidence)" } else { "" };
        with_confounded(suggestion) + weak
    };
    let named: Vec<String> = suggestions.iter().map(name).collect();
    let plural = if named.len() > 1 { "s" } else { "" };
    let head = match all_weak {
        true => format!("Possibly missing effect{plural} (weak evidence)"),
        false => format!("Missing effect{plural}"),
    };
    let beyond = match found.end_verdict() {
        Verdict::UnexplainedStructure => {
            let them = if named.len() > 1 { "them" } else { "it" };
            let shown = found.maps.structure(&found.start.prepared.main);
            format!(
                " Unexplained structure remains with {them}: {}. {}",
                structure(found, complete, shown.as_ref()),
                unexplained(found)
            )
        }
        _ => String::new(),
    };
    format!(
        "{}{head}: {}. {}{beyond}{}{}",
        attention(found, &[fit, complete]),
        named.join(", then "),
        gain(found, fit, complete, suggestions),
        open(found),
        rejected(found, &fit.unit)
    )
}

/// What the first suggestion does to the error, and where.
fn gain(found: &Findings, fit: &Fit, complete: &Fit, suggestions: &[Suggestion]) -> String {
    let first = &suggestions[0];
    let unit = Scale::of_all(&[fit.validation_rms, first.validation_rms, complete.validation_rms], &fit.unit);
    let effect = marked(&first.effect);
    let (error, with) = (unit.figure(fit.validation_rms), unit.figure(first.validation_rms));
    let floor = floor(found, complete, &unit);
    let regime = found.start.spec.find(&first.effect).map_or(Regime::SteadyState, |effect| effect.traits().regime);
    let place = if regime == Regime::Transient { "on ramps" } else { "around reversals" };
    let is_apart = regime != Regime::SteadyState && first.validation_rms > (1.0 - SMALL_REDUCTION) * fit.validation_rms;
    if let (true, Some(without), Some(alone)) = (is_apart, fit.effects_rms, first.effects_rms) {
        return format!(
            "{effect} acts {place}: adding it reduces the error of the effects alone from {} to {}. The nuisance terms of \
             the fit hide this: with them, the validation error is {with} with {effect} and {error} without it; {floor}.",
            unit.figure(without),
            unit.figure(alone)
        );
    }
    if is_apart {
        return format!(
            "{effect} acts {place}, where it reduces the error by {}; at steady state the validation error is {with} with it \
             and {error} without it; {floor}.",
            percent(first.error_reduction)
        );
    }
    if first.validation_rms >= fit.validation_rms {
        // The decision gives samples near reversals less weight.
        return format!(
            "With less weight on reversals and rest, adding {effect} reduces the squared validation error by {}; over all \
             samples the validation error is {with} with it and {error} without it; {floor}.",
            percent(found.ranking().first().map_or(0.0, |(_, share)| *share))
        );
    }
    let with_all = unit.figure(complete.validation_rms);
    let all = match suggestions.len() {
        1 => String::new(),
        _ if complete.validation_rms < first.validation_rms => format!(", and adding all of them to {with_all}"),
        _ => format!("; with all of them it is {with_all}"),
    };
    let alone = match (fit.effects_rms, first.effects_rms) {
        (Some(before), Some(after)) => match [before, after].map(|rms| unit.figure(rms)) {
            [was, is] if was == is => " (the effects alone, without the nuisance terms, predict no better)".into(),
            [was, is] if after > before => {
                format!(" (the effects alone, without the nuisance terms, predict worse: {is} instead of {was})")
            }
            [was, is] => format!(" (the effects alone, on the fitted data, from {was} to {is})"),
        },
        _ => String::new(),
    };
    format!("Adding {effect} reduces the validation error from {error} to {with}{alone}{all}; {floor}.")
}

/// An effect with those that it is confounded with.
fn with_confounded(suggestion: &Suggestion) -> String {
    let Suggestion { effect, confounded_with: confounded, .. } = suggestion;
    match confounded.is_empty() {
        true => marked(effect),
        false => {
            format!("{} (or {}: this run cannot distinguish them)", marked(effect), all_marked(confounded).join(" or "))
        }
    }
}

/// Summary of the final model of the search, which is `fit`. `is_cut`: it ended at the requested number of effects.
pub fn end(found: &Findings, fit: &Fit, shown: Option<&PairMap>, options: &Options, is_cut: bool) -> String {
    let unit = Scale::of(fit.validation_rms, &fit.unit);
    let (error, floor) = (unit.figure(fit.validation_rms), floor(found, fit, &unit));
    let verdict = found.end_verdict();
    let undecided = undecided(found, &[fit], verdict, options);
    let text = match (verdict, &undecided) {
        (Verdict::UnexplainedStructure, _) => format!(
            "Unexplained structure remains: {}; {floor}. {}",
            structure(found, fit, shown),
            match is_cut {
                true => "The requested number of effects is reached; further effects may explain it.",
                false => unexplained(found),
            },
        ),
        (_, None) if found.is_rounding() => format!(
            "The model explains this run. Validation error {error}, encoder quantization {}, {floor}.",
            unit.figure(found.start.prepared.main.view.constants.rounding)
        ),
        // Far above the noise floor, a model is adequate only because the residual is negligible.
        (_, None) if found.exceeds_floor() && found.is_negligible() => format!(
            "The residual is negligible relative to the measured signal. Validation error {error}, {floor}{}.",
            above(found, fit)
        ),
        (_, None) => {
            format!("The model explains this run. Validation error {error}, {floor}{}.", above(found, fit))
        }
        (_, Some(Undecided { text: why, .. })) if is_untested(found) => format!(
            "No effect was tested (validation error {error}). Whether the model is adequate cannot be decided: {why}."
        ),
        (_, Some(Undecided { text: why, .. })) => format!(
            "This run identifies no further effect (validation error {error}). Whether the model is adequate cannot be \
             decided: {why}."
        ),
    };
    let is_said = undecided.is_some_and(|why| why.reason == UndecidedReason::ImpossibleParameter);
    let sized: &[&Fit] = if is_said { &[] } else { &[fit] };
    attention(found, sized) + &text + &scatter(found, verdict, &fit.unit) + &open(found) + &rejected(found, &fit.unit)
}

/// Why the structure over an axis counts as noise.
fn scatter(found: &Findings, verdict: Verdict, unit: &str) -> String {
    let main = &found.start.prepared.main;
    let elsewhere = match 2 * main.different_angle.len() > main.replicate_pairs.len() {
        true => ", or friction depends on an angle that the repeats pass at other times",
        false => "",
    };
    let text = |rms: f64| {
        format!(
            " Part of the residual depends on an axis but hardly recurs in other repeats: the zero drifts by {} between \
             sections of the run{elsewhere}.",
            figure(rms, unit)
        )
    };
    found.scatter_rms().filter(|_| verdict == Verdict::Adequate).map(text).unwrap_or_default()
}

/// An effect that may be present as well, because the error does not decide.
fn open(found: &Findings) -> String {
    let text = |open: &Imitated| {
        let effect = marked(&open.effect);
        format!(" This run does not determine whether {effect} is present: with it {}.", elsewhere(open, true))
    };
    found.open.as_ref().map(text).unwrap_or_default()
}

/// The parameter that the absence of an imitated effect biases.
pub fn elsewhere(imitated: &Imitated, is_there: bool) -> String {
    let Imitated { parameter, unit, without, with, .. } = imitated;
    let (would, instead) = if is_there { (with, without) } else { (without, with) };
    format!("{parameter} would be {} instead of {}", figure(*would, unit), figure(*instead, unit))
}

const CORRECT: &str = "Correct this first: the results are based on these columns. ";
const CORRECT_ALL: &str =
    "Correct this first: no effect is suggested until then, and the results are based on these columns. ";

fn data_problem(what: &str) -> String {
    format!("Data problem: {what}.")
}

/// Contradicting columns, each in a sentence, with which a summary begins.
pub fn data_problems(found: &Findings) -> Vec<String> {
    found.start.prepared.data_errors.all().map(|what| data_problem(what)).collect()
}

/// Problems that a user has to correct first: contradicting columns, and a parameter that is physically impossible in
/// all fits. A constant input of an offset term is also reported, because its sensor may not have been connected.
fn attention(found: &Findings, fits: &[&Fit]) -> String {
    let problem = |what: &String| format!("{} ", data_problem(what));
    let data_errors = &found.start.prepared.data_errors;
    let correct = || if data_errors.fatal.is_empty() { CORRECT } else { CORRECT_ALL }.to_owned();
    let correct = (!data_errors.is_empty()).then(correct);
    let data_errors = data_errors.all().map(problem).chain(correct);
    let impossible = impossible(fits).map(|what| format!("Implausible: {what}. "));
    let spec = found.start.spec;
    let view = &found.start.main.problem.view;
    let is_dependent = |id: &str| spec.find(id).is_ok_and(|e| e.traits().is_offset && e.missing(view).is_none());
    let dead = found.start.hidden.iter().find(|h| is_dependent(&h.effect));
    let dead = dead.map(|h| format!("Data problem: {}; if that input was active, the results are wrong. ", h.why));
    data_errors.chain(impossible).chain(dead).collect()
}

/// The noise floor, and why an error may be smaller.
fn floor(found: &Findings, end: &Fit, unit: &Scale) -> String {
    let Some(floor) = found.floor.rms else {
        return "noise floor unknown".to_owned();
    };
    // An error within the interval of the noise floor needs no explanation.
    let below = match end.validation_rms < found.floor.ci95.map_or(floor, |[low, _]| low) {
        true => " (from repeated conditions only; the error over all samples may be smaller)",
        false => "",
    };
    let about = if found.floor.ci95.is_some() { "" } else { "about " };
    format!("noise floor {about}{}{below}", unit.figure(floor))
}

/// Composition of an error above the noise floor.
fn above(found: &Findings, end: &Fit) -> String {
    if found.floor.ci95.is_none_or(|[_, high]| end.validation_rms <= high) {
        return String::new();
    }
    match found.floor.repeatable_share {
        Some(share) if share < NOTHING_IN_COMMON => ". The difference is not repeatable".to_owned(),
        Some(share) => {
            format!(". {} of the squared error is repeatable, and no candidate effect reduces it", percent(share))
        }
        None => String::new(),
    }
}

/// Why no region of large residuals is reported, in a separate sentence. `maps` are the evaluated maps.
pub fn nowhere(verdict: Verdict, maps: &Maps, regions: &[Region], fit: &Fit) -> String {
    match verdict {
        Verdict::Adequate => String::new(),
        _ if !regions.is_empty() => String::new(),
        Verdict::MissingEffect => {
            format!(
                " In the residual of the given model, no part of an axis is significant{}.",
                maps.nowhere(&fit.unit)
            )
        }
        _ => format!(" No part of an axis is significant{}.", maps.nowhere(&fit.unit)),
    }
}

/// The reason why a verdict is undecided, and the sentence for it.
pub struct Undecided {
    pub reason: UndecidedReason,
    pub text: String,
}

/// Why the verdict is undecided: contradicting columns, too few blocks to reject a model, an unknown noise floor,
/// effects that predict worse than no model, or a parameter that is physically impossible in all fits.
pub fn undecided(found: &Findings, fits: &[&Fit], verdict: Verdict, options: &Options) -> Option<Undecided> {
    let blocks = found.start.main.problem.blocks;
    // The smallest possible p-value of sign flips with this number of blocks.
    let smallest = 0.5f64.powi(blocks.saturating_sub(1).min(60) as i32);
    let worse = fits.last().and_then(|fit| worse_than_no_model(fit));
    let (reason, text) = match verdict {
        _ if !found.start.prepared.data_errors.is_empty() => {
            (UndecidedReason::ContradictoryColumns, "the recording has the data problem above".to_owned())
        }
        Verdict::Adequate if smallest > options.alpha => {
            (UndecidedReason::TooFewBlocks, format!("{blocks} independent blocks are too few for a significance test"))
        }
        Verdict::Adequate if found.floor.rms.is_none() => {
            (UndecidedReason::NoNoiseFloor, without_floor(found, fits.last()?))
        }
        Verdict::Adequate if found.exceeds_floor() && !found.is_negligible() => above_floor(found),
        Verdict::Adequate if worse.is_some() => (UndecidedReason::NuisanceTerms, worse?),
        Verdict::Adequate | Verdict::MissingEffect => (UndecidedReason::ImpossibleParameter, impossible(fits)?),
        Verdict::UnexplainedStructure => return None,
    };
    Some(Undecided { reason, text })
}

/// Without a noise floor, a reader can only compare the error with the signal.
fn without_floor(found: &Findings, end: &Fit) -> String {
    format!("{}; the residual is {} of the measured RMS", found.floor.source, percent(end.relative_error))
}

/// An error above the noise floor that no test of structure explains.
fn above_floor(found: &Findings) -> (UndecidedReason, String) {
    const UNKNOWN: &str =
        "a few moments hold nearly all of the variance between its repeats, so its noise floor is not known";
    let (Some(floor), Some(_)) = (found.floor.rms, found.floor.ci95) else {
        return (UndecidedReason::NoNoiseFloor, UNKNOWN.into());
    };
    let times = found.end_validation_rms / floor;
    let why =
        format!("the error is {times:.1} times the noise floor, and no effect and no function of one axis explains it");
    (UndecidedReason::AboveNoiseFloor, why)
}

/// The sentence for effects that predict worse than no model. Only nuisance terms explain such a run.
fn worse_than_no_model(fit: &Fit) -> Option<String> {
    let alone = fit.effects_rms.filter(|alone| alone * fit.relative_error > fit.rms)?;
    let alone = figure(alone, &fit.unit);
    Some(format!("without the nuisance terms, the effects of the model have an error of {alone}, more than no model"))
}

/// A parameter that is physically impossible in all fits. With an additional curve in the model, the remaining linear
/// coefficient may change its sign.
fn impossible(fits: &[&Fit]) -> Option<String> {
    let is_impossible = |p: &&Parameter| p.state == ParameterState::Impossible;
    let in_fit = |fit: &Fit, of: &Parameter| {
        let mut impossible = fit.parameters.iter().filter(is_impossible);
        impossible.any(|p| (&p.effect, &p.name) == (&of.effect, &of.name))
    };
    let (last, others) = fits.split_last()?;
    let mut impossible = last.parameters.iter().filter(is_impossible);
    let p = impossible.find(|p| others.iter().all(|fit| in_fit(fit, p)))?;
    let note = p.note.as_deref().unwrap_or_default();
    let with = if others.is_empty() { "" } else { " with the missing effects added" };
    Some(format!("{} of {} is {}{with}, which {note}", p.name, marked(&p.effect), figure(p.value, &p.unit)))
}

/// Contradicting columns would make every effect spurious.
fn is_untested(found: &Findings) -> bool {
    !found.start.prepared.data_errors.fatal.is_empty()
}

/// Statement about unexplained structure; a rejected effect might explain it.
fn unexplained(found: &Findings) -> &'static str {
    if is_untested(found) {
        return "No effect was tested.";
    }
    let is_refused = found.decided.as_ref().is_some_and(|decided| !decided.refused.is_empty());
    let reduces = |w: &Withdrawn| w.validation_rms < LISTED_LOSS * found.end_validation_rms;
    match found.withdrawn.iter().any(reduces) || is_refused {
        true => "No testable effect explains it with certainty.",
        false => "No testable effect explains it.",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::selection::tiny::staircase;

    #[test]
    fn effects_that_predict_worse_than_no_model_do_not_explain_a_run() {
        let spec = crate::ModelSpec::new(jointbench_instrument::Kind::Friction, ["coulomb", "viscous"]).unwrap();
        let fit = crate::fit(&staircase(0.1, 0, 0.0), &spec, &Options::default()).unwrap();
        let measured = fit.rms / fit.relative_error;
        let with = |effects_rms| worse_than_no_model(&Fit { effects_rms, ..fit.clone() });
        assert_eq!((with(None), with(Some(0.9 * measured))), (None, None));
        assert!(with(Some(1.1 * measured)).unwrap().contains("more than no model"));
    }
}
