//! Parameters of a procedure: the form of the dashboard, and the check of a request.

use serde::Serialize;
use serde_json::{Map, Value};
use std::collections::BTreeMap;

/// One parameter of a procedure, in SI units.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Parameter {
    /// Key in requests, files and `--set`; ends with the unit where one applies.
    pub name: &'static str,
    /// Label of the form.
    pub title: &'static str,
    /// SI symbol; empty for a share or a count.
    pub unit: &'static str,
    /// Value if none is given.
    pub default: f64,
    /// Lowest allowed value.
    pub min: f64,
    /// Highest allowed value.
    pub max: f64,
    /// Whether the value must be whole.
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

    /// An integer within `[min, max]`.
    pub const fn count(name: &'static str, title: &'static str, default: u32, [min, max]: [u32; 2]) -> Self {
        let kind = ParameterKind::Integer;
        Self { name, title, unit: "", default: default as f64, min: min as f64, max: max as f64, kind }
    }

    fn check(&self, given: &Value) -> Result<f64, ParameterFault> {
        let fault = || ParameterFault::OutOfRange {
            name: self.name,
            given: given.to_string(),
            kind: match self.kind {
                ParameterKind::Number => "a number",
                ParameterKind::Integer => "a whole number",
            },
            range: format!("{} to {} {}", self.min, self.max, self.unit).trim_end().to_owned(),
        };
        let value = given.as_f64().ok_or_else(fault)?;
        let whole = self.kind == ParameterKind::Number || value.fract() == 0.0;
        if whole && (self.min..=self.max).contains(&value) { Ok(value) } else { Err(fault()) }
    }
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
pub struct Values(BTreeMap<&'static str, f64>);

impl Values {
    /// Adds the defaults and checks the given values.
    pub fn parse(schema: &[Parameter], given: &Map<String, Value>) -> Result<Self, ParameterFault> {
        if let Some(name) = given.keys().find(|name| schema.iter().all(|p| p.name != *name)) {
            let known = schema.iter().map(|p| p.name).collect();
            return Err(ParameterFault::Unknown { name: name.clone(), known });
        }
        let value = |p: &Parameter| given.get(p.name).map_or(Ok(p.default), |v| p.check(v)).map(|v| (p.name, v));
        Ok(Self(schema.iter().map(value).collect::<Result<_, _>>()?))
    }

    /// # Panics
    /// If the schema has no such parameter: a programming error of the procedure.
    pub fn number(&self, name: &str) -> f64 {
        self.0[name]
    }

    /// # Panics
    /// If the schema has no such parameter: a programming error of the procedure.
    pub fn count(&self, name: &str) -> u32 {
        self.0[name] as u32
    }

    /// For the run's provenance: the values used, including defaults.
    pub fn to_json(&self) -> Map<String, Value> {
        self.0.iter().map(|(name, value)| ((*name).to_owned(), Value::from(*value))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCHEMA: [Parameter; 2] = [
        Parameter::number("top_speed_rad_s", "Highest motor speed", "rad/s", 180.0, [1.0, 1000.0]),
        Parameter::count("repeats", "Repeats of the profile", 2, [2, 20]),
    ];

    fn parse(text: &str) -> Result<Values, String> {
        Values::parse(&SCHEMA, &serde_json::from_str(text).unwrap()).map_err(|fault| fault.to_string())
    }

    #[test]
    fn defaults_fill_what_is_not_given() {
        let values = parse(r#"{"repeats": 3}"#).unwrap();
        assert_eq!((values.number("top_speed_rad_s"), values.count("repeats")), (180.0, 3));
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
            (r#"{"speed": 1}"#, "unknown parameter speed: expected one of top_speed_rad_s, repeats"),
        ] {
            assert_eq!(parse(given).unwrap_err(), message);
        }
    }
}
