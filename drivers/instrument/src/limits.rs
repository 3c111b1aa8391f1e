//! Limits that a bench must never exceed. The guard checks every command and every sample against them.

use serde::{Deserialize, Serialize};
use std::fmt;

/// Hard limits of one bench. Motor side for speed and current, link side for torque.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Limits {
    /// |motor velocity|.
    pub motor_velocity_rad_s: f64,
    /// |motor current|.
    pub motor_current_a: f64,
    /// |link torque|.
    pub link_torque_nm: f64,
    /// Highest temperature of the joint.
    pub temperature_c: f64,
    /// |brake current|.
    pub brake_current_a: f64,
    /// Power that the brake converts to heat: |link torque · link velocity|.
    pub brake_power_w: f64,
}

/// The quantities that have a limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Limited {
    /// Angular velocity of the motor shaft.
    MotorVelocity,
    /// Torque-producing current of the motor.
    MotorCurrent,
    /// Torque between joint and load.
    LinkTorque,
    /// Temperature of the joint.
    Temperature,
    /// Current of the brake's coil.
    BrakeCurrent,
    /// Power that the brake converts to heat.
    BrakePower,
}

impl Limited {
    /// Every limited quantity, in the order of [`Limits`].
    pub const ALL: [Limited; 6] = [
        Limited::MotorVelocity,
        Limited::MotorCurrent,
        Limited::LinkTorque,
        Limited::Temperature,
        Limited::BrakeCurrent,
        Limited::BrakePower,
    ];

    /// Unit of its limit, in SI symbols.
    pub fn unit(self) -> &'static str {
        match self {
            Limited::MotorVelocity => "rad/s",
            Limited::MotorCurrent | Limited::BrakeCurrent => "A",
            Limited::LinkTorque => "Nm",
            Limited::Temperature => "°C",
            Limited::BrakePower => "W",
        }
    }

    /// Its name in messages: "motor velocity".
    pub fn name(self) -> &'static str {
        match self {
            Limited::MotorVelocity => "motor velocity",
            Limited::MotorCurrent => "motor current",
            Limited::LinkTorque => "link torque",
            Limited::Temperature => "temperature",
            Limited::BrakeCurrent => "brake current",
            Limited::BrakePower => "brake power",
        }
    }
}

/// A limit that a command or a sample exceeds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Breach {
    /// The quantity that exceeds its limit.
    pub quantity: Limited,
    /// Its value, with sign, in the unit of the quantity.
    pub value: f64,
    /// The limit of its absolute value.
    pub limit: f64,
}

/// Largest deviation of the torsion of a joint from the torsion that its torque causes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TorsionLimit {
    /// Torsion between both encoders of the joint for each Nm, as a `stiffness` run has measured it (k'⁻¹), link side.
    pub compliance_rad_per_nm: f64,
    /// Largest |deviation| of the measured torsion, link side.
    pub tolerance_rad: f64,
}

impl fmt::Display for Breach {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (name, unit) = (self.quantity.name(), self.quantity.unit());
        let [value, limit] = [self.value, self.limit].map(|v| (1e4 * v).round() / 1e4);
        write!(f, "{name} {value} {unit} exceeds the limit of {limit} {unit}")
    }
}

impl std::error::Error for Breach {}

impl Limits {
    /// The limit of a quantity, in its unit.
    pub fn of(&self, quantity: Limited) -> f64 {
        match quantity {
            Limited::MotorVelocity => self.motor_velocity_rad_s,
            Limited::MotorCurrent => self.motor_current_a,
            Limited::LinkTorque => self.link_torque_nm,
            Limited::Temperature => self.temperature_c,
            Limited::BrakeCurrent => self.brake_current_a,
            Limited::BrakePower => self.brake_power_w,
        }
    }

    /// NaN exceeds every limit, because an unreadable value cannot be trusted.
    pub fn check(&self, quantity: Limited, value: f64) -> Result<(), Breach> {
        let limit = self.of(quantity);
        if value.abs() <= limit { Ok(()) } else { Err(Breach { quantity, value, limit }) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_signs_and_nan_break_a_limit() {
        let limits = Limits {
            motor_velocity_rad_s: 100.0,
            motor_current_a: 5.0,
            link_torque_nm: 20.0,
            temperature_c: 70.0,
            brake_current_a: 0.6,
            brake_power_w: 350.0,
        };
        assert!(limits.check(Limited::MotorVelocity, -100.0).is_ok());
        let breach = limits.check(Limited::MotorVelocity, -100.1).unwrap_err();
        assert_eq!(breach.to_string(), "motor velocity -100.1 rad/s exceeds the limit of 100 rad/s");
        assert!(limits.check(Limited::Temperature, f64::NAN).is_err());
    }
}
