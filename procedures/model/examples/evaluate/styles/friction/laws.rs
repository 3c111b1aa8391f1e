//! Laws of the friction of a joint, from literature that differs from the library's formulas.

use crate::made::Dice;
use std::f64::consts::TAU;

/// A joint at one moment, on the motor side.
#[derive(Clone, Default)]
pub struct Moment {
    pub time: f64,
    pub velocity: f64,
    /// Deflection of the bristles, −1 to 1: the direction of dry friction.
    pub bristle: f64,
    /// Torque through the gear [Nm].
    pub load: f64,
    pub link: f64,
    pub motor: f64,
    /// Above 25 °C [K].
    pub warmth: f64,
    /// Motor torque [Nm].
    pub torque: f64,
    pub acceleration: f64,
    /// Torque of the dry bristles, with their damping [Nm].
    pub dry: f64,
}

pub type Law = Box<dyn Fn(&Moment) -> f64>;

/// Magnitudes of a joint, to which the magnitudes of its effects are proportional.
pub struct Scale {
    pub dry: f64,
    pub oil: f64,
    pub fastest: f64,
    pub heaviest: f64,
    pub last_s: f64,
    pub has_load: bool,
}

pub const EFFECTS: &[&str] = &[
    "stribeck",
    "direction_offset",
    "viscous_asymmetry",
    "viscous_quadratic",
    "viscous_sublinear",
    "temperature_viscous",
    "temperature_coulomb",
    "gravity",
    "cogging",
    "friction_ripple",
    "torque_constant_saturation",
    "drift",
    "presliding",
];
pub const OF_LOAD: &[&str] = &["load_linear", "load_quadratic", "load_viscous", "stribeck_load"];
pub const OUTSIDE: &[&str] = &["speed_hump", "bump_angle", "stick_spot_time", "driving_asymmetry", "intermittent"];

/// Reduction of the dry friction above a speed.
fn lubrication(slow: f64, dice: &mut Dice) -> Box<dyn Fn(f64) -> f64> {
    let exponent = dice.uniform(0.6, 2.0);
    match dice.uniform(0.0, 5.0) as u32 {
        0 => Box::new(move |w: f64| (-(w.abs() / slow).powf(exponent)).exp()),
        1 => Box::new(move |w: f64| 1.0 / (1.0 + (w / slow).powi(2))),
        2 => Box::new(move |w: f64| (-w.abs() / slow).exp()),
        3 => Box::new(move |w: f64| (-(w / slow).powi(2)).exp()),
        _ => Box::new(move |w: f64| 1.0 / (w.abs() / slow).min(300.0).cosh()),
    }
}

/// The law of an effect by its library id, or of something outside the library. Without load the load laws are zero.
pub fn law(id: &str, joint: &Scale, dice: &mut Dice) -> Law {
    match id {
        "load_linear" | "load_quadratic" | "load_viscous" | "stribeck_load" => of_load(id, joint, dice),
        "gravity" | "cogging" | "friction_ripple" => of_angle(id, joint, dice),
        "speed_hump" | "bump_angle" | "stick_spot_time" | "driving_asymmetry" | "intermittent" => {
            outside(id, joint, dice)
        }
        _ => of_speed_and_heat(id, joint, dice),
    }
}

fn of_speed_and_heat(id: &str, joint: &Scale, dice: &mut Dice) -> Law {
    let Scale { dry, oil, fastest, last_s, .. } = *joint;
    match id {
        "stribeck" => {
            let (size, fades) = (dry * dice.uniform(0.15, 0.6), lubrication(fastest * dice.size(0.015, 0.12), dice));
            Box::new(move |m| size * fades(m.velocity) * m.bristle)
        }
        "direction_offset" => {
            let size = dry * dice.uniform(0.04, 0.25) * dice.sign();
            Box::new(move |_| size)
        }
        "viscous_asymmetry" => {
            let size = oil * dice.uniform(0.08, 0.35) * dice.sign();
            Box::new(move |m| size * m.velocity.abs())
        }
        "viscous_quadratic" => {
            let (exponent, size) = (dice.uniform(1.8, 2.2), oil * fastest * dice.uniform(0.25, 1.0));
            Box::new(move |m| size * (m.velocity.abs() / fastest).powf(exponent) * m.velocity.signum())
        }
        "viscous_sublinear" => {
            let (slow, size) = (fastest * dice.size(0.02, 0.1), dry * dice.uniform(0.2, 0.6));
            if dice.coin() {
                let whole = (fastest / slow).asinh();
                Box::new(move |m| size * (m.velocity / slow).asinh() / whole)
            } else {
                let index = dice.uniform(0.2, 0.6);
                let carreau = move |w: f64| w * (1.0 + (w / slow).powi(2)).powf(0.5 * (index - 1.0));
                Box::new(move |m| size * carreau(m.velocity) / carreau(fastest))
            }
        }
        "temperature_viscous" => {
            let slope = dice.uniform(0.01, 0.03);
            Box::new(move |m| oil * ((-slope * m.warmth).exp() - 1.0) * m.velocity)
        }
        "temperature_coulomb" => {
            let slope = dice.uniform(0.006, 0.02);
            Box::new(move |m| dry * ((-slope * m.warmth).exp() - 1.0) * m.bristle)
        }
        "torque_constant_saturation" => {
            let bend = dice.uniform(0.25, 0.6) / (joint.heaviest + 3.0 * dry);
            Box::new(move |m| m.torque / (1.0 - (bend * m.torque).powi(2).min(0.8)).sqrt() - m.torque)
        }
        "drift" => {
            let (size, soon) = (dry * dice.uniform(0.1, 0.4) * dice.sign(), last_s * dice.uniform(0.6, 3.0));
            let whole = 1.0 - (-last_s / soon).exp();
            Box::new(move |m| size * (1.0 - (-m.time / soon).exp()) / whole)
        }
        _ => Box::new(|_| 0.0),
    }
}

