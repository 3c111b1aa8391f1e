//! Which run would decide a limit that a result leaves open.
//!
//! The half width of an interval falls with the square root of the number of independent repeats. To reach a fraction
//! `f` of its present width it needs `1 / f²` as many. This holds if the whole interval is scatter between repeats. A
//! part that is common to all repeats, such as a calibration or a joint that is not warm, does not fall. A result does
//! not state this part, so the advice is a lower bound; a broken precondition is known, and then there is none.

use crate::view::{DecidedBy, Identified, LimitDecision, Shown, raised};
use jointbench_procedure::parameter::{Parameter, ParameterKind};
use jointbench_procedure::procedure;
use serde_json::{Map, Value};

/// Settings that multiply the independent data of a run, the first of a procedure counts.
const LENGTHS: [&str; 6] = ["repeats", "rounds", "breakaways", "power_ups", "histories", "duration_s"];

/// How the judged run was made.
#[derive(Debug, Clone, Copy)]
pub struct Made<'a> {
    pub procedure: &'a str,
    pub parameters: &'a Map<String, Value>,
}

impl Made<'_> {
    /// The setting for repeats or duration, with its value in this run.
    fn length(&self) -> Option<(&'static Parameter, f64)> {
        let schema = procedure(self.procedure)?.schema();
        let found = LENGTHS.iter().find_map(|name| schema.iter().find(|parameter| parameter.name == *name))?;
        let given = self.parameters.get(found.name).and_then(Value::as_f64);
        Some((found, given.unwrap_or(found.default)))
    }

    fn decision(&self, by: DecidedBy) -> LimitDecision {
        LimitDecision { by, procedure: self.procedure.to_owned(), settings: Map::new(), times: None }
    }

    /// For a quantity without an interval.
    pub fn first_interval(&self) -> LimitDecision {
        match self.length() {
            Some((parameter, 1.0)) if parameter.kind == ParameterKind::Integer => LimitDecision {
                settings: Map::from_iter([(parameter.name.to_owned(), 2.into())]),
                times: Some(2.0),
                ..self.decision(DecidedBy::LongerRun)
            },
            _ => self.decision(DecidedBy::NoInterval),
        }
    }

    /// For an interval that crosses a limit or its guard band. `distance`: of the value to that limit or guard band,
    /// `reach`: of the value to the end of its interval in this direction, both positive.
    pub fn narrower_interval(&self, result: &Shown, distance: f64, reach: f64) -> LimitDecision {
        if result.verdict == Identified::IdentifiedWithWarning {
            return self.decision(DecidedBy::Precondition);
        }
        let times = (reach / distance).powi(2);
        let needed = LimitDecision { times: times.is_finite().then_some(times), ..self.decision(DecidedBy::NoSetting) };
        match self.length() {
            _ if times > LimitDecision::MOST_TIMES => LimitDecision { by: DecidedBy::TooManyRepeats, ..needed },
            None => needed,
            Some((parameter, present)) => match longer(parameter, present * times) {
                Some(setting) => LimitDecision {
                    by: DecidedBy::LongerRun,
                    settings: Map::from_iter([(parameter.name.to_owned(), setting)]),
                    ..needed
                },
                None => LimitDecision { by: DecidedBy::TooManyRepeats, ..needed },
            },
        }
    }

    /// For a value in the guard band.
    pub fn other_value(&self) -> LimitDecision {
        self.decision(DecidedBy::OtherValue)
    }
}

/// The next allowed value of a setting. Two digits are enough for a duration.
fn longer(parameter: &Parameter, least: f64) -> Option<Value> {
    let value = match parameter.kind {
        ParameterKind::Integer => raised(least),
        _ => {
            let digit = 10f64.powf(least.log10().floor() - 1.0);
            raised(least / digit) * digit
        }
    };
    let whole = value.fract() == 0.0;
    (value <= parameter.max).then(|| if whole { Value::from(value as u64) } else { Value::from(value) })
}

#[cfg(test)]
mod tests {
    use super::super::requirement::tests::found;
    use super::*;
    use serde_json::json;

    fn decided(id: &str, parameters: &Value, distance: f64, reach: f64) -> (LimitDecision, String) {
        let made = Made { procedure: id, parameters: parameters.as_object().unwrap() };
        let decision = made.narrower_interval(&found().result, distance, reach);
        let text = decision.to_string();
        (decision, text)
    }

    #[test]
    fn half_the_width_needs_four_times_the_repeats() {
        let (decision, text) = decided("friction", &json!({"repeats": 3}), 1.0, 2.0);
        assert_eq!((decision.by, decision.times), (DecidedBy::LongerRun, Some(4.0)));
        assert_eq!(json!(decision.settings), json!({"repeats": 12}));
        assert_eq!(text, "a run of friction with repeats=12 would decide if the value stays");
        let (by_default, _) = decided("friction", &json!({}), 1.0, 2.0);
        assert_eq!(json!(by_default.settings), json!({"repeats": 8}), "the default is 2");
    }

    #[test]
    fn a_duration_replaces_repeats() {
        let (decision, text) = decided("torque_sensor_zero", &json!({"duration_s": 100.0}), 1.0, 1.5);
        assert_eq!(json!(decision.settings), json!({"duration_s": 230}), "225 s, with two digits");
        assert_eq!(text, "a run of torque_sensor_zero with duration_s=230 would decide if the value stays");
    }

    #[test]
    fn repeats_that_do_not_help_are_not_advised() {
        let (many, text) = decided("friction", &json!({"repeats": 20}), 1.0, 2.0);
        assert_eq!((many.by, many.times), (DecidedBy::TooManyRepeats, Some(4.0)), "80 repeats, at most 50");
        assert_eq!(text, "4 times as many repeats would decide, more than one run of friction permits");
        let (near, text) = decided("friction", &json!({}), 0.0, 2.0);
        assert_eq!((near.by, near.times), (DecidedBy::TooManyRepeats, None));
        assert_eq!(text, "the value is too near to the limit for any number of repeats");
        let (none, text) = decided("demagnetise", &json!({}), 1.0, 2.0);
        assert_eq!(none.by, DecidedBy::NoSetting);
        assert_eq!(text, "4 times as many repeats would decide, but demagnetise has no setting for repeats");
        let mut warned = found();
        warned.result.verdict = Identified::IdentifiedWithWarning;
        let no_parameters = Map::new();
        let made = Made { procedure: "friction", parameters: &no_parameters };
        let biased = made.narrower_interval(&warned.result, 1.0, 2.0);
        assert_eq!((biased.by, biased.settings.len()), (DecidedBy::Precondition, 0));
    }

    #[test]
    fn a_second_repeat_gives_the_first_interval() {
        let first = |id, parameters: Value| {
            Made { procedure: id, parameters: parameters.as_object().unwrap() }.first_interval()
        };
        let single = first("strokes", json!({"repeats": 1}));
        assert_eq!((single.by, json!(single.settings)), (DecidedBy::LongerRun, json!({"repeats": 2})));
        assert_eq!(first("friction", json!({"repeats": 2})).by, DecidedBy::NoInterval);
    }
}
