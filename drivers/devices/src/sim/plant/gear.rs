//! The elasticity of the gear between rotor and link, and the end stops of a joint with limited range.

use super::super::data_sheet::DataSheet;
use super::STEP_S;
use super::hidden::{Contact, HiddenGear};

/// Damping ratio of the link on the gear.
const DAMPING: f64 = 0.1;
/// Stops are much stiffer than any load, but soft enough for the substep [Nm/rad].
const STOP_NM_RAD: f64 = 3000.0;
/// Link rotation over which the gear changes its flank after a reversal (assumed).
const LOST_OVER_RAD: f64 = 0.01;
/// Initial stiffness of a soft gear, as a fraction of its full stiffness (assumed).
const SOFT_SHARE: f64 = 0.6;
/// Torque that a slipping coupling still transmits (assumed).
const SLIPS_AT_NM: f64 = 2.0;

pub struct Gear {
    ratio: f64,
    stiffness_nm_rad: f64,
    soft_rad: f64,
    lost_rad: f64,
    /// −1 to 1: the flanks in contact.
    flank: f64,
    damping_nm_s: f64,
    link_inertia_kg_m2: f64,
    range_rad: f64,
    hidden: HiddenGear,
    /// Twist at which teeth in friction contact hold.
    seat_rad: f64,
    /// Creep of the gear under load.
    crept_rad: f64,
    /// The coupling to the link slips.
    pub slips: bool,
    /// Displacement of the coupling.
    slipped_rad: f64,
}

impl Gear {
    pub fn new(sheet: &DataSheet, link_inertia_kg_m2: f64, hidden: HiddenGear) -> Self {
        Self {
            ratio: sheet.ratio,
            stiffness_nm_rad: 1.0 / (1.0 / sheet.stiffness_nm_rad + 1.0 / sheet.bearing_nm_rad),
            soft_rad: sheet.soft_rad,
            lost_rad: sheet.lost_rad,
            flank: 0.0,
            damping_nm_s: 2.0 * DAMPING * (sheet.stiffness_nm_rad * link_inertia_kg_m2).sqrt(),
            link_inertia_kg_m2,
            range_rad: sheet.range_rad.unwrap_or(f64::INFINITY),
            hidden,
            seat_rad: 0.0,
            crept_rad: 0.0,
            slips: false,
            slipped_rad: 0.0,
        }
    }

    pub fn link_inertia_kg_m2(&self) -> f64 {
        self.link_inertia_kg_m2
    }

    /// Updates the gear after a rotation of the link: it changes flanks.
    pub fn advance(&mut self, motor_rad: f64, link_rad: f64, turned_rad: f64) {
        let end = if turned_rad < 0.0 { -1.0 } else { 1.0 };
        self.flank = end + (self.flank - end) * (-turned_rad.abs() / LOST_OVER_RAD).exp();
        if self.slips {
            let spring_nm = self.spring(self.twist_rad(motor_rad, link_rad));
            let beyond_nm = spring_nm - spring_nm.clamp(-SLIPS_AT_NM, SLIPS_AT_NM);
            self.slipped_rad += beyond_nm / self.stiffness_nm_rad;
        }
        let twist_rad = self.twist_rad(motor_rad, link_rad);
        if let Some(contact) = self.hidden.contact {
            self.seat_rad = self.seat_rad.clamp(twist_rad - contact.bends_rad, twist_rad + contact.bends_rad);
        }
        if let Some(yielding) = self.hidden.yielding {
            let end_rad = yielding.share * self.spring(twist_rad) / self.stiffness_nm_rad;
            self.crept_rad += (end_rad - self.crept_rad) * STEP_S / yielding.lag_s;
        }
    }

    /// Torque of the gear on the link.
    pub fn torque(&self, motor_rad: f64, link_rad: f64, motor_rad_s: f64, link_rad_s: f64) -> f64 {
        let twist_rad = self.twist_rad(motor_rad, link_rad);
        let rubbing = |contact: Contact| contact.holds_nm * (twist_rad - self.seat_rad) / contact.bends_rad;
        self.spring(twist_rad)
            + self.hidden.contact.map_or(0.0, rubbing)
            + self.damping_nm_s * (motor_rad_s / self.ratio - link_rad_s)
    }

    fn twist_rad(&self, motor_rad: f64, link_rad: f64) -> f64 {
        let stands_rad = link_rad + self.hidden.pitch_rad(link_rad);
        motor_rad / self.ratio - stands_rad - self.lost_rad * self.flank - self.crept_rad - self.slipped_rad
    }

