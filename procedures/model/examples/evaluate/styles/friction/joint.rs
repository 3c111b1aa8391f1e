//! Typical joints: strain wave gears, planetary gears, belts, direct drives.

use super::bristle::Bristle;
use super::excitation::STYLES;
use super::laws::Scale;
use super::plant::{Plant, State};
use crate::made::Dice;
use crate::styles::draw::Plan;
use jointbench_instrument::{Kind, Meta};
use std::collections::BTreeMap;

#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Load {
    None,
    Inertia,
    Arm,
    BrakeSteps,
    BrakeWave,
}

impl Load {
    pub fn draw(dice: &mut Dice) -> Self {
        *dice.pick(&[Self::None, Self::Inertia, Self::Arm, Self::BrakeSteps, Self::BrakeSteps, Self::BrakeWave])
    }

    pub fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Inertia => "inertia",
            Self::Arm => "arm",
            Self::BrakeSteps => "brake_steps",
            Self::BrakeWave => "brake_wave",
        }
    }
}

pub struct Joint {
    pub name: &'static str,
    pub style: &'static str,
    pub load: Load,
    pub gear: f64,
    pub fastest: f64,
    pub dry: f64,
    pub oil: f64,
    pub motor_inertia: f64,
    pub link_inertia: f64,
    pub resonance_hz: f64,
    pub bend: f64,
    pub arm: f64,
    pub brake: f64,
    pub bits: u32,
    pub rate_hz: f64,
    pub repeats: usize,
    pub bristle: Bristle,
    pub torque_constant: f64,
    /// Duration of the run.
    pub last_s: f64,
}

/// Inertia behind the gear of a joint without a load, as a share of its own.
const FREE_END: f64 = 0.02;

impl Joint {
    pub fn draw(load: Load, plan: &Plan, dice: &mut Dice) -> Self {
        let (name, gears, low, high): (_, &[f64], _, _) = *dice.pick(&[
            ("strain_wave", &[50.0, 80.0, 100.0, 160.0] as &[f64], 70.0, 220.0),
            ("planetary", &[4.0, 5.9, 10.0, 16.0, 25.0], 40.0, 150.0),
            ("belt", &[2.0, 3.0, 4.5], 20.0, 60.0),
            ("direct", &[1.0], 6.0, 20.0),
        ]);
        let (fastest, dry) = (dice.uniform(low, high), dice.size(0.008, 0.15));
        let motor_inertia = dry * dice.size(0.05, 0.4) / fastest;
        let share = if load == Load::Inertia || load == Load::Arm { dice.uniform(0.5, 2.5) } else { 0.3 };
        // Stiffer bristles would be unstable with the time step of the simulation.
        let quick = 4e-6 * dry / motor_inertia;
        let bend =
            if plan.hides("presliding") { fastest * dice.size(2e-3, 1.2e-2) } else { quick * dice.size(1.0, 8.0) };
        Self {
            name,
            style: *dice.pick(STYLES),
            load,
            gear: *dice.pick(gears),
            fastest,
            dry,
            oil: dry * dice.uniform(0.3, 1.4) / fastest,
            motor_inertia,
            link_inertia: motor_inertia * share,
            resonance_hz: dice.size(40.0, 140.0),
            bend,
            arm: if load == Load::Arm { dry * dice.uniform(0.6, 2.5) } else { 0.0 },
            brake: if matches!(load, Load::BrakeSteps | Load::BrakeWave) { dry * dice.uniform(1.0, 5.0) } else { 0.0 },
            bits: *dice.pick(&[13, 14, 16, 17, 20]),
            rate_hz: 0.0,
            repeats: *dice.pick(&[1, 1, 2, 2, 3, 4]),
            bristle: Bristle::draw(dice),
            torque_constant: dice.size(0.01, 0.3),
            last_s: 0.0,
        }
    }

    /// Inertia that moves with the motor, as far as the motor torque determines it.
    pub fn inertia(&self) -> f64 {
        if self.load == Load::None { self.motor_inertia + self.link_inertia } else { self.motor_inertia }
    }

    /// Inertia that the motor torque accelerates and that a sensor in the link does not measure.
    fn felt_inertia(&self) -> f64 {
        if self.load == Load::None { (1.0 + FREE_END) * self.inertia() } else { self.inertia() }
    }

    pub fn scale(&self) -> Scale {
        let heaviest = self.arm.max(self.brake).max(0.5 * self.dry);
        Scale {
            dry: self.dry,
            oil: self.oil,
            fastest: self.fastest,
            heaviest,
            last_s: self.last_s,
            has_load: self.load != Load::None,
        }
    }

    pub fn plant(&self, start: f64, damped: f64) -> Plant {
        // Without a load link and motor are one mass, so that the gear does not twist.
        let (inertia, link_inertia) = match self.load {
            Load::None => (self.inertia(), FREE_END * self.inertia()),
            _ => (self.motor_inertia, self.link_inertia),
        };
        let reduced = inertia * link_inertia / (inertia + link_inertia);
        let pulsation = std::f64::consts::TAU * if self.load == Load::None { 250.0 } else { self.resonance_hz };
        Plant {
            gear: self.gear,
            inertia,
            link_inertia,
            stiffness: reduced * pulsation * pulsation,
            damping: 2.0 * damped * reduced * pulsation,
            dry: self.dry,
            oil: self.oil,
            bristle_damping: 0.4 * (self.dry * self.bend * inertia).sqrt(),
            bristle: self.bristle.clone(),
            bend: self.bend,
            arm: self.arm,
            brake: self.brake,
            fastest: self.fastest,
            laws: Vec::new(),
            state: State { motor: start, link: start, ..State::default() },
        }
    }

    pub fn meta(&self, baseline: Vec<String>) -> Meta {
        Meta {
            kind: Some(Kind::Friction),
            torque_constant_nm_per_a: Some(self.torque_constant),
            gear_ratio: Some(self.gear),
            rotor_inertia_kg_m2: Some(self.motor_inertia),
            baseline,
            sample_rate_hz: Some(self.rate_hz),
            ..Meta::default()
        }
    }

    /// Parameters with the same meaning in the library, except those that another law of the same axis shares.
    pub fn truth(&self, plan: &Plan, offset: Option<f64>) -> BTreeMap<String, f64> {
        let hides = |ids: &[&str]| ids.iter().any(|id| plan.hides(id));
        let speed = ["stribeck", "viscous_sublinear", "viscous_quadratic", "speed_hump", "presliding"];
        let shared = hides(&speed) || hides(&["stribeck_load", "stick_spot_time", "driving_asymmetry", "bump_angle"]);
        let mut truth = BTreeMap::from([("inertia.j".to_owned(), self.felt_inertia())]);
        if !shared && !hides(&["temperature_coulomb", "load_linear", "load_quadratic"]) {
            truth.insert("coulomb.tau_c".into(), self.dry);
        }
        if !shared && !hides(&["temperature_viscous", "viscous_asymmetry", "load_viscous"]) {
            truth.insert("viscous.c_v".into(), self.oil);
        }
        truth.extend(offset.map(|offset| ("direction_offset.tau_0".to_owned(), offset)));
        truth
    }
}
