//! Hidden friction of a joint, in addition to its Coulomb and viscous friction.

use super::{Figures, Wave};
use crate::sim::data_sheet::{DataSheet, brake};
use crate::sim::plant::friction::Friction;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use std::f64::consts::{PI, TAU};

pub const EFFECTS: [&str; 10] = [
    "stribeck",
    "load_linear",
    "load_quadratic",
    "direction_offset",
    "gravity",
    "friction_ripple",
    "temperature_viscous",
    "viscous_asymmetry",
    "viscous_quadratic",
    "cogging",
];

#[derive(Debug, Clone, Copy)]
struct Stribeck {
    rise_nm: f64,
    velocity_rad_s: f64,
    exponent: f64,
}

#[derive(Debug, Clone, Copy, Default)]
pub struct HiddenFriction {
    stribeck: Option<Stribeck>,
    load_linear: Option<f64>,
    load_quadratic_per_nm: Option<f64>,
    direction_offset_nm: Option<f64>,
    gravity_nm: Option<Wave>,
    ripple: Option<Wave>,
    viscous_per_k: Option<f64>,
    viscous_asymmetry: Option<f64>,
    viscous_quadratic_nm_s2: Option<f64>,
    cogging_nm: Option<Wave>,
}

impl HiddenFriction {
    /// The effects that the data sheet describes, drawn or not.
    pub fn of(sheet: &DataSheet) -> Self {
        let nonzero = |figure: f64| (figure != 0.0).then_some(figure);
        let stribeck = || Stribeck {
            rise_nm: sheet.breakaway_nm - sheet.coulomb_nm,
            velocity_rad_s: sheet.stribeck_velocity_rad_s * sheet.ratio,
            exponent: sheet.stribeck_exponent,
        };
        let upright = |size| Wave { size, harmonic: 1.0, phase_rad: PI };
        Self {
            stribeck: sheet.is_exact.then(stribeck),
            direction_offset_nm: nonzero(sheet.direction_offset_nm),
            viscous_asymmetry: nonzero(sheet.viscous_asymmetry),
            gravity_nm: nonzero(sheet.upright_nm).map(upright),
            ..Self::default()
        }
    }

    /// Draws one of [`EFFECTS`].
    pub fn draw(&mut self, name: &str, sheet: &DataSheet, draw: &mut ChaCha8Rng) {
        // A fraction of Coulomb friction.
        let mut of_coulomb = |from: f64, to: f64| sheet.coulomb_nm * draw.random_range(from..to);
        match name {
            // An exact sheet has it.
            "stribeck" if sheet.is_exact => {}
            "stribeck" => {
                let rise_nm = (sheet.breakaway_nm - sheet.coulomb_nm).max(of_coulomb(0.25, 0.45));
                self.stribeck = Some(Stribeck {
                    rise_nm,
                    velocity_rad_s: sheet.stribeck_velocity_rad_s * sheet.ratio * draw.random_range(0.8..1.25),
                    exponent: sheet.stribeck_exponent,
                });
            }
            "load_linear" => self.load_linear = Some(of_coulomb(0.3, 0.6) / brake::RATED_TORQUE_NM),
            "load_quadratic" => {
                self.load_quadratic_per_nm = Some(of_coulomb(0.35, 0.6) / brake::RATED_TORQUE_NM.powi(2));
            }
            "direction_offset" => {
                let size = of_coulomb(0.10, 0.25);
                self.direction_offset_nm = Some(if draw.random() { size } else { -size });
            }
            "gravity" => {
                let size = of_coulomb(0.25, 0.5) * sheet.ratio;
                self.gravity_nm = Some(Wave { size, harmonic: 1.0, phase_rad: draw.random_range(0.0..TAU) });
            }
            "friction_ripple" => {
                let harmonic = f64::from(draw.random_range(2..=8u8));
                let (size, phase_rad) = (draw.random_range(0.2..0.4), draw.random_range(0.0..TAU));
                self.ripple = Some(Wave { size, harmonic, phase_rad });
            }
            "temperature_viscous" => self.viscous_per_k = Some(draw.random_range(0.018..0.03)),
            "viscous_asymmetry" => {
                let size = draw.random_range(0.15..0.3);
                self.viscous_asymmetry = Some(if draw.random() { size } else { -size });
            }
            "viscous_quadratic" => {
                let fast_rad_s = 0.6 * sheet.max_motor_velocity_rad_s;
                self.viscous_quadratic_nm_s2 = Some(of_coulomb(0.3, 0.5) / fast_rad_s.powi(2));
            }
            "cogging" => {
                let size = of_coulomb(0.2, 0.4);
                let harmonic = f64::from(draw.random_range(2..=7u8));
                self.cogging_nm = Some(Wave { size, harmonic, phase_rad: draw.random_range(0.0..TAU) });
            }
            _ => unreachable!("{name} has no arm here"),
        }
    }

