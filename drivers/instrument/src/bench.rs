//! One bench: the instruments in their roles, one clock, one set of limits. Owned by exactly one thread.

use crate::roles::{CurrentSource, JointController, TorqueSensor};
use crate::{Clock, Limits};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// The constants of the joint under test that every run records.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointConstants {
    /// k_m.
    pub torque_constant_nm_per_a: f64,
    /// N: motor turns for each link turn.
    pub gear_ratio: f64,
    pub rotor_inertia_kg_m2: f64,
    /// Coil resistance and rating of the brake decide the supply's compliance voltage.
    pub brake_compliance_v: f64,
    pub brake_rated_current_a: f64,
    /// Torque of the brake at rated current, link side.
    pub brake_rated_torque_nm: f64,
    /// The link may turn this far to either side of the zero of its encoder. Empty: unlimited.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub link_range_rad: Option<f64>,
}

/// The instruments that a bench has. Absence is an empty slot, never a dummy.
pub struct Bench {
    pub name: String,
    pub simulated: bool,
    pub clock: Arc<dyn Clock>,
    pub limits: Limits,
    pub constants: JointConstants,
    pub joint: Box<dyn JointController>,
    pub torque_sensor: Option<Box<dyn TorqueSensor>>,
    pub brake: Option<Box<dyn CurrentSource>>,
}