fn of_load(id: &str, joint: &Scale, dice: &mut Dice) -> Law {
    if !joint.has_load {
        return Box::new(|_| 0.0);
    }
    let Scale { fastest, heaviest, .. } = *joint;
    match id {
        "load_linear" => {
            let share = dice.uniform(0.02, 0.12);
            Box::new(move |m| share * m.load.abs() * m.bristle)
        }
        "load_quadratic" => {
            let (share, exponent) = (dice.uniform(0.03, 0.15), dice.uniform(1.8, 2.2));
            Box::new(move |m| share * heaviest * (m.load.abs() / heaviest).powf(exponent) * m.bristle)
        }
        "load_viscous" => {
            let share = dice.uniform(0.03, 0.15) / fastest;
            Box::new(move |m| share * m.load.abs() * m.velocity)
        }
        _ => {
            let (share, fades) = (dice.uniform(0.04, 0.15), lubrication(fastest * dice.size(0.02, 0.1), dice));
            Box::new(move |m| share * m.load.abs() * fades(m.velocity) * m.bristle)
        }
    }
}

fn of_angle(id: &str, joint: &Scale, dice: &mut Dice) -> Law {
    let (dry, phase, second_phase) = (joint.dry, dice.phase(), dice.phase());
    match id {
        "gravity" => {
            let size = dry * dice.uniform(0.1, 0.7);
            Box::new(move |m| size * (m.link + phase).sin())
        }
        "cogging" => {
            let (order, size) = (*dice.pick(&[4.0, 6.0, 7.0, 12.0, 14.0, 24.0]), dry * dice.uniform(0.08, 0.4));
            let second = dice.uniform(0.0, 0.3);
            Box::new(move |m| {
                size * ((order * m.motor + phase).sin() + second * (2.0 * order * m.motor + second_phase).sin())
            })
        }
        _ => {
            let (order, size) = (*dice.pick(&[1.0, 2.0, 3.0, 5.0, 8.0]), dry * dice.uniform(0.08, 0.35));
            let band = dice.uniform(0.0, 0.25);
            Box::new(move |m| {
                let wave = (order * m.link + phase).sin() + band * ((order + 1.0) * m.link + second_phase).sin();
                size * wave * m.bristle
            })
        }
    }
}

fn outside(id: &str, joint: &Scale, dice: &mut Dice) -> Law {
    let Scale { dry, fastest, last_s, .. } = *joint;
    let size = dry * dice.uniform(0.3, 0.8);
    match id {
        "speed_hump" => {
            let (middle, wide) = (fastest * dice.uniform(0.25, 0.55), fastest * dice.uniform(0.04, 0.09));
            Box::new(move |m| size * (-((m.velocity.abs() - middle) / wide).powi(2)).exp() * m.bristle)
        }
        "bump_angle" => {
            let (middle, wide) = (dice.phase(), dice.uniform(0.08, 0.2));
            Box::new(move |m| {
                let away = (m.link - middle + 0.5 * TAU).rem_euclid(TAU) - 0.5 * TAU;
                1.5 * size / (1.0 + (away / wide).powi(4)) * m.bristle
            })
        }
        "driving_asymmetry" => Box::new(move |m| {
            let power = m.torque * m.velocity / (dry * fastest);
            0.5 * size * (power / 0.05).tanh().max(0.0) * m.bristle
        }),
        "stick_spot_time" => {
            let (at, lasts) = (last_s * dice.uniform(0.2, 0.7), last_s * dice.uniform(0.04, 0.12));
            Box::new(move |m| if (m.time - at).abs() < 0.5 * lasts { size * m.bristle } else { 0.0 })
        }
        _ => {
            let count = dice.uniform(3.0, 8.0) as usize;
            let events: Vec<(f64, f64, f64)> =
                (0..count).map(|_| (dice.uniform(0.0, last_s), dice.uniform(0.4, 2.5), size * dice.sign())).collect();
            Box::new(move |m| {
                events.iter().filter(|(at, lasts, _)| (0.0..*lasts).contains(&(m.time - at))).map(|e| e.2).sum()
            })
        }
    }
}

/// Whether a law acts on the motion, through the bristles or in addition to them. The torque constant only changes
/// the reading.
pub fn moves_the_joint(id: &str) -> bool {
    !matches!(id, "torque_constant_saturation" | "presliding" | "intermittent")
}
