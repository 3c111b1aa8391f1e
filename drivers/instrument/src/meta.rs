//! The facts about a set-up that travel beside a run table (`meta.json`).

use serde::{Deserialize, Serialize};
use std::fmt;

/// What a run table measures, which decides what a model predicts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// Motor torque k_m·i_q of a moving joint [Nm].
    Friction,
    /// Wrapped difference of two encoders [rad].
    Encoder,
    /// Torsion between motor and link [rad].
    Stiffness,
    /// Torque of a hysteresis brake against its current [Nm].
    Brake,
}

impl Kind {
    pub const ALL: [Kind; 4] = [Kind::Friction, Kind::Encoder, Kind::Stiffness, Kind::Brake];

    pub fn name(self) -> &'static str {
        match self {
            Kind::Friction => "friction",
            Kind::Encoder => "encoder",
            Kind::Stiffness => "stiffness",
            Kind::Brake => "brake",
        }
    }

    /// Columns without which a run table of this kind is refused. The first is always the time.
    pub fn required_columns(self) -> &'static [&'static str] {
        match self {
            Kind::Friction => &["time_s", "motor_position_rad", "motor_current_a"],
            Kind::Encoder => &["time_s", "reference_position_rad", "test_position_rad"],
            Kind::Stiffness => &["time_s", "motor_position_rad", "link_position_rad", "link_torque_nm"],
            Kind::Brake => &["time_s", "brake_current_a", "brake_torque_nm"],
        }
    }

    /// Columns that the models know beside the required ones. Any other column is kept and offered as an axis.
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

    /// The unit of what a model of this kind predicts.
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

/// Whether the axis turns or slides. A linear axis reads m for rad, N for Nm and kg for kg·m² in every label.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Motion {
    #[default]
    Rotary,
    Linear,
}

impl Motion {
    pub fn label(self, unit: &str) -> String {
        match self {
            Motion::Rotary => unit.to_owned(),
            Motion::Linear => crate::units::linear_unit(unit),
        }
    }
}

/// Facts about the set-up. Fields that a kind does not need stay empty; unknown ones are kept in `other`.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Meta {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub kind: Option<Kind>,
    #[serde(skip_serializing_if = "is_rotary")]
    pub motion: Motion,
    /// Effects of the model to start from (ids).
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub baseline: Vec<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sample_rate_hz: Option<f64>,
    /// k_m: motor torque for each ampere of i_q.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub torque_constant_nm_per_a: Option<f64>,
    /// N: motor turns for each link turn.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gear_ratio: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rotor_inertia_kg_m2: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bearing_stiffness_nm_per_rad: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reference_bits: Option<u32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub test_bits: Option<u32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pole_pairs: Option<u32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rated_current_a: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub poles: Option<u32>,
    #[serde(flatten)]
    pub other: serde_json::Map<String, serde_json::Value>,
}

fn is_rotary(motion: &Motion) -> bool {
    *motion == Motion::Rotary
}

#[cfg(test)]
mod tests {
    use super::*;

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
