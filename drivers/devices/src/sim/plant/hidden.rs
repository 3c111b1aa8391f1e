//! What a mock bench may hide: each effect by its name, its size drawn from the seed.

use super::encoders::EncoderTruth;
use super::friction::Friction;
use super::{Noise, Signal};
use crate::sim::data_sheet::{DataSheet, Joint, brake};
use rand::RngExt;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};

/// Effects that can be hidden. Without any, friction is Coulomb and viscous and nothing else.
pub const HIDDEN_EFFECTS: [&str; 10] = [
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

/// One hidden effect with its true figures; the names carry the units.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct HiddenEffect {
    pub effect: String,
    pub parameters: BTreeMap<String, f64>,
}

/// What a mock bench really is. Known to the bench's owner, never to code under test.
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

#[derive(Debug, Clone, Copy)]
struct Wave {
    size: f64,
    harmonic: f64,
    phase_rad: f64,
}

impl Wave {
    fn at(self, angle_rad: f64) -> f64 {
        self.size * (self.harmonic * angle_rad + self.phase_rad).sin()
    }
}

#[derive(Debug, Clone, Copy)]
struct Stribeck {
    rise_nm: f64,
    velocity_rad_s: f64,
    exponent: f64,
}

#[derive(Debug, Clone, Copy, Default)]
pub struct Hidden {
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

impl Hidden {
    /// What the data sheet itself tells of, drawn or not.
    fn of(sheet: &DataSheet) -> Self {
        let told = |figure: f64| (figure != 0.0).then_some(figure);
        let upright = |size| Wave { size, harmonic: 1.0, phase_rad: PI };
        Self {
            direction_offset_nm: told(sheet.direction_offset_nm),
            viscous_asymmetry: told(sheet.viscous_asymmetry),
            gravity_nm: told(sheet.upright_nm).map(upright),
            ..Self::default()
        }
    }

    /// Draws the named effects. `Err` holds the name that is not known.
    pub fn draw(joint: Joint, seed: u64, effects: &[String]) -> Result<Self, String> {
        let sheet = joint.data_sheet();
        let mut hidden = Self::of(&sheet);
        for name in effects {
            let index = HIDDEN_EFFECTS.iter().position(|known| known == name).ok_or_else(|| name.clone())?;
            let mut draw = Noise::new(seed).generator(Signal::Hidden, index as u64);
            // Of Coulomb's size, and to either side.
            let mut of_coulomb = |from: f64, to: f64| sheet.coulomb_nm * draw.random_range(from..to);
            match name.as_str() {
                "stribeck" => {
                    let rise_nm = (sheet.breakaway_nm - sheet.coulomb_nm).max(of_coulomb(0.25, 0.45));
                    hidden.stribeck = Some(Stribeck {
                        rise_nm,
                        velocity_rad_s: sheet.stribeck_velocity_rad_s * sheet.ratio * draw.random_range(0.8..1.25),
                        exponent: sheet.stribeck_exponent,
                    });
                }
                "load_linear" => hidden.load_linear = Some(of_coulomb(0.3, 0.6) / brake::RATED_TORQUE_NM),
                "load_quadratic" => {
                    hidden.load_quadratic_per_nm = Some(of_coulomb(0.35, 0.6) / brake::RATED_TORQUE_NM.powi(2));
                }
                "direction_offset" => {
                    let size = of_coulomb(0.10, 0.25);
                    hidden.direction_offset_nm = Some(if draw.random() { size } else { -size });
                }
                "gravity" => {
                    let size = of_coulomb(0.25, 0.5) * sheet.ratio;
                    hidden.gravity_nm = Some(Wave { size, harmonic: 1.0, phase_rad: draw.random_range(0.0..TAU) });
                }
                "friction_ripple" => {
                    let harmonic = f64::from(draw.random_range(2..=8u8));
                    let (size, phase_rad) = (draw.random_range(0.2..0.4), draw.random_range(0.0..TAU));
                    hidden.ripple = Some(Wave { size, harmonic, phase_rad });
                }
                "temperature_viscous" => hidden.viscous_per_k = Some(draw.random_range(0.018..0.03)),
                "viscous_asymmetry" => {
                    let size = draw.random_range(0.15..0.3);
                    hidden.viscous_asymmetry = Some(if draw.random() { size } else { -size });
                }
                "viscous_quadratic" => {
                    let fast_rad_s = 0.6 * sheet.max_motor_velocity_rad_s;
                    hidden.viscous_quadratic_nm_s2 = Some(of_coulomb(0.3, 0.5) / fast_rad_s.powi(2));
                }
                _ => {
                    let size = of_coulomb(0.2, 0.4);
                    let harmonic = f64::from(draw.random_range(2..=7u8));
                    hidden.cogging_nm = Some(Wave { size, harmonic, phase_rad: draw.random_range(0.0..TAU) });
                }
            }
        }
        Ok(hidden)
    }

    /// The most that the bristles hold at this velocity, load and angle.
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

    /// Drag of the lubricant.
    pub fn drag(&self, friction: &Friction, velocity_rad_s: f64, gear_c: f64) -> f64 {
        let mut coefficient = friction.viscous_nm_s;
        if let Some(per_k) = self.viscous_per_k {
            coefficient *= (-per_k * (gear_c - 25.0)).exp();
        }
        coefficient *= 1.0 + self.viscous_asymmetry.unwrap_or(0.0) * velocity_rad_s.signum();
        coefficient += self.viscous_quadratic_nm_s2.unwrap_or(0.0) * velocity_rad_s.abs();
        coefficient * velocity_rad_s
    }

    /// Weight of the link against the joint.
    pub fn gravity(&self, link_rad: f64) -> f64 {
        self.gravity_nm.map_or(0.0, |wave| wave.at(link_rad))
    }

    /// Magnets against teeth, motor side.
    pub fn cogging(&self, motor_rad: f64) -> f64 {
        self.cogging_nm.map_or(0.0, |wave| wave.at(motor_rad))
    }

    pub fn described(&self) -> Vec<HiddenEffect> {
        let wave = |wave: Wave, unit: &'static str| {
            vec![(unit, wave.size), ("harmonic", wave.harmonic), ("phase_rad", wave.phase_rad)]
        };
        let single = |name: &'static str, value: Option<f64>| value.map(|value| vec![(name, value)]);
        let stribeck = self
            .stribeck
            .map(|s| vec![("rise_nm", s.rise_nm), ("velocity_rad_s", s.velocity_rad_s), ("exponent", s.exponent)]);
        let figures = [
            stribeck,
            single("per_link_nm", self.load_linear),
            single("per_link_nm2", self.load_quadratic_per_nm),
            single("offset_nm", self.direction_offset_nm),
            self.gravity_nm.map(|w| wave(w, "link_nm")),
            self.ripple.map(|w| wave(w, "of_coulomb")),
            single("per_k", self.viscous_per_k),
            single("relative", self.viscous_asymmetry),
            single("nm_s2", self.viscous_quadratic_nm_s2),
            self.cogging_nm.map(|w| wave(w, "nm")),
        ];
        let named = HIDDEN_EFFECTS.iter().zip(figures);
        named
            .filter_map(|(effect, figures)| {
                let parameters = figures?.into_iter().map(|(name, value)| (name.to_owned(), value)).collect();
                Some(HiddenEffect { effect: (*effect).to_owned(), parameters })
            })
            .collect()
    }
}
