//! What an interval means, said plainly.

use super::Slot;
use crate::effect::Search;
use crate::report::ParameterState;
use crate::words::figure;

/// An interval of a shape parameter that is wider than this factor does not decide it.
const WIDE: f64 = 10.0;

/// How what is said of a size begins that contradicts physics, or the range that a user gave it, and certainly so.
pub const IMPOSSIBLE: &str = "lies beyond what is possible";

/// State of a parameter, with words where it is not well determined.
pub fn judge(slot: &Slot, ci95: [f64; 2], dead: bool) -> (ParameterState, Option<String>) {
    let nothing =
        || (ParameterState::Unidentified, Some("not identified by this run: it says nothing about it".into()));
    let say = |value: f64| figure(value, &slot.unit);
    let Some(shape) = slot.shape else {
        let (least, most) = slot.possible;
        if dead {
            return nothing();
        }
        if ci95[0] < 0.0 && ci95[1] > 0.0 {
            return (ParameterState::Unidentified, Some("not identified by this run: it may be zero".into()));
        }
        if slot.value < least || slot.value > most {
            let possible = match (least.is_finite(), most.is_finite()) {
                (true, true) => format!("{} to {}", say(least), say(most)),
                (true, false) => format!("at least {}", say(least)),
                _ => format!("at most {}", say(most)),
            };
            let cure = "another effect is missing, or a column has another sign or unit";
            return (ParameterState::AtBound, Some(format!("{IMPOSSIBLE}, {possible}: {cure}")));
        }
        return (ParameterState::Ok, None);
    };
    let (min, max) = (shape.min, shape.max);
    if shape.is_edge(slot.value) {
        let words = format!("lies at the edge of what this data can speak about, {} to {}", say(min), say(max));
        return (ParameterState::AtBound, Some(words));
    }
    if dead {
        return nothing();
    }
    let wide = shape.search == Search::Smooth && ci95[1] > WIDE * ci95[0].abs();
    if wide || (shape.is_at(ci95[0], min) && shape.is_at(ci95[1], max)) {
        let words = format!("not identified by this run: anything from {} to {} fits", say(ci95[0]), say(ci95[1]));
        return (ParameterState::Unidentified, Some(words));
    }
    (ParameterState::Ok, None)
}
