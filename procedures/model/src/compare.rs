//! Comparison of two revisions of a model.

use crate::fit::evaluate;
use crate::report::comparison::{Comparison, ParameterPair, WiderInterval};
use crate::report::fit::{Fit, Parameter};
use crate::thresholds::{FEWER_ROWS, WIDER_INTERVAL};
use crate::{ModelError, words};
use jointbench_instrument::RunTable;

/// Effects that only one of the models has, their parameters in pairs, and the errors of both on one run.
///
/// Two values differ if their distance exceeds the combined half intervals, √(a² + b²). Two fits to the same run
/// share their noise, so that the test is conservative there.
pub fn compare(first: &Fit, second: &Fit, run: &RunTable) -> Result<Comparison, ModelError> {
    if first.kind != second.kind {
        return Err(ModelError::OtherKind { first: first.kind, second: second.kind });
    }
    let without = |these: &Fit, those: &Fit| {
        these.effects.iter().filter(|e| !those.effects.contains(e)).cloned().collect::<Vec<String>>()
    };
    let same = |a: &&Parameter, b: &&Parameter| a.effect == b.effect && a.name == b.name;
    let mut parameters: Vec<ParameterPair> =
        first.parameters.iter().map(|a| pair(Some(a), second.parameters.iter().find(|b| same(b, &a)))).collect();
    for pair in &mut parameters {
        pair.wider = wider([first, second], pair);
    }
    let new = second.parameters.iter().filter(|b| !first.parameters.iter().any(|a| same(&a, b)));
    parameters.extend(new.map(|b| pair(None, Some(b))));
    Ok(Comparison {
        kind: first.kind,
        added: without(second, first),
        removed: without(first, second),
        parameters,
        first: evaluate(first, run)?,
        second: evaluate(second, run)?,
        first_validation_rms: first.validation_rms,
        second_validation_rms: second.validation_rms,
    })
}

fn pair(first: Option<&Parameter>, second: Option<&Parameter>) -> ParameterPair {
    let differ = first.zip(second).and_then(|(a, b)| {
        let reach = |p: &Parameter, up: bool| if up { p.ci95[1] - p.value } else { p.value - p.ci95[0] };
        // The facing sides of both intervals.
        let room = reach(a, b.value > a.value).hypot(reach(b, b.value <= a.value));
        (room.is_finite() && room > 0.0).then(|| (a.value - b.value).abs() > room)
    });
    let (effect, name, unit) = match (first, second) {
        (Some(p), _) | (None, Some(p)) => (p.effect.clone(), p.name.clone(), p.unit.clone()),
        (None, None) => Default::default(),
    };
    ParameterPair { effect, name, unit, first: first.cloned(), second: second.cloned(), differ, wider: None }
}

fn wider(fits: [&Fit; 2], pair: &ParameterPair) -> Option<WiderInterval> {
    let width = |p: &Parameter| p.ci95[1] - p.ci95[0];
    let times = width(pair.second.as_ref()?) / width(pair.first.as_ref()?);
    if !times.is_finite() || times <= 0.0 {
        return None;
    }
    let (second, times) = (times > 1.0, times.max(1.0 / times));
    let (wide, narrow) = (fits[usize::from(second)], fits[usize::from(!second)]);
    (times > WIDER_INTERVAL).then(|| WiderInterval { second, times, why: why_wider(wide, narrow, pair) })
}

/// The first reason that the fits themselves give.
fn why_wider(wide: &Fit, narrow: &Fit, pair: &ParameterPair) -> String {
    let me = format!("{}.{}", pair.effect, pair.name);
    let partners = |fit: &Fit| -> Vec<(String, f64)> {
        let mine = fit.trade_offs.iter().filter(|one| one.first == me || one.second == me);
        mine.map(|one| (if one.first == me { &one.second } else { &one.first }.clone(), one.correlation)).collect()
    };
    let before = partners(narrow);
    let new = partners(wide).into_iter().filter(|(other, _)| before.iter().all(|(one, _)| one != other));
    if let Some((other, correlation)) = new.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs())) {
        let (effect, name) = other.split_once('.').unwrap_or((&other, ""));
        let added = if narrow.effects.iter().any(|one| one == effect) { "" } else { "the added effect " };
        return format!(
            "it trades off with {added}{} ({name}, correlation {correlation:.2})",
            effect.replace('_', " ")
        );
    }
    let rows = [wide, narrow].map(|fit| fit.preparation.rows);
    if (rows[0] as f64) < FEWER_ROWS * rows[1] as f64 {
        return format!("fewer samples, {} rows of the fit instead of {}", rows[0], rows[1]);
    }
    if narrow.rms < FEWER_ROWS * wide.rms {
        let [more, less] = [wide, narrow].map(|fit| words::figure(fit.rms, &fit.unit));
        return format!("more is left unexplained, {more} instead of {less}");
    }
    let added = wide.effects.iter().filter(|effect| !narrow.effects.contains(effect));
    let added: Vec<String> = added.map(|effect| effect.replace('_', " ")).collect();
    if !added.is_empty() {
        return format!("with {} the same samples determine more parameters", added.join(" and "));
    }
    "segments and repeats agree less on it".to_owned()
}
