//! The facts about a set-up that accompany a run table (`meta.json`).

use crate::spelling::nearest;
use crate::units::quantity_of;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use std::fmt;

/// The measurement of a run table. It determines the prediction of a model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// Motor torque k_m·i_q of a moving joint (Nm).
    Friction,
    /// Wrapped difference of two encoders (rad).
    Encoder,
    /// Torsion between motor and link (rad).
    Stiffness,
    /// Torque of a hysteresis brake over its current (Nm).
    Brake,
}

impl Kind {
    /// Every kind, in the order of the documentation.
    pub const ALL: [Kind; 4] = [Kind::Friction, Kind::Encoder, Kind::Stiffness, Kind::Brake];

    /// Its name in files and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Kind::Friction => "friction",
            Kind::Encoder => "encoder",
            Kind::Stiffness => "stiffness",
            Kind::Brake => "brake",
        }
    }

    /// Columns that a run table of this kind must have. The first is always the time.
    pub fn required_columns(self) -> &'static [&'static str] {
        match self {
            Kind::Friction => &["time_s", "motor_position_rad", "motor_current_a"],
            Kind::Encoder => &["time_s", "reference_position_rad", "test_position_rad"],
            Kind::Stiffness => &["time_s", "motor_position_rad", "link_position_rad", "link_torque_nm"],
            Kind::Brake => &["time_s", "brake_current_a", "brake_torque_nm"],
        }
    }

    /// Further columns that the models use. Any other column is kept and offered as an axis.
    pub fn optional_columns(self) -> &'static [&'static str] {
        match self {
            Kind::Friction => &[
                "motor_velocity_rad_s",
                "link_position_rad",
                "link_torque_nm",
                "temperature_c",
                "brake_current_a",
                "brake_torque_command_nm",
                "segment",
                "repeat",
            ],
            Kind::Encoder => &["velocity_rad_s", "temperature_c", "segment", "repeat"],
            Kind::Stiffness => &["link_velocity_rad_s", "temperature_c", "segment", "repeat"],
            Kind::Brake => &["velocity_rad_s", "position_rad", "temperature_c", "segment", "repeat"],
        }
    }

    /// The unit of the quantity that a model of this kind predicts.
    pub fn target_unit(self) -> &'static str {
        match self {
            Kind::Friction | Kind::Brake => "Nm",
            Kind::Encoder | Kind::Stiffness => "rad",
        }
    }
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Whether the axis rotates or slides. For a linear axis, every label shows m for rad, N for Nm and kg for kg·m².
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Motion {
    /// Rotation: positions in rad, torques in Nm.
    #[default]
    Rotary,
    /// Translation: positions in m, forces in N.
    Linear,
}

impl Motion {
    /// The unit in which a value of `unit` (rotary) is shown on this axis.
    pub fn label(self, unit: &str) -> String {
        match self {
            Motion::Rotary => unit.to_owned(),
            Motion::Linear => crate::units::linear_unit(unit),
        }
    }
}

/// The JSON that a fact expects.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FactShape {
    /// One word of a list.
    Word,
    /// `true` or `false`.
    Flag,
    /// Any number.
    Number,
    /// A whole number from 0 to 2³² − 1.
    WholeNumber,
    /// A list of words.
    List,
}

impl FactShape {
    /// Whether a value has this shape.
    pub fn fits(self, value: &Value) -> bool {
        match self {
            FactShape::Word => value.is_string(),
            FactShape::Flag => value.is_boolean(),
            FactShape::Number => value.is_number(),
            FactShape::WholeNumber => value.as_u64().is_some_and(|whole| u32::try_from(whole).is_ok()),
            FactShape::List => value.as_array().is_some_and(|list| list.iter().all(Value::is_string)),
        }
    }
}

