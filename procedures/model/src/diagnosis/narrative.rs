//! A diagnosis in plain sentences.

use crate::diagnosis::findings::Findings;
use crate::effect::{Effect, Regime};
use crate::report::diagnosis::{Evidence, Imitated, Suggestion, UndecidedReason, Verdict};
use crate::report::fit::{Parameter, ParameterState};
use crate::report::maps::{PairMap, Region};
use crate::residual_analysis::events::Events;
use crate::residual_analysis::lack_of_fit;
use crate::residual_analysis::maps::Maps;
use crate::residual_analysis::structure::Left;
use crate::selection::removal::{RemovalReason, Withdrawn};
use crate::thresholds::{NOTHING_IN_COMMON, PRACTICAL_SHARE, SECOND_AXIS_GAIN, TOLD_LOSS};
use crate::words::{figure, list, percent, spoken_axis};
use crate::{Fit, Options};

/// What is missing, and what is left when it is there. `fit` is the model at hand, `complete` the one with all suggestions.
pub fn missing(found: &Findings, fit: &Fit, complete: &Fit, suggestions: &[Suggestion]) -> String {
    let (error, floor) = (figure(fit.validation_rms, &fit.unit), floor(found, complete));
    let first = &suggestions[0];
    let more: Vec<String> = suggestions[1..].iter().map(or_rival).collect();
    let then = if more.is_empty() { String::new() } else { format!(", then {}", list(&more)) };
    let with = figure(first.validation_rms, &fit.unit);
    let (effect, named) = (&first.effect, or_rival(first));
    let all = match more.is_empty() {
        true => String::new(),
        false => format!(" and with all of them to {}", figure(complete.validation_rms, &fit.unit)),
    };
    let is = match suggestions.iter().all(|s| s.evidence == Evidence::Weak) {
        true => "may be missing, and the evidence is weak",
        false => "is missing",
    };
    let place = match found.start.spec.find(effect).map(Effect::regime) {
        Ok(Regime::Transient) => "on ramps",
        _ => "around reversals",
    };
    let gain = if with == error {
        format!(
            "{named} {is}{then}: it acts {place}; settled motion has a held-out error of {error} with it \
             and without it, and {floor}."
        )
    } else {
        format!("{named} {is}{then}: with {effect} the held-out error falls from {error} to {with}{all}; {floor}.")
    };
    let beyond = match found.end_verdict() {
        Verdict::UnexplainedStructure => {
            let them = if more.is_empty() { "it" } else { "them" };
            let shown = found.maps.structure(&found.start.prepared.main);
            format!(
                " Even with {them} structure remains that {}: {}.",
                unexplained(found),
                structure(found, complete, shown.as_ref())
            )
        }
        _ => String::new(),
    };
    format!("{}{gain}{beyond}{}{}", attention(found, &[fit, complete]), open(found), taken_back(found, &fit.unit))
}

/// An effect with what this run cannot tell it from: one of them alone would say more than the run knows.
fn or_rival(suggestion: &Suggestion) -> String {
    let Suggestion { effect, confounded_with: rivals, .. } = suggestion;
    match rivals.is_empty() {
        true => effect.clone(),
        false => format!("{effect} (or {} in its place: this run cannot tell)", rivals.join(" or ")),
    }
}

/// What is left at the end of the search, where `fit` is its model. `is_cut`: it ended because no more effects were asked for.
pub fn end(found: &Findings, fit: &Fit, shown: Option<&PairMap>, options: &Options, is_cut: bool) -> String {
    let (error, floor) = (figure(fit.validation_rms, &fit.unit), floor(found, fit));
    let verdict = found.end_verdict();
    let said = match (verdict, undecided(found, &[fit], verdict, options)) {
        (Verdict::UnexplainedStructure, _) => format!(
            "Structure remains{}: {}; {floor}.",
            match is_cut {
                true => ", and no more effects were asked for that could explain it".into(),
                false => format!(" that {}", unexplained(found)),
            },
            structure(found, fit, shown)
        ),
        (_, None) if found.is_rounding() => format!(
            "The model explains this run: its held-out error is {error}, as the steps of the encoders leave {}, and {floor}.",
            figure(found.start.prepared.main.view.constants.rounding, &fit.unit)
        ),
        // Far above the repeatability it is adequate for one reason only.
        (_, None) if found.exceeds_floor() && found.is_negligible() => format!(
            "What the model leaves is negligible beside what was measured: its held-out error is {error}, and {floor}{}.",
            above(found, fit)
        ),
        (_, None) => {
            format!("The model explains this run: its held-out error is {error}, and {floor}{}.", above(found, fit))
        }
        (_, Some(Undecided { said: why, .. })) => format!(
            "Nothing more can be named in this run, whose held-out error is {error}; whether the model is adequate \
             cannot be decided: {why}."
        ),
    };
    // Of a model that is adequate but for it, the sentence itself says so.
    let sized: &[&Fit] = if verdict == Verdict::UnexplainedStructure { &[fit] } else { &[] };
    attention(found, sized) + &said + &scatter(found, verdict, &fit.unit) + &open(found) + &taken_back(found, &fit.unit)
}

