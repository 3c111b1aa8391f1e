//! What a mock bench really is, for its owner.

use super::encoders::EncoderTruth;
use super::hidden::HiddenEffect;
use crate::sim::data_sheet::Joint;
use serde::{Deserialize, Serialize};

/// Known to the bench's owner, never to code under test.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Truth {
    pub joint: Joint,
    pub seed: u64,
    pub hidden: Vec<HiddenEffect>,
    /// Motor side.
    pub coulomb_nm: f64,
    /// Motor side.
    pub viscous_nm_s: f64,
    /// Motor side: of the contacts before they slide.
    pub bristle_nm_rad: f64,
    /// Motor side: the rotor and what the link carries on the joint's side of the torque sensor.
    pub inertia_kg_m2: f64,
    /// Link side.
    pub stiffness_nm_rad: f64,
    /// Half of what the link lags under load between both ways of turning.
    pub directional_offset_rad: f64,
    pub torque_constant_nm_per_a: f64,
    pub gear_ratio: f64,
    pub encoders: EncoderTruth,
}
