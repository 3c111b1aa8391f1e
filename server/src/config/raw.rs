//! The bench description as it is written. Values keep their place in the file, for messages.

use jointbench_devices::sim::PlannedTrouble;
use serde::Deserialize;
use toml::Spanned;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RawFile {
    #[serde(default)]
    pub bench: Vec<RawBench>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RawBench {
    pub name: Spanned<String>,
    pub mock: Option<RawMock>,
    pub joint: Option<RawJoint>,
    pub torque_sensor: Option<RawTorqueSensor>,
    pub brake: Option<RawBrake>,
    pub limits: Option<RawLimits>,
    pub constants: Option<RawConstants>,
}

/// Simulated instruments in place of all others.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RawMock {
    pub joint: Spanned<String>,
    pub load: Option<Spanned<String>>,
    pub seed: Option<u64>,
    #[serde(default)]
    pub effects: Vec<Spanned<String>>,
    pub pace: Option<Spanned<f64>>,
    #[serde(default)]
    pub troubles: Vec<PlannedTrouble>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RawJoint {
    pub driver: Spanned<String>,
    pub port: Spanned<String>,
    pub baud: Option<u32>,
    pub deadline_ms: Option<Spanned<u64>>,
    #[serde(default)]
    pub link_encoder: bool,
    pub thermistor: Option<Spanned<String>>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RawTorqueSensor {
    pub driver: Spanned<String>,
    pub port: Spanned<String>,
    pub baud: Option<u32>,
    pub deadline_ms: Option<Spanned<u64>>,
    pub range: Spanned<String>,
    pub nominal_nm: Spanned<f64>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RawBrake {
    pub driver: Spanned<String>,
    pub port: Spanned<String>,
    pub baud: Option<u32>,
    pub deadline_ms: Option<Spanned<u64>>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RawLimits {
    pub motor_velocity_rad_s: Option<Spanned<f64>>,
    pub motor_current_a: Option<Spanned<f64>>,
    pub link_torque_nm: Option<Spanned<f64>>,
    pub temperature_c: Option<Spanned<f64>>,
    pub brake_current_a: Option<Spanned<f64>>,
    pub brake_power_w: Option<Spanned<f64>>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RawConstants {
    pub torque_constant_nm_per_a: Option<Spanned<f64>>,
    pub gear_ratio: Option<Spanned<f64>>,
    pub rotor_inertia_kg_m2: Option<Spanned<f64>>,
    pub brake_compliance_v: Option<Spanned<f64>>,
    pub brake_rated_current_a: Option<Spanned<f64>>,
    pub brake_rated_torque_nm: Option<Spanned<f64>>,
    pub link_range_rad: Option<Spanned<f64>>,
}
