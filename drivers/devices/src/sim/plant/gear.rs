//! The gear's elasticity between rotor and link, and the stops of a joint that has some.

use super::super::data_sheet::DataSheet;

/// Damping ratio of the link on the gear.
const DAMPING: f64 = 0.1;
/// Stops far stiffer than any load, soft against the substep [Nm/rad].
const STOP_NM_RAD: f64 = 3000.0;

pub struct Gear {
    ratio: f64,
    stiffness_nm_rad: f64,
    damping_nm_s: f64,
    link_inertia_kg_m2: f64,
    range_rad: f64,
}

impl Gear {
    pub fn new(sheet: &DataSheet, link_inertia_kg_m2: f64) -> Self {
        Self {
            ratio: sheet.ratio,
            stiffness_nm_rad: sheet.stiffness_nm_rad,
            damping_nm_s: 2.0 * DAMPING * (sheet.stiffness_nm_rad * link_inertia_kg_m2).sqrt(),
            link_inertia_kg_m2,
            range_rad: sheet.range_rad.unwrap_or(f64::INFINITY),
        }
    }

    pub fn link_inertia_kg_m2(&self) -> f64 {
        self.link_inertia_kg_m2
    }

    /// Torque that the gear hands to the link.
    pub fn torque(&self, motor_rad: f64, link_rad: f64, motor_rad_s: f64, link_rad_s: f64) -> f64 {
        self.stiffness_nm_rad * (motor_rad / self.ratio - link_rad)
            + self.damping_nm_s * (motor_rad_s / self.ratio - link_rad_s)
    }

    /// Torque of the stops against the link.
    pub fn stop(&self, link_rad: f64) -> f64 {
        STOP_NM_RAD * (link_rad - link_rad.clamp(-self.range_rad, self.range_rad))
    }
}
