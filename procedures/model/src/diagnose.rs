//! Which effect is missing, and what is left when all that can be named is in the model.

use crate::assembly::Assembly;
use crate::explore::{Advance, Exploration, Withdrawal};
use crate::fit::report;
use crate::linear::dot;
use crate::maps::{Maps, yardstick};
use crate::prepare::{Prepared, prepare};
use crate::report::{Diagnosis, Discovery, Experiment, PairMap, Region, Silent, Step, Suggestion, Verdict};
use crate::select::held_out;
use crate::words::{figure, list, percent, spoken};
use crate::{Fit, ModelError, ModelSpec, Options};
use jointbench_instrument::RunTable;

/// How far the search looks ahead for a diagnosis.
const MOST_EFFECTS: usize = 6;

/// A picture that takes less than this off held-out squared error shows nothing.
const LEAST_SHOWN: f64 = 0.02;

/// Compares a model with a run: where it fails, which effects are missing, how sure that is.
pub fn diagnose(run: &RunTable, spec: &ModelSpec, options: &Options) -> Result<Diagnosis, ModelError> {
    let prepared = prepare(run, options)?;
    let found = Exploration::new(&prepared, spec, options, MOST_EFFECTS, &mut |_| {})?;
    let fit = report(&found.start)?;
    let suggestions = suggestions(&found, &fit, spec, options)?;
    let verdict = if suggestions.is_empty() { found.end_verdict() } else { Verdict::MissingEffect };
    let regions = if verdict == Verdict::MissingEffect {
        let start = &found.start.main;
        let residual = start.tangent().rest(&start.response());
        regions(&Maps::new(&prepared, residual, options), &fit, &found, verdict)
    } else {
        regions(&found.maps, &fit, &found, verdict)
    };
    let structure = structure(&found, verdict);
    let mut not_visible = found.start.hidden.clone();
    not_visible.extend(found.invisible.iter().cloned());
    Ok(Diagnosis {
        kind: prepared.kind,
        model: found.start.effects.clone(),
        own: spec.own.clone(),
        residual: fit.residual,
        noise_floor_rms: found.floor.rms,
        noise_floor: found.floor.clone(),
        verdict,
        undecided: undecided(&found, verdict, options),
        summary: format!(
            "{}{}",
            summary(&found, &fit, verdict, &suggestions, structure.as_ref(), options),
            taken_back(&found, &fit.unit)
        ),
        regions,
        structure,
        experiment: experiment(&found, &prepared),
        silent: found
            .silent
            .iter()
            .map(|s| Silent { effect: s.effect.into(), minimum_detectable_rms: s.detectable_rms })
            .collect(),
        not_visible,
        suggestions,
        fit,
    })
}

/// Diagnoses, adds the best effect and fits again until nothing more can be named or `max_effects` were added.
///
/// `on_step` sees every step when it is made.
pub fn discover(
    run: &RunTable,
    spec: &ModelSpec,
    options: &Options,
    max_effects: usize,
    mut on_step: impl FnMut(&Step),
) -> Result<Discovery, ModelError> {
    let prepared = prepare(run, options)?;
    let mut steps = vec![step(&Assembly::new(&prepared, spec, options)?, None)];
    on_step(&steps[0]);
    let found = Exploration::new(&prepared, spec, options, max_effects, &mut |advance| {
        let step = step(&advance.after, Some(advance));
        on_step(&step);
        steps.push(step);
    })?;
    let fit = report(found.end())?;
    let verdict = found.end_verdict();
    let structure = structure(&found, verdict);
    Ok(Discovery {
        kind: prepared.kind,
        steps,
        residual: fit.residual,
        noise_floor_rms: found.floor.rms,
        noise_floor: found.floor.clone(),
        verdict,
        undecided: undecided(&found, verdict, options),
        summary: format!(
            "{}{}",
            summary(&found, &fit, verdict, &[], structure.as_ref(), options),
            taken_back(&found, &fit.unit)
        ),
        model: found.end().effects.clone(),
        regions: regions(&found.maps, &fit, &found, verdict),
        structure,
        experiment: experiment(&found, &prepared),
        fit,
    })
}

