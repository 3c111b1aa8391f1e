//! Parameters of a procedure: the form of the dashboard, and the check of a request.

use serde::Serialize;
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;

/// Most points of a curve.
const MOST_POINTS: usize = 10_000;

/// One parameter of a procedure, in SI units.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Parameter {
    /// Key in requests, files and `--set`; ends with the unit where one applies.
    pub name: &'static str,
    /// Label of the form.
    pub title: &'static str,
    /// SI symbol; empty for a fraction or a count.
    pub unit: &'static str,
    /// Value if none is given; a curve is empty then.
    pub default: f64,
    /// Lowest allowed value.
    pub min: f64,
    /// Highest allowed value.
    pub max: f64,
    /// A number, a whole number or a curve.
    #[serde(rename = "type")]
    pub kind: ParameterKind,
}

/// Type of a parameter's value.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ParameterKind {
    /// Any number in the range.
    Number,
    /// A whole number in the range.
    Integer,
    /// A number relative to a rated or to a whole value. Files and requests have the fraction, pages show percent.
    Fraction,
    /// Set-points that a user brings: pairs of a time in s, from 0 and rising, and a value in the range. Between the points
    /// are straight lines.
    Curve,
}

impl Parameter {
    /// A quantity within `[min, max]`.
    pub const fn number(
        name: &'static str,
        title: &'static str,
        unit: &'static str,
        default: f64,
        [min, max]: [f64; 2],
    ) -> Self {
        Self { name, title, unit, default, min, max, kind: ParameterKind::Number }
    }

    /// A fraction of a rated or of a whole value within `[min, max]`.
    pub const fn fraction(name: &'static str, title: &'static str, default: f64, [min, max]: [f64; 2]) -> Self {
        Self { name, title, unit: "", default, min, max, kind: ParameterKind::Fraction }
    }

    /// An integer within `[min, max]`.
    pub const fn count(name: &'static str, title: &'static str, default: u32, [min, max]: [u32; 2]) -> Self {
        let kind = ParameterKind::Integer;
        Self { name, title, unit: "", default: default as f64, min: min as f64, max: max as f64, kind }
    }

    /// A curve over time with values within `[min, max]`.
    pub const fn curve(name: &'static str, title: &'static str, unit: &'static str, [min, max]: [f64; 2]) -> Self {
        Self { name, title, unit, default: 0.0, min, max, kind: ParameterKind::Curve }
    }

    /// A value for people: `2 rad/s`, `0.07 (7 %)`.
    #[must_use]
    pub fn text(&self, value: f64) -> String {
        match self.kind {
            ParameterKind::Fraction => format!("{value} ({} %)", percent(value)),
            _ => format!("{value} {}", self.unit).trim_end().to_owned(),
        }
    }

    fn setting(&self, given: Option<&Value>) -> Result<Setting, ParameterFault> {
        match (self.kind, given) {
            (ParameterKind::Curve, given) => self.check_curve(given).map(Setting::Curve),
            (_, None) => Ok(Setting::Number(self.default)),
            (_, Some(given)) => self.check(given).map(Setting::Number),
        }
    }

    fn check(&self, given: &Value) -> Result<f64, ParameterFault> {
        let is_whole = self.kind == ParameterKind::Integer;
        let fault = || ParameterFault::OutOfRange {
            name: self.name,
            given: given.to_string(),
            kind: if is_whole { "a whole number" } else { "a number" },
            range: self.range(),
        };
        let value = given.as_f64().ok_or_else(fault)?;
        let fits = !is_whole || value.fract() == 0.0;
        if fits && (self.min..=self.max).contains(&value) { Ok(value) } else { Err(fault()) }
    }

    fn check_curve(&self, given: Option<&Value>) -> Result<Vec<[f64; 2]>, ParameterFault> {
        let fault = |what: String| ParameterFault::Curve { name: self.name, what };
        let Some(given) = given else { return Ok(Vec::new()) };
        let form = || fault("expected a list of pairs [time in s, value]".into());
        let points: Vec<[f64; 2]> = serde_json::from_value(given.clone()).map_err(|_| form())?;
        if points.len() > MOST_POINTS {
            return Err(fault(format!("{} points: at most {MOST_POINTS} are expected", points.len())));
        }
        if points.first().is_some_and(|[t_s, _]| *t_s != 0.0) {
            return Err(fault("the time begins at 0 s".into()));
        }
        if let Some(pair) = points.windows(2).find(|pair| pair[1][0] <= pair[0][0]) {
            return Err(fault(format!(
                "the time rises from point to point; {} s follows {} s",
                pair[1][0], pair[0][0]
            )));
        }
        match points.iter().find(|[_, value]| !(self.min..=self.max).contains(value)) {
            Some([t_s, value]) => Err(fault(format!("{value} at {t_s} s: expected {}", self.range()))),
            None => Ok(points),
        }
    }

    fn range(&self) -> String {
        format!("{} to {} {}", self.min, self.max, self.unit).trim_end().to_owned()
    }
}

/// A fraction in percent, without the rounding of the multiplication: 0.07 is 7.
fn percent(fraction: f64) -> f64 {
    (1e12 * fraction).round() / 1e10
}