/// Facts about the set-up. Facts that a kind does not need stay empty; unknown facts are kept in `other`.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Meta {
    /// Kind of run; a run table needs it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub kind: Option<Kind>,
    /// Whether the axis rotates or slides.
    #[serde(skip_serializing_if = "is_rotary")]
    pub motion: Motion,
    /// Effects of the model to start from (ids).
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub baseline: Vec<String>,
    /// Each row is the mean of one steady operating point, in any order. Time and angle only number the rows.
    #[serde(skip_serializing_if = "is_false")]
    pub operating_points: bool,
    /// Samples per second. It may differ from the time column by less than a factor of ten.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sample_rate_hz: Option<f64>,
    /// k_m: motor torque per ampere of i_q.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub torque_constant_nm_per_a: Option<f64>,
    /// N: motor turns for each link turn.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gear_ratio: Option<f64>,
    /// Moment of inertia of the motor's rotor, motor side.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rotor_inertia_kg_m2: Option<f64>,
    /// Stiffness of the joint's bearing, in series with that of the joint (`stiffness` runs).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bearing_stiffness_nm_per_rad: Option<f64>,
    /// Resolution of the reference encoder: 2^bits counts per turn.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reference_bits: Option<u32>,
    /// Resolution of the encoder under test: 2^bits counts per turn.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub test_bits: Option<u32>,
    /// Pole pairs of the ring of a magnetic encoder.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pole_pairs: Option<u32>,
    /// Rated current of the brake (A).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rated_current_a: Option<f64>,
    /// Poles of the brake's rotor.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub poles: Option<u32>,
    /// Unknown facts, kept as they are.
    #[serde(flatten)]
    pub other: Map<String, Value>,
}

impl Meta {
    /// All known facts: name, and the JSON that it expects.
    pub const FACTS: [(&str, FactShape); 14] = [
        ("kind", FactShape::Word),
        ("motion", FactShape::Word),
        ("baseline", FactShape::List),
        ("operating_points", FactShape::Flag),
        ("sample_rate_hz", FactShape::Number),
        ("torque_constant_nm_per_a", FactShape::Number),
        ("gear_ratio", FactShape::Number),
        ("rotor_inertia_kg_m2", FactShape::Number),
        ("bearing_stiffness_nm_per_rad", FactShape::Number),
        ("reference_bits", FactShape::WholeNumber),
        ("test_bits", FactShape::WholeNumber),
        ("pole_pairs", FactShape::WholeNumber),
        ("rated_current_a", FactShape::Number),
        ("poles", FactShape::WholeNumber),
    ];

    /// An unknown fact whose name is similar to a known fact that is missing, with that known name. It is probably
    /// misspelt or in another unit.
    pub fn misspelt(&self) -> Option<(&str, &'static str)> {
        let given = serde_json::to_value(self).unwrap_or_default();
        let missing: Vec<&'static str> =
            Self::FACTS.into_iter().map(|(fact, _)| fact).filter(|fact| given.get(fact).is_none()).collect();
        let meant = |name: &str| {
            // The same quantity without a unit or in another unit.
            let same = |fact: &&str| quantity_of(fact).is_some_and(|q| q == name || Some(q) == quantity_of(name));
            nearest(name, missing.iter().copied()).or_else(|| missing.iter().copied().find(same))
        };
        self.other.keys().find_map(|name| Some((name.as_str(), meant(name)?)))
    }
}

fn is_false(value: &bool) -> bool {
    !value
}

fn is_rotary(motion: &Motion) -> bool {
    *motion == Motion::Rotary
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_misspelt_fact_is_distinguished_from_a_fact_of_the_user() {
        let misspelt = |text: &str| {
            let meta: Meta = serde_json::from_str(text).unwrap();
            meta.misspelt().map(|(found, meant)| (found.to_owned(), meant))
        };
        let meant = |found: &str, meant| Some((found.to_owned(), meant));
        assert_eq!(misspelt(r#"{"gear_ratoi": 50}"#), meant("gear_ratoi", "gear_ratio"));
        assert_eq!(misspelt(r#"{"sample_rate": 50}"#), meant("sample_rate", "sample_rate_hz"));
        assert_eq!(misspelt(r#"{"pole": 50}"#), meant("pole", "poles"));
        assert_eq!(misspelt(r#"{"note": "dry", "oil": "x", "rated_torque_nm": 13}"#), None);
        assert_eq!(misspelt(r#"{"gear_ratio": 50, "gear_ratio_2": 3}"#), None, "the known one is there");
        let all: Vec<String> = Meta::FACTS.iter().map(|(fact, _)| format!("\"{fact}\": null")).collect();
        assert!(serde_json::from_str::<Meta>(&format!("{{{}}}", all[4..].join(","))).unwrap().other.is_empty());
    }

    #[test]
    fn unknown_facts_survive_a_round_trip() {
        let text = r#"{"kind":"friction","motion":"linear","baseline":["coulomb"],"gear_ratio":50.0,"note":"dry"}"#;
        let meta: Meta = serde_json::from_str(text).unwrap();
        assert_eq!(meta.kind, Some(Kind::Friction));
        assert_eq!(meta.other["note"], "dry");
        let again: Meta = serde_json::from_str(&serde_json::to_string(&meta).unwrap()).unwrap();
        assert_eq!(again, meta);
    }
}
