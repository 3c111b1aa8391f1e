//! The gear's elasticity between rotor and link, and the stops of a joint that has some.

use super::super::data_sheet::DataSheet;

/// Damping ratio of the link on the gear.
const DAMPING: f64 = 0.1;
/// Stops far stiffer than any load, soft against the substep [Nm/rad].
const STOP_NM_RAD: f64 = 3000.0;
/// The way of turning is forgotten over this angle of the link (assumed).
const LOST_OVER_RAD: f64 = 0.01;
/// A gear that is soft at first has this much of its stiffness there (assumed).
const SOFT_SHARE: f64 = 0.6;

pub struct Gear {
    ratio: f64,
    stiffness_nm_rad: f64,
    soft_rad: f64,
    lost_rad: f64,
    /// −1 to 1: which flanks carry.
    flank: f64,
    damping_nm_s: f64,
    link_inertia_kg_m2: f64,
    range_rad: f64,
}

impl Gear {
    pub fn new(sheet: &DataSheet, link_inertia_kg_m2: f64) -> Self {
        Self {
            ratio: sheet.ratio,
            stiffness_nm_rad: 1.0 / (1.0 / sheet.stiffness_nm_rad + 1.0 / sheet.bearing_nm_rad),
            soft_rad: sheet.soft_rad,
            lost_rad: sheet.lost_rad,
            flank: 0.0,
            damping_nm_s: 2.0 * DAMPING * (sheet.stiffness_nm_rad * link_inertia_kg_m2).sqrt(),
            link_inertia_kg_m2,
            range_rad: sheet.range_rad.unwrap_or(f64::INFINITY),
        }
    }

    pub fn link_inertia_kg_m2(&self) -> f64 {
        self.link_inertia_kg_m2
    }

    /// After the link has turned: it changes flanks.
    pub fn advance(&mut self, turned_rad: f64) {
        let end = if turned_rad < 0.0 { -1.0 } else { 1.0 };
        self.flank = end + (self.flank - end) * (-turned_rad.abs() / LOST_OVER_RAD).exp();
    }

    /// Torque that the gear hands to the link.
    pub fn torque(&self, motor_rad: f64, link_rad: f64, motor_rad_s: f64, link_rad_s: f64) -> f64 {
        let twist_rad = motor_rad / self.ratio - link_rad - self.lost_rad * self.flank;
        self.stiffness_nm_rad * (twist_rad - self.given(twist_rad))
            + self.damping_nm_s * (motor_rad_s / self.ratio - link_rad_s)
    }

    /// The part of a twist that the belts give before they pull with all their teeth: `soft_rad` to either side at most.
    fn given(&self, twist_rad: f64) -> f64 {
        let until_rad = self.soft_rad / (1.0 - SOFT_SHARE);
        if self.soft_rad > 0.0 { self.soft_rad * twist_rad / until_rad.hypot(twist_rad) } else { 0.0 }
    }

    /// Torque of the stops against the link.
    pub fn stop(&self, link_rad: f64) -> f64 {
        STOP_NM_RAD * (link_rad - link_rad.clamp(-self.range_rad, self.range_rad))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sim::data_sheet::Joint;

    fn stiffness_nm_rad(joint: Joint, twist_rad: f64) -> f64 {
        let gear = Gear::new(&joint.data_sheet(), 0.01);
        let torque = |twist_rad: f64| gear.torque(twist_rad * gear.ratio, 0.0, 0.0, 0.0);
        (torque(twist_rad + 1e-6) - torque(twist_rad - 1e-6)) / 2e-6
    }

    #[test]
    fn joint_a_is_linear_and_joint_b_softer_at_low_torque() {
        for twist_rad in [0.0, 0.005, 0.02] {
            let series = 1.0 / (1.0 / stiffness_nm_rad(Joint::JointA, twist_rad) - 1.0 / 155.0e3);
            assert!((series - 5722.5).abs() < 1e-2, "{series}");
        }
        assert!((stiffness_nm_rad(Joint::JointB, 0.0) / 678.1 - SOFT_SHARE).abs() < 1e-3);
        assert!((stiffness_nm_rad(Joint::JointB, 0.025) / 678.1 - 1.0).abs() < 1e-3);
    }
}