/// Why what shows over an axis is called noise.
fn scatter(found: &Findings, verdict: Verdict, unit: &str) -> String {
    let main = &found.start.prepared.main;
    let elsewhere = match 2 * main.different_angle.len() > main.replicate_pairs.len() {
        true => ", or friction depends on an angle that the repeats pass at other moments",
        false => "",
    };
    let said = |rms: f64| {
        format!(
            " What is left shows over an axis, but hardly comes again in another repeat, and is what whole stretches of motion \
             scatter by: the zero wanders by {} from one to another{elsewhere}.",
            figure(rms, unit)
        )
    };
    found.scatter_rms().filter(|_| verdict == Verdict::Adequate).map(said).unwrap_or_default()
}

/// An effect that may be there as well, for all that the error tells.
fn open(found: &Findings) -> String {
    let said = |open: &Imitated| {
        format!(" This run does not tell whether {} is there as well: with it {}.", open.effect, elsewhere(open, true))
    };
    found.open.as_ref().map(said).unwrap_or_default()
}

/// The figure that an effect changes which another one imitates.
pub fn elsewhere(imitated: &Imitated, is_there: bool) -> String {
    let Imitated { parameter, unit, without, with, .. } = imitated;
    let (would, instead) = if is_there { (with, without) } else { (without, with) };
    format!("{parameter} would be {} instead of {}", figure(*would, unit), figure(*instead, unit))
}

const MEND: &str = "Mend that first: what follows is what these columns make of the model. ";
const MEND_ALL: &str =
    "Mend that first: no effect is named before, and what follows is what these columns make of the model. ";

/// What a user has to mend before anything else counts: columns that contradict each other, a size that contradicts physics in all
/// of the fits, and what the model takes as given and the run shows as a constant, which may not have been connected.
fn attention(found: &Findings, fits: &[&Fit]) -> String {
    let told = |what: &String| format!("Attention: {what}. ");
    let clashes = &found.start.prepared.clashes;
    let mend = (!clashes.is_empty()).then(|| if clashes.void.is_empty() { MEND } else { MEND_ALL }.to_owned());
    let clashes = clashes.all().map(told).chain(mend);
    // Its own words say what to look for.
    let impossible = impossible(fits).as_ref().map(told);
    let spec = found.start.spec;
    let view = &found.start.main.problem.view;
    let is_dependent = |id: &str| spec.find(id).is_ok_and(|e| e.is_offset() && e.missing(view).is_none());
    let dead = found.start.hidden.iter().find(|h| is_dependent(&h.effect));
    let dead = dead.map(|h| format!("Attention: {}; if something did act there, what follows is wrong. ", h.why));
    clashes.chain(impossible).chain(dead).collect()
}

/// How well the run repeats itself, and why an error may be smaller than that.
fn floor(found: &Findings, end: &Fit) -> String {
    let Some(floor) = found.floor.rms else {
        let why =
            found.floor.source.strip_prefix("no noise floor").filter(|_| found.start.prepared.main.unlike.is_some());
        return format!("how well the run repeats itself is not known{}", why.unwrap_or_default());
    };
    // An error within the floor's own interval needs no excuse.
    let below = match end.validation_rms < found.floor.ci95.map_or(floor, |[low, _]| low) {
        true => {
            " (counted only at moments that come again in another repeat; the error over all moments may be smaller)"
        }
        false => "",
    };
    let about = if found.floor.ci95.is_some() { "" } else { "about " };
    format!("the run repeats itself to {about}{}{below}", figure(floor, &end.unit))
}

