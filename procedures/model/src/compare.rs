//! Two revisions of a model side by side.

use crate::ModelError;
use crate::fit::evaluate;
use crate::report::{Comparison, Fit, Parameter, ParameterPair};
use jointbench_instrument::RunTable;

/// What the second model has that the first has not, and the other way round, parameter by parameter, and the error of
/// both on one run.
///
/// Two values differ where they are further apart than both half intervals together allow, √(a² + b²). The intervals of
/// two fits to the same run share their noise, so there the question is asked too strictly, never too easily.
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
        // The sides of the intervals that face each other.
        let room = reach(a, b.value > a.value).hypot(reach(b, b.value <= a.value));
        (room.is_finite() && room > 0.0).then(|| (a.value - b.value).abs() > room)
    });
    let (effect, name, unit) = match (first, second) {
        (Some(p), _) | (None, Some(p)) => (p.effect.clone(), p.name.clone(), p.unit.clone()),
        (None, None) => Default::default(),
    };
    ParameterPair { effect, name, unit, first: first.cloned(), second: second.cloned(), differ }
}
