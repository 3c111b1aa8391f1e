//! The true parameters of a mock bench, for its owner.

use super::encoders::EncoderTruth;
use super::hidden::HiddenEffect;
use crate::sim::data_sheet::Joint;
use serde::{Deserialize, Serialize};

/// Known to the owner of the bench, never to code under test.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Truth {
    /// The simulated joint.
    pub joint: Joint,
    /// Seed of the parameters and the noise.
    pub seed: u64,
    /// Effects beyond Coulomb and viscous friction, and beyond the data sheets.
    pub hidden: Vec<HiddenEffect>,
    /// Motor side.
    pub coulomb_nm: f64,
    /// Motor side.
    pub viscous_nm_s: f64,
    /// Motor side: stiffness of the contacts before they slide.
    pub bristle_nm_rad: f64,
    /// Motor side: the rotor and the parts of the link on the joint's side of the torque sensor.
    pub inertia_kg_m2: f64,
    /// Link side.
    pub stiffness_nm_rad: f64,
    /// Half the difference of the link's lag under load between both directions.
    pub directional_offset_rad: f64,
    /// k_m: motor torque per ampere.
    pub torque_constant_nm_per_a: f64,
    /// N: motor turns for each link turn.
    pub gear_ratio: f64,
    /// Errors and limits of encoder S2.
    pub encoders: EncoderTruth,
}