fn step(model: &Assembly, advance: Option<&Advance>) -> Step {
    let residual = model.main.linear().residual;
    let n = residual.len() as f64;
    Step {
        added: advance.and_then(|a| a.added.as_ref()).map(|r| r.term.id().into()),
        removed: advance.and_then(|a| a.removed).map(Into::into),
        confounded_with: advance.map_or_else(Vec::new, |a| a.ties.iter().map(|t| (*t).into()).collect()),
        model: model.effects.clone(),
        rms: (dot(&residual, &residual) / n).sqrt(),
        validation_rms: (held_out(&model.main).iter().sum::<f64>() / n).sqrt(),
    }
}

fn suggestions(
    found: &Exploration,
    fit: &Fit,
    spec: &ModelSpec,
    options: &Options,
) -> Result<Vec<Suggestion>, ModelError> {
    let mut out = Vec::new();
    let complete = report(found.end())?;
    for (advance, importance) in found.ranking() {
        let Some(rival) = &advance.added else { continue };
        let id = rival.term.id();
        let with = spec.with(id)?;
        let alone = Assembly::new(found.start.prepared, &with, options)?;
        let with = report(&alone)?;
        let apart = alone.is_apart(rival.term.effect);
        let reduction = if apart {
            1.0 - (1.0 - rival.share).max(0.0).sqrt()
        } else {
            1.0 - with.validation_rms / fit.validation_rms
        };
        let info = rival.term.effect.info();
        let confounded_with: Vec<String> = advance.ties.iter().map(|t| (*t).into()).collect();
        let tie = if confounded_with.is_empty() {
            String::new()
        } else {
            format!(" This run cannot tell it from {}.", list(&confounded_with))
        };
        let evidence = if apart {
            format!("Around reversals it takes {} off the squared error.", percent(rival.share))
        } else {
            let times = 1.0 / (1.0 - importance).max(f64::MIN_POSITIVE);
            let times = if times > 1000.0 { "over 1000".to_owned() } else { format!("{times:.1}") };
            format!("Without this effect the complete model's squared error would be {times} times as large.")
        };
        let why = format!("{} {evidence}{tie}", info.sentence);
        out.push(Suggestion {
            effect: id.into(),
            validation_rms: with.validation_rms,
            error_reduction: reduction,
            p_value: rival.p_value,
            error_reduction_together: found.lost_without(rival.term.id()),
            parameters: complete.parameters.iter().filter(|p| p.effect == id).cloned().collect(),
            confounded_with,
            why,
        });
    }
    Ok(out)
}

/// Where a model fails. Nowhere that counts, where it is adequate.
fn regions(maps: &Maps, fit: &Fit, found: &Exploration, verdict: Verdict) -> Vec<Region> {
    match verdict {
        Verdict::Adequate => Vec::new(),
        _ => maps.regions(&fit.unit, yardstick(fit, Some(&found.floor)).as_ref()),
    }
}

fn structure(found: &Exploration, verdict: Verdict) -> Option<PairMap> {
    (verdict == Verdict::UnexplainedStructure).then(|| found.maps.structure(found.start.prepared))?
}