/// What an error is that is larger than the run repeats itself to, and that nothing takes away.
fn above(found: &Findings, end: &Fit) -> String {
    if found.floor.ci95.is_none_or(|[_, high]| end.validation_rms <= high) {
        return String::new();
    }
    match found.floor.repeatable_share {
        Some(share) if share < NOTHING_IN_COMMON => {
            ": what is above that is not the same at the same moment of another repeat".to_owned()
        }
        Some(share) => {
            format!(
                ": {} of the squared error is the same in every repeat, and nothing that was tried takes it away",
                percent(share)
            )
        }
        None => String::new(),
    }
}

/// Where what is left shows most.
fn structure(found: &Findings, end: &Fit, shown: Option<&PairMap>) -> String {
    let error = figure(end.validation_rms, &end.unit);
    let repeats = match found.floor.repeatable_share {
        Some(share) if share < NOTHING_IN_COMMON => {
            ", none of it the same at the same moment of another repeat".to_owned()
        }
        Some(share) => format!(", {} of it the same in every repeat", percent(share)),
        None => String::new(),
    };
    if lack_of_fit::structured(&found.maps).is_none()
        && let Some(event) = found.events.first()
    {
        let [from_s, to_s] = Events::span_s(&found.start.prepared.main, event);
        // Without repeats nobody knows what comes again.
        let does = match found.start.prepared.main.replicate_pairs.is_empty() {
            true => "lies far out of what all others scatter by",
            false => "lies far out of what all others scatter by and does not come again",
        };
        let which = match found.events.len() {
            1 => format!("it shows in one stretch of the run, which {does}:"),
            count => format!("it shows in {count} stretches of the run, each of which {does}, the largest of"),
        };
        return format!(
            "{which} {} from {from_s:.2} s to {to_s:.2} s (the error that remains is {error}{repeats})",
            figure(event.mean.abs(), &end.unit)
        );
    }
    match shown_over(found, shown) {
        Some((axes, share)) => format!(
            "it shows most over {}, a function of which would take {} off the squared error that remains \
             ({error}{repeats})",
            list(&axes.iter().map(|axis| spoken_axis(axis, found.start.prepared.kind)).collect::<Vec<_>>()),
            percent(share),
        ),
        None => format!("no axis of this run shows where it comes from (the error that remains is {error}{repeats})"),
    }
}

/// The columns over which what is left shows most, and what a function of them would take off it. `None` where none does.
pub fn shown_over(found: &Findings, shown: Option<&PairMap>) -> Option<(Vec<String>, f64)> {
    if let Some(decided) = &found.decided {
        let prepared = found.start.prepared;
        let named = |left: &Left| left.over.iter().map(|signal| prepared.column_name(*signal).to_owned()).collect();
        return decided.left.as_ref().map(|left| (named(left), left.share));
    }
    let pair = shown.map(|s| (vec![s.x.clone(), s.y.clone()], s.removable_share));
    let axis = found.maps.shows_over();
    // A second axis cuts the first one's bins: what shows over one alone can be more, and is said more shortly.
    let pair = pair.filter(|(_, both)| axis.as_ref().is_none_or(|(_, alone)| *both > SECOND_AXIS_GAIN * alone));
    let most = pair.or(axis);
    most.filter(|(_, share)| *share > PRACTICAL_SHARE)
}

/// Why no region is named where the model fails, in a sentence of its own. `maps` is what was looked at.
pub fn nowhere(verdict: Verdict, maps: &Maps, regions: &[Region], fit: &Fit) -> String {
    match verdict {
        Verdict::Adequate => String::new(),
        _ if !regions.is_empty() => String::new(),
        Verdict::UnexplainedStructure => {
            format!(" It is spread: no part of an axis stands out for sure{}.", maps.nowhere(&fit.unit))
        }
        _ => format!(" No part of an axis stands out for sure{}.", maps.nowhere(&fit.unit)),
    }
}

/// Why a verdict decides nothing, and the sentence that says so.
pub struct Undecided {
    pub reason: UndecidedReason,
    pub said: String,
}

