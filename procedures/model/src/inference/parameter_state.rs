//! The state of a parameter, derived from its interval.

use crate::effect::{Shape, ShapeSearch};
use crate::report::fit::{Parameter, ParameterState, TradeOff};
use crate::thresholds::WIDE_INTERVAL;
use crate::words::figure;

/// Parameters of a fit with their intervals and trade-offs.
pub struct Intervals {
    pub parameters: Vec<Parameter>,
    pub trade_offs: Vec<TradeOff>,
}

/// One parameter of the linearised model.
pub struct Slot<'a> {
    pub effect: &'a str,
    pub name: &'a str,
    pub unit: String,
    pub value: f64,
    /// Physical bounds of a coefficient.
    pub possible: (f64, f64),
    /// `None` for a coefficient.
    pub shape: Option<Shape<'a>>,
}

const INCLUDES_ZERO: &str = "not identified by this run: its interval includes zero";

/// A coefficient that is significantly smaller than another one of its effect is identified, even if its interval includes zero:
/// it is the phase of a wave, or a coefficient of a curve.
pub fn know_the_small(parameters: &mut [Parameter]) {
    let known: Vec<(String, String, f64)> = parameters
        .iter()
        .filter(|p| p.state == ParameterState::Ok)
        .map(|p| (p.effect.clone(), p.unit.clone(), p.value.abs()))
        .collect();
    for p in parameters.iter_mut().filter(|p| p.note.as_deref() == Some(INCLUDES_ZERO)) {
        let reach = p.ci95[0].abs().max(p.ci95[1].abs());
        if known.iter().any(|(effect, unit, size)| *effect == p.effect && *unit == p.unit && reach < *size) {
            (p.state, p.note) = (ParameterState::Ok, None);
        }
    }
}

/// State of a nonlinear parameter at an end of its searched range.
pub fn at_end(range: [f64; 2], unit: &str) -> (ParameterState, Option<String>) {
    let [min, max] = range.map(|end| figure(end, unit));
    (ParameterState::AtBound, Some(format!("at the end of the searched range, {min} to {max}")))
}

/// State of a parameter, with a note if it is not well determined.
pub fn judge(slot: &Slot, ci95: [f64; 2], dead: bool) -> (ParameterState, Option<String>) {
    let nothing =
        || (ParameterState::Unidentified, Some("not identified by this run: its data does not depend on it".into()));
    let say = |value: f64| figure(value, &slot.unit);
    let Some(shape) = slot.shape else {
        let (least, most) = slot.possible;
        if dead {
            return nothing();
        }
        if ci95[0] < 0.0 && ci95[1] > 0.0 {
            return (ParameterState::Unidentified, Some(INCLUDES_ZERO.into()));
        }
        if ci95[1] < least || ci95[0] > most {
            let possible = match (least.is_finite(), most.is_finite()) {
                (true, true) => format!("{} to {}", say(least), say(most)),
                (true, false) => format!("at least {}", say(least)),
                _ => format!("at most {}", say(most)),
            };
            let cure = "another effect is missing, another term of the model takes its part, or a column has the wrong sign or unit";
            return (ParameterState::Impossible, Some(format!("is outside its physical range ({possible}): {cure}")));
        }
        return (ParameterState::Ok, None);
    };
    let (min, max) = (shape.min, shape.max);
    if shape.is_edge(slot.value) {
        return at_end([min, max], &slot.unit);
    }
    if dead {
        return nothing();
    }
    let wide = shape.search == ShapeSearch::Smooth && ci95[1] > WIDE_INTERVAL * ci95[0].abs();
    if wide || (shape.is_at(ci95[0], min) && shape.is_at(ci95[1], max)) {
        let words = format!("not identified by this run: anything from {} to {} fits", say(ci95[0]), say(ci95[1]));
        return (ParameterState::Unidentified, Some(words));
    }
    (ParameterState::Ok, None)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_small_coefficient_of_an_effect_with_a_large_one_is_identified() {
        let coefficient = |effect: &str, value: f64, ci95: [f64; 2]| {
            let is_zero = ci95[0] < 0.0 && ci95[1] > 0.0;
            Parameter {
                effect: effect.into(),
                name: String::new(),
                value,
                unit: "Nm".into(),
                ci95,
                state: if is_zero { ParameterState::Unidentified } else { ParameterState::Ok },
                note: is_zero.then(|| INCLUDES_ZERO.into()),
            }
        };
        let mut all = vec![
            coefficient("gravity", 1e-2, [0.9e-2, 1.1e-2]),
            coefficient("gravity", 1e-5, [-1e-4, 1.2e-4]),
            coefficient("gravity", 1e-3, [-2e-2, 2.2e-2]),
            coefficient("drift", 1e-5, [-1e-4, 1.2e-4]),
        ];
        know_the_small(&mut all);
        assert_eq!(all.iter().map(|p| p.note.is_none()).collect::<Vec<_>>(), [true, true, false, false]);
    }
}