fn summary(
    found: &Exploration,
    fit: &Fit,
    verdict: Verdict,
    suggestions: &[Suggestion],
    structure: Option<&PairMap>,
    options: &Options,
) -> String {
    let error = figure(fit.validation_rms, &fit.unit);
    let floor = match found.floor.rms {
        Some(floor) => format!("the run repeats itself to {}", figure(floor, &fit.unit)),
        None => "how well the run repeats itself is not known".into(),
    };
    match verdict {
        Verdict::Adequate => match undecided(found, verdict, options) {
            None => format!("The model explains this run: its held-out error is {error}, and {floor}."),
            Some(why) => format!(
                "Nothing more can be named in this run, whose held-out error is {error}; whether the model is adequate \
                 cannot be decided: {why}."
            ),
        },
        Verdict::MissingEffect => {
            let first = &suggestions[0];
            let more: Vec<&str> = suggestions[1..].iter().map(|s| s.effect.as_str()).collect();
            let more = if more.is_empty() { String::new() } else { format!(", then {}", list(&more)) };
            let with = figure(first.validation_rms, &fit.unit);
            let effect = &first.effect;
            if with == error {
                format!(
                    "{effect} is missing{more}: it acts around reversals; settled motion has a held-out error of {error} \
                     with it and without it, and {floor}."
                )
            } else {
                format!(
                    "{effect} is missing{more}: with {effect} the held-out error falls from {error} to {with}; {floor}."
                )
            }
        }
        Verdict::UnexplainedStructure => {
            let repeats = match found.floor.repeatable_share {
                Some(share) => format!(", {} of it the same in every repeat", percent(share)),
                None => String::new(),
            };
            let pair = structure.map(|s| (format!("{} and {}", spoken(&s.x), spoken(&s.y)), s.removable_share));
            let axis = found.maps.removable().map(|(axis, share)| (spoken(axis), share));
            // A second axis cuts the first one's bins: what shows over one alone can be more.
            let shows = match axis.into_iter().chain(pair).max_by(|a, b| a.1.total_cmp(&b.1)) {
                Some((axes, share)) if share > LEAST_SHOWN => format!(
                    "it shows most over {axes}, a function of which would take {} off the squared error that \
                     remains ({error}{repeats})",
                    percent(share),
                ),
                _ => format!(
                    "no axis of this run shows where it comes from (the error that remains is {error}{repeats})"
                ),
            };
            format!("Structure remains that no effect of the library explains: {shows}; {floor}.")
        }
    }
}

/// What too short a run cannot decide, however well the model fits it.
fn undecided(found: &Exploration, verdict: Verdict, options: &Options) -> Option<String> {
    let blocks = found.start.main.problem.blocks;
    // The smallest p-value that flipping the signs of so many blocks can give.
    let smallest = 0.5f64.powi(blocks.saturating_sub(1).min(60) as i32);
    match verdict {
        Verdict::Adequate if smallest > options.alpha => {
            Some(format!("{blocks} independent stretches of motion are too few to name anything"))
        }
        Verdict::Adequate if found.floor.rms.is_none() => Some(found.floor.source.clone()),
        _ => None,
    }
}

/// Effects that came in and were taken back, and what that cost.
fn taken_back(found: &Exploration, unit: &str) -> String {
    let of = |why: Withdrawal| found.withdrawn.iter().filter(move |w| w.why == why);
    let is_out = |e: &&str| !found.end().effects.iter().any(|f| f == e);
    let named = |why: Withdrawal| {
        let mut names: Vec<&str> = of(why).map(|w| w.effect).filter(is_out).collect();
        names.reverse();
        (!names.is_empty()).then(|| list(&names))
    };
    let open = named(Withdrawal::Undecided).map(|names| {
        let with = of(Withdrawal::Undecided).map(|w| w.held_out_rms).fold(f64::INFINITY, f64::min);
        format!(
            " Left out: {names}. With it all the held-out error would be {} instead of {}, but this run does not \
             decide how large these effects are.",
            figure(with, unit),
            figure(found.end_held_out_rms(), unit)
        )
    });
    let half = named(Withdrawal::HalfExplains)
        .map(|names| format!(" Taken back: {names}, because it explains only a part of what shows over its own axis."));
    open.into_iter().chain(half).collect()
}

/// What to measure next.
fn experiment(found: &Exploration, prepared: &Prepared) -> Option<Experiment> {
    if found.floor.rms.is_none() {
        let mut parameters = serde_json::Map::new();
        parameters.insert("repeats".into(), 3.into());
        return Some(Experiment {
            procedure: prepared.kind.name().into(),
            parameters,
            why: "without repeats of the same profile nobody knows how small the error can become".into(),
            expected_z: None,
            expected_duration_s: None,
            separates: Vec::new(),
        });
    }
    None
}