/// Why a parameter is rejected.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ParameterFault {
    /// The value has the wrong type, or is out of its range.
    #[error("parameter {name} = {given}: expected {kind} from {range}")]
    OutOfRange {
        /// Name of the parameter.
        name: &'static str,
        /// Given value, as JSON.
        given: String,
        /// Expected type, in words.
        kind: &'static str,
        /// Lowest and highest value with the unit.
        range: String,
    },
    /// The points of a curve are no set-points over time.
    #[error("parameter {name}: {what}")]
    Curve {
        /// Name of the parameter.
        name: &'static str,
        /// The fault, with place and expectation.
        what: String,
    },
    /// The procedure has no such parameter.
    #[error("unknown parameter {name}: expected one of {}", .known.join(", "))]
    Unknown {
        /// Given name.
        name: String,
        /// Names of the parameters of the procedure.
        known: Vec<&'static str>,
    },
}

/// Checked values: every parameter of the schema is present and within its range.
#[derive(Debug, Clone, PartialEq)]
pub struct Values(BTreeMap<&'static str, Setting>);

#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
enum Setting {
    Number(f64),
    Curve(Vec<[f64; 2]>),
}

impl Values {
    /// Adds the defaults and checks the given values.
    pub fn parse(schema: &[Parameter], given: &Map<String, Value>) -> Result<Self, ParameterFault> {
        if let Some(name) = given.keys().find(|name| schema.iter().all(|p| p.name != *name)) {
            let known = schema.iter().map(|p| p.name).collect();
            return Err(ParameterFault::Unknown { name: name.clone(), known });
        }
        let setting = |p: &Parameter| p.setting(given.get(p.name)).map(|setting| (p.name, setting));
        Ok(Self(schema.iter().map(setting).collect::<Result<_, _>>()?))
    }

    /// # Panics
    /// If the schema has no such number: a programming error of the procedure.
    pub fn number(&self, name: &str) -> f64 {
        match &self.0[name] {
            Setting::Number(value) => *value,
            Setting::Curve(_) => panic!("parameter {name} is a curve"),
        }
    }

    /// # Panics
    /// If the schema has no such number: a programming error of the procedure.
    pub fn count(&self, name: &str) -> u32 {
        self.number(name) as u32
    }

    /// The points of a curve: time in s and value. Empty if none was given.
    ///
    /// # Panics
    /// If the schema has no such curve: a programming error of the procedure.
    pub fn curve(&self, name: &str) -> &[[f64; 2]] {
        match &self.0[name] {
            Setting::Curve(points) => points,
            Setting::Number(_) => panic!("parameter {name} is a number"),
        }
    }

    /// For the run's provenance: the values used, including defaults.
    pub fn to_json(&self) -> Map<String, Value> {
        self.0.iter().map(|(name, setting)| ((*name).to_owned(), json!(setting))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCHEMA: [Parameter; 3] = [
        Parameter::number("top_speed_rad_s", "Highest motor speed", "rad/s", 180.0, [1.0, 1000.0]),
        Parameter::count("repeats", "Repeats of the profile", 2, [2, 20]),
        Parameter::curve("reference", "Reference", "rad/s", [-2.0, 2.0]),
    ];

    fn parse(text: &str) -> Result<Values, String> {
        Values::parse(&SCHEMA, &serde_json::from_str(text).unwrap()).map_err(|fault| fault.to_string())
    }

    #[test]
    fn defaults_fill_what_is_not_given() {
        let values = parse(r#"{"repeats": 3}"#).unwrap();
        assert_eq!((values.number("top_speed_rad_s"), values.count("repeats")), (180.0, 3));
        assert!(values.curve("reference").is_empty());
    }

    #[test]
    fn a_fraction_is_read_in_percent() {
        let load = Parameter::fraction("top_load", "Maximum brake current, relative to rated", 0.8, [0.05, 1.0]);
        assert_eq!(load.text(0.07), "0.07 (7 %)");
        assert_eq!(load.text(0.125), "0.125 (12.5 %)");
        assert_eq!(SCHEMA[0].text(180.0), "180 rad/s");
        assert_eq!(SCHEMA[1].text(3.0), "3");
    }

    #[test]
    fn a_curve_is_kept_as_it_is_given() {
        let values = parse(r#"{"reference": [[0, 0], [0.5, 2], [1.5, -0.25]]}"#).unwrap();
        assert_eq!(values.curve("reference"), [[0.0, 0.0], [0.5, 2.0], [1.5, -0.25]]);
        assert_eq!(Values::parse(&SCHEMA, &values.to_json()).unwrap(), values);
        for (given, message) in [
            ("[0, 1]", "parameter reference: expected a list of pairs [time in s, value]"),
            ("\"fast\"", "parameter reference: expected a list of pairs [time in s, value]"),
            ("[[0.1, 0]]", "parameter reference: the time begins at 0 s"),
            ("[[0, 0], [1, 0], [1, 1]]", "parameter reference: the time rises from point to point; 1 s follows 1 s"),
            ("[[0, 0], [1, 3]]", "parameter reference: 3 at 1 s: expected -2 to 2 rad/s"),
        ] {
            assert_eq!(parse(&format!(r#"{{"reference": {given}}}"#)).unwrap_err(), message);
        }
    }

    #[test]
    fn a_refusal_names_parameter_value_and_range() {
        for (given, message) in [
            (r#"{"repeats": 2.5}"#, "parameter repeats = 2.5: expected a whole number from 2 to 20"),
            (
                r#"{"top_speed_rad_s": 2000}"#,
                "parameter top_speed_rad_s = 2000: expected a number from 1 to 1000 rad/s",
            ),
            (
                r#"{"top_speed_rad_s": "fast"}"#,
                "parameter top_speed_rad_s = \"fast\": expected a number from 1 to 1000 rad/s",
            ),
            (r#"{"speed": 1}"#, "unknown parameter speed: expected one of top_speed_rad_s, repeats, reference"),
        ] {
            assert_eq!(parse(given).unwrap_err(), message);
        }
    }
}
