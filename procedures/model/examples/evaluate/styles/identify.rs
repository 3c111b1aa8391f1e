//! Identifiability of hidden effects in the data of a run, given the truth.

use super::answer::Answer;
use super::least_squares::regression;
use super::recording::{Part, Recording};
use std::collections::{BTreeMap, BTreeSet};

/// Standard errors from which on an effect is identifiable.
const IDENTIFIABLE: f64 = 6.0;
/// Standard errors from which on an alternative is distinguished from an effect.
const DISTINGUISHED: f64 = 3.0;

pub fn answer(recording: &Recording) -> Answer {
    let sigma: BTreeMap<&str, f64> = recording.hidden.iter().map(|h| (h.id, size(recording, h, None))).collect();
    let outside = recording.outside.as_ref().map(|o| size(recording, o, None));
    let acceptable = recording.hidden.iter().map(|h| (h.id.to_owned(), alike(recording, h))).collect();
    let category = match (&recording.outside, recording.hidden.len()) {
        (Some(_), _) => "unknown",
        (None, 0) => "null",
        (None, 1) => "one",
        (None, _) => "two",
    };
    let verdict = if recording.outside.is_some() { "unexplained_structure" } else { "adequate" };
    let owned = |ids: &[&str]| ids.iter().map(|id| (*id).to_owned()).collect();
    Answer {
        kind: recording.meta.kind.map(|k| k.to_string()).unwrap_or_default(),
        category: category.into(),
        style: recording.style.into(),
        hidden: recording.hidden.iter().map(|h| h.id.to_owned()).collect(),
        outside: recording.outside.as_ref().map(|o| o.id.to_owned()),
        acceptable,
        optional: owned(&recording.optional),
        identifiable: sigma.values().chain(&outside).all(|s| *s >= IDENTIFIABLE),
        verdict: verdict.into(),
        truth: recording.truth.clone(),
        sigma: sigma.into_iter().map(|(id, s)| (id.to_owned(), s)).collect(),
        facts: recording.facts.clone(),
    }
}

/// Standard errors of a part, given all other present parts and an alternative.
fn size(recording: &Recording, part: &Part, alternative: Option<&Part>) -> f64 {
    let others = recording.base.iter().chain(&recording.hidden).chain(&recording.outside);
    let others = others.filter(|o| !std::ptr::eq(*o, part)).chain(alternative);
    let columns: Vec<&[f64]> = std::iter::once(part)
        .chain(others)
        .map(|p| p.values.as_slice())
        .filter(|v| v.iter().any(|x| *x != 0.0))
        .collect();
    if part.values.iter().all(|v| *v == 0.0) {
        return 0.0;
    }
    regression(&columns, &recording.response).map_or(0.0, |r| (r.coefficients[0] / r.errors[0]).abs())
}

/// Ids that this data cannot distinguish from a hidden effect, itself first.
fn alike(recording: &Recording, part: &Part) -> Vec<String> {
    let absent =
        |r: &&Part| r.id != part.id && recording.base.iter().chain(&recording.hidden).all(|there| there.id != r.id);
    let alternatives = recording.alternatives.iter().filter(absent);
    let ids: BTreeSet<&str> = alternatives
        .filter(|alternative| size(recording, part, Some(alternative)) < DISTINGUISHED)
        .map(|alternative| alternative.id)
        .collect();
    std::iter::once(part.id).chain(ids).map(str::to_owned).collect()
}