    /// The largest holding torque of the bristles at this velocity, load and angle.
    pub fn grip(&self, friction: &Friction, velocity_rad_s: f64, gear_nm: f64, link_rad: f64) -> f64 {
        let mut grip_nm = friction.coulomb_nm;
        if let Some(Stribeck { rise_nm, velocity_rad_s: scale, exponent }) = self.stribeck {
            grip_nm += rise_nm * (-(velocity_rad_s.abs() / scale).powf(exponent)).exp();
        }
        grip_nm += self.load_linear.unwrap_or(0.0) * gear_nm.abs();
        grip_nm += self.load_quadratic_per_nm.unwrap_or(0.0) * gear_nm * gear_nm;
        grip_nm *= 1.0 + self.ripple.map_or(0.0, |ripple| ripple.at(link_rad));
        grip_nm + self.direction_offset_nm.unwrap_or(0.0) * velocity_rad_s.signum()
    }

    /// Viscous drag of the lubricant.
    pub fn drag(&self, friction: &Friction, velocity_rad_s: f64, gear_c: f64) -> f64 {
        let mut coefficient = friction.viscous_nm_s;
        if let Some(per_k) = self.viscous_per_k {
            coefficient *= (-per_k * (gear_c - 25.0)).exp();
        }
        coefficient *= 1.0 + self.viscous_asymmetry.unwrap_or(0.0) * velocity_rad_s.signum();
        coefficient += self.viscous_quadratic_nm_s2.unwrap_or(0.0) * velocity_rad_s.abs();
        coefficient * velocity_rad_s
    }

    /// Gravity torque of the link on the joint.
    pub fn gravity(&self, link_rad: f64) -> f64 {
        self.gravity_nm.map_or(0.0, |wave| wave.at(link_rad))
    }

    /// Cogging torque of the motor, motor side.
    pub fn cogging(&self, motor_rad: f64) -> f64 {
        self.cogging_nm.map_or(0.0, |wave| wave.at(motor_rad))
    }

    pub fn figures(&self) -> [Option<Figures>; EFFECTS.len()] {
        let stribeck =
            |s: Stribeck| vec![("rise_nm", s.rise_nm), ("velocity_rad_s", s.velocity_rad_s), ("exponent", s.exponent)];
        let single = |name: &'static str, value: Option<f64>| value.map(|value| vec![(name, value)]);
        [
            self.stribeck.map(stribeck),
            single("per_link_nm", self.load_linear),
            single("per_link_nm2", self.load_quadratic_per_nm),
            single("offset_nm", self.direction_offset_nm),
            self.gravity_nm.map(|wave| wave.figures("link_nm")),
            self.ripple.map(|wave| wave.figures("of_coulomb")),
            single("per_k", self.viscous_per_k),
            single("relative", self.viscous_asymmetry),
            single("nm_s2", self.viscous_quadratic_nm_s2),
            self.cogging_nm.map(|wave| wave.figures("nm")),
        ]
    }
}