    fn spring(&self, twist_rad: f64) -> f64 {
        self.stiffness_nm_rad * self.hidden.stiffening(twist_rad) * (twist_rad - self.given(twist_rad))
    }

    /// The part of a twist that the belts yield before all teeth carry: at most `soft_rad` to either side.
    fn given(&self, twist_rad: f64) -> f64 {
        let until_rad = self.soft_rad / (1.0 - SOFT_SHARE);
        if self.soft_rad > 0.0 { self.soft_rad * twist_rad / until_rad.hypot(twist_rad) } else { 0.0 }
    }

    /// Torque of the stops on the link.
    pub fn stop(&self, link_rad: f64) -> f64 {
        STOP_NM_RAD * (link_rad - link_rad.clamp(-self.range_rad, self.range_rad))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sim::data_sheet::Joint;
    use crate::sim::plant::Hidden;

    /// Joint A with one hidden effect, and its true parameters.
    fn hiding(effect: &str) -> (Gear, impl Fn(&str) -> f64) {
        let hidden = Hidden::draw(Joint::JointA, 5, &[effect.to_owned()]).unwrap();
        let truth = hidden.described().remove(0).parameters;
        (Gear::new(&Joint::JointA.into(), 0.01, hidden.gear), move |name: &str| truth[name])
    }

    /// Torque after the motor has twisted the gear to `twist_rad` and held it for `held_s`.
    fn twisted(gear: &mut Gear, twist_rad: f64, held_s: f64) -> f64 {
        (0..=(held_s / STEP_S) as usize).for_each(|_| gear.advance(twist_rad * gear.ratio, 0.0, 0.0));
        gear.torque(twist_rad * gear.ratio, 0.0, 0.0, 0.0)
    }

    #[test]
    fn a_progressive_gear_is_twice_as_stiff_at_its_twist() {
        let (mut gear, truth) = hiding("hardening");
        let twist_rad = truth("twice_as_stiff_rad");
        let stiffness = twisted(&mut gear, twist_rad, 0.0) / twist_rad;
        assert!((stiffness / gear.stiffness_nm_rad - 2.0).abs() < 1e-9, "{stiffness}");
    }

    #[test]
    fn teeth_that_rub_part_both_ways_by_what_they_hold() {
        let (mut gear, truth) = hiding("torsional_hysteresis");
        let far_rad = 0.003;
        assert!(far_rad > 2.0 * truth("bends_rad"));
        let (up, _, down) =
            (twisted(&mut gear, 0.0, 0.0), twisted(&mut gear, far_rad, 0.0), twisted(&mut gear, 0.0, 0.0));
        assert!((up - down - truth("holds_nm")).abs() < 1e-9, "{up} {down}");
    }

    #[test]
    fn a_gear_that_yields_loses_torque_while_it_is_held() {
        let (mut gear, truth) = hiding("creep");
        let at_once = twisted(&mut gear, 0.002, 0.0);
        let later = twisted(&mut gear, 0.002, 20.0 * truth("lag_s"));
        assert!((at_once / later - 1.0 - truth("of_twist")).abs() < 1e-3, "{at_once} {later}");
    }

    #[test]
    fn a_slipping_coupling_keeps_its_torque_and_its_displacement() {
        let mut gear = Gear::new(&Joint::JointB.into(), 0.01, HiddenGear::default());
        gear.slips = true;
        assert!((twisted(&mut gear, 0.05, 0.01) - SLIPS_AT_NM).abs() < 0.01);
        gear.slips = false;
        let displaced_nm = -twisted(&mut gear, 0.0, 0.0);
        assert!(displaced_nm > 10.0, "{displaced_nm}");
    }

    #[test]
    fn each_tooth_has_its_own_pitch() {
        let (gear, truth) = hiding("transmission_error");
        let link_rad = 0.3;
        let torque = gear.torque(link_rad * gear.ratio, link_rad, 0.0, 0.0);
        let off_rad = truth("rad") * (truth("harmonic") * link_rad + truth("phase_rad")).sin();
        assert!((torque + gear.stiffness_nm_rad * off_rad).abs() < 1e-9, "{torque}");
    }

    fn stiffness_nm_rad(joint: Joint, twist_rad: f64) -> f64 {
        let gear = Gear::new(&joint.into(), 0.01, HiddenGear::default());
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