/// Why the verdict decides nothing: columns that contradict each other carry none, too short a run cannot find fault with a
/// model, or a size contradicts physics in all of the fits.
pub fn undecided(found: &Findings, fits: &[&Fit], verdict: Verdict, options: &Options) -> Option<Undecided> {
    let blocks = found.start.main.problem.blocks;
    // The smallest p-value that flipping the signs of so many blocks can give.
    let smallest = 0.5f64.powi(blocks.saturating_sub(1).min(60) as i32);
    let (reason, said) = match verdict {
        _ if !found.start.prepared.clashes.is_empty() => {
            (UndecidedReason::ContradictoryColumns, "its columns contradict each other".to_owned())
        }
        Verdict::Adequate if smallest > options.alpha => (
            UndecidedReason::TooFewBlocks,
            format!("{blocks} independent stretches of motion are too few to name anything"),
        ),
        Verdict::Adequate if found.floor.rms.is_none() => (UndecidedReason::NoNoiseFloor, found.floor.source.clone()),
        Verdict::Adequate if found.exceeds_floor() && !found.is_negligible() => (
            UndecidedReason::NoNoiseFloor,
            "a few moments hold nearly all that its repeats differ by, so how well it repeats itself is not known"
                .into(),
        ),
        Verdict::Adequate | Verdict::MissingEffect => (UndecidedReason::ImpossibleParameter, impossible(fits)?),
        Verdict::UnexplainedStructure => return None,
    };
    Some(Undecided { reason, said })
}

/// A size that contradicts physics in all of the fits: beside a curve that came in for it, what is left of a line may well turn.
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
    Some(format!("{} of {} is {}, which {note}", p.name, p.effect, figure(p.value, &p.unit)))
}

/// What is said of structure, where something that was left out might be it.
fn unexplained(found: &Findings) -> &'static str {
    let is_refused = found.decided.as_ref().is_some_and(|decided| !decided.refused.is_empty());
    match left_out(found).next().is_some() || is_refused {
        true => "no effect of the library is sure to explain",
        false => "no effect of the library explains",
    }
}

/// Effects that would bring something, and whose size the run does not decide.
fn left_out<'f, 'p>(found: &'f Findings<'p>) -> impl Iterator<Item = &'f Withdrawn<'p>> {
    let bound = TOLD_LOSS * found.end_held_out_rms;
    found.withdrawn.iter().filter(move |w| w.why == RemovalReason::Unidentified && w.held_out_rms < bound)
}

/// Effects that came in and were taken back, and what that cost.
fn taken_back(found: &Findings, unit: &str) -> String {
    // What could stand in the place of an effect of the model is named there.
    let open: Vec<&Withdrawn> = left_out(found).filter(|w| !found.is_rival(w.effect)).collect();
    let back = |why: RemovalReason| -> Vec<&str> {
        let taken = found.withdrawn.iter().filter(|w| w.why == why && !found.is_rival(w.effect));
        taken.map(|w| w.effect).rev().collect()
    };
    let (half, borrowing) = (back(RemovalReason::PartialExplanation), back(RemovalReason::Spurious));
    let named: Vec<&str> = open.iter().map(|w| w.effect).rev().collect();
    let with = open.iter().map(|w| w.held_out_rms).fold(f64::INFINITY, f64::min);
    let open = (!open.is_empty()).then(|| {
        let (object, are) = if open.len() > 1 { ("the best of them", "they are") } else { ("it", "it is") };
        format!(
            " Left out: {}. With {object} the held-out error would be {} instead of {}, but this run does not decide \
             how large {are}.",
            list(&named),
            figure(with, unit),
            figure(found.end_held_out_rms, unit)
        )
    });
    let half = (!half.is_empty()).then(|| {
        let (explains, own) =
            if half.len() > 1 { ("they explain", "their own axes") } else { ("it explains", "its own axis") };
        format!(" Taken back: {}, because {explains} only a part of what shows over {own}.", list(&half))
    });
    let borrowing = (!borrowing.is_empty()).then(|| {
        let explains = if borrowing.len() > 1 { "they explain" } else { "it explains" };
        format!(" Taken back: {}, because {explains} nothing beside the structure that remains.", list(&borrowing))
    });
    let refused = found.decided.iter().flat_map(|decided| &decided.refused).filter(|r| !found.is_rival(r.effect));
    let refused = refused.map(|refused| format!(" Left out: {}: {}.", refused.effect, refused.why()));
    open.into_iter().chain(half).chain(borrowing).chain(refused).collect()
}
