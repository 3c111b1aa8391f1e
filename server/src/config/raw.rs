//! The bench description before the checks. Values keep their position in the file for messages.

use jointbench_devices::PumaGains;
use jointbench_devices::sim::PlannedTrouble;
use serde::Deserialize;
use toml::Spanned;
use toml::value::Datetime;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RawFile {
    #[serde(default)]
    pub bench: Vec<RawBench>,
    pub dashboard: Option<Spanned<String>>,
    #[serde(default)]
    pub notify: Vec<Spanned<RawNotify>>,
    pub archive: Option<RawArchive>,
}

/// Where the tables of ended runs are archived.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RawArchive {
    pub url: Spanned<String>,
    /// The samples too, not only the means at steady state.
    #[serde(default)]
    pub raw: bool,
}

/// A target of notifications: `webhook`, `mail` or `mqtt`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RawNotify {
    pub name: Option<Spanned<String>>,
    pub events: Option<Vec<Spanned<String>>>,
    pub webhook: Option<Spanned<String>>,
    pub mail: Option<Spanned<String>>,
    pub smtp: Option<Spanned<String>>,
    pub from: Option<Spanned<String>>,
    pub mqtt: Option<Spanned<String>>,
    pub topic: Option<Spanned<String>>,
    /// Signing key or password.
    pub secret_file: Option<Spanned<String>>,
    pub secret_env: Option<Spanned<String>>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RawBench {
    pub name: Spanned<String>,
    pub mock: Option<RawMock>,
    pub joint: Option<RawJoint>,
    pub torque_sensor: Option<RawTorqueSensor>,
    pub brake: Option<RawPort>,
    pub reference_encoder: Option<RawCounter>,
    pub test_encoder: Option<RawCounter>,
    pub stage: Option<RawPort>,
    pub thermometer: Option<RawThermometer>,
    pub limits: Option<RawLimits>,
    pub constants: Option<RawConstants>,
    pub torsion: Option<Spanned<RawTorsion>>,
}

impl RawBench {
    pub fn has_instruments(&self) -> bool {
        self.joint.is_some()
            || self.torque_sensor.is_some()
            || self.brake.is_some()
            || self.reference_encoder.is_some()
            || self.test_encoder.is_some()
            || self.stage.is_some()
            || self.thermometer.is_some()
    }
}

/// Simulated instruments, which replace all others.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RawMock {
    pub joint: Spanned<String>,
    /// Axis of the Puma.
    pub axis: Option<Spanned<u8>>,
    /// Exactly the values of the source documents.
    #[serde(default)]
    pub documents: bool,
    pub load: Option<Spanned<String>>,
    pub supply: Option<Spanned<String>>,
    pub seed: Option<u64>,
    #[serde(default)]
    pub effects: Vec<Spanned<String>>,
    pub pace: Option<Spanned<f64>>,
    /// Whether the interpolation filter of the encoder under test is on.
    #[serde(default)]
    pub filter: bool,
    /// Adds a thermometer. An encoder bench always has one.
    #[serde(default)]
    pub thermometer: bool,
    #[serde(default)]
    pub troubles: Vec<Spanned<PlannedTrouble>>,
    /// For a Puma-type servo.
    pub ninter: Option<Spanned<u8>>,
    /// Gains and tolerance bands of a Puma-type servo.
    pub servo: Option<Spanned<PumaGains>>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RawJoint {
    pub driver: Spanned<String>,
    pub port: Spanned<String>,
    pub baud: Option<u32>,
    pub deadline_ms: Option<Spanned<u64>>,
    pub link_encoder: Option<Spanned<bool>>,
    pub thermistor: Option<Spanned<String>>,
    /// For a Puma-type servo.
    pub counts_per_turn: Option<Spanned<u32>>,
    pub amperes_per_volt: Option<Spanned<f64>>,
    pub ninter: Option<Spanned<u8>>,
    pub servo: Option<Spanned<PumaGains>>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RawTorqueSensor {
    pub driver: Spanned<String>,
    pub port: Spanned<String>,
    pub baud: Option<u32>,
    pub deadline_ms: Option<Spanned<u64>>,
    pub range: Option<Spanned<String>>,
    pub nominal_nm: Spanned<f64>,
    pub calibrated: Option<Spanned<Datetime>>,
}

/// An instrument that needs only its port.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RawPort {
    pub driver: Spanned<String>,
    pub port: Spanned<String>,
    pub baud: Option<u32>,
    pub deadline_ms: Option<Spanned<u64>>,
    pub calibrated: Option<Spanned<Datetime>>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RawCounter {
    pub driver: Spanned<String>,
    pub port: Spanned<String>,
    pub baud: Option<u32>,
    pub deadline_ms: Option<Spanned<u64>>,
    pub counts_per_turn: Spanned<u32>,
    #[serde(default)]
    pub reversed: bool,
    pub status_input: Option<Spanned<u8>>,
    pub calibrated: Option<Spanned<Datetime>>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RawThermometer {
    pub driver: Spanned<String>,
    pub port: Spanned<String>,
    pub baud: Option<u32>,
    pub deadline_ms: Option<Spanned<u64>>,
    pub slave: Option<Spanned<u8>>,
    pub channels: Vec<Spanned<u8>>,
    pub calibrated: Option<Spanned<Datetime>>,
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
    pub load_gear_ratio: Option<Spanned<f64>>,
}

/// Monitor of the torsion between both encoders of the joint.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RawTorsion {
    pub compliance_rad_per_nm: Spanned<f64>,
    pub tolerance_rad: Spanned<f64>,
}
