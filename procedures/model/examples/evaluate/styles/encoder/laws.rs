//! Errors of an encoder, by geometry and physics.

use super::Run;
use crate::made::Dice;
use crate::styles::waves::{events, lag, play};
use std::f64::consts::TAU;

pub const EFFECTS: &[&str] = &[
    "delay",
    "harmonic_1",
    "harmonic_2",
    "harmonic_n",
    "pole_period",
    "direction_hysteresis",
    "temperature_drift",
    "slip",
    "startup_offset",
];
pub const OUTSIDE: &[&str] = &["intermittent", "scratch_at_angle"];

/// Contribution of a cause to the difference of the two readings [rad].
pub fn error(id: &str, run: &Run, dice: &mut Dice) -> Vec<f64> {
    let size = run.noise * dice.size(0.3, 6.0);
    let phase = dice.phase();
    let of_angle = |law: &dyn Fn(f64) -> f64| run.angle.iter().map(|a| law(*a)).collect::<Vec<f64>>();
    match id {
        "delay" => {
            let delay_s = size / run.fastest;
            let after = lag(&run.angle, (1.0 / (run.rate_hz * delay_s)).min(1.0));
            if 1.0 / (run.rate_hz * delay_s) > 1.0 {
                // Shorter than a row: the filter has settled within it.
                return run.velocity.iter().map(|v| -delay_s * v).collect();
            }
            after.iter().zip(&run.angle).map(|(a, q)| a - q).collect()
        }
        // An eccentric disc: the angle relative to its true centre.
        "harmonic_1" => of_angle(&|a| (size * (a + phase).sin()).atan2(1.0 + size * (a + phase).cos())),
        // A tilted disc: the projection of a circle is an ellipse.
        "harmonic_2" => of_angle(&|a| {
            let b = a + phase;
            (b.sin() * (1.0 - 2.0 * size)).atan2(b.cos()) - b.sin().atan2(b.cos())
        }),
        "harmonic_n" => {
            let (order, band) = (*dice.pick(&[3.0, 4.0, 5.0, 6.0, 10.0]), dice.uniform(0.0, 0.3));
            of_angle(&|a| size * ((order * a + phase).sin() + band * (2.0 * order * a).sin()))
        }
        "pole_period" => {
            let (order, second) = (f64::from(run.pole_pairs), dice.uniform(0.3, 0.9));
            of_angle(&|a| size * ((order * a + phase).sin() + second * (2.0 * order * a).cos()))
        }
        "direction_hysteresis" => play(&run.angle, size).iter().zip(&run.angle).map(|(p, a)| p - a).collect(),
        "temperature_drift" => {
            let slope = 0.03 * dice.sign();
            run.warmth.iter().map(|w| 4.0 * size * ((slope * w).exp() - 1.0)).collect()
        }
        "slip" => {
            let last = run.time.last().copied().unwrap_or(0.0);
            let at = last * dice.uniform(0.2, 0.8);
            run.time.iter().map(|t| size / (1.0 + (-(t - at) / 0.005).clamp(-50.0, 50.0).exp())).collect()
        }
        "startup_offset" => {
            let zeros: Vec<f64> = (0..8).map(|_| 1.5 * size * dice.normal()).collect();
            run.repeat.iter().map(|r| if *r == 0.0 { 0.0 } else { zeros[*r as usize] }).collect()
        }
        "scratch_at_angle" => {
            let wide = dice.uniform(0.05, 0.15);
            let away = |a: f64| (a + phase + 0.5 * TAU).rem_euclid(TAU) - 0.5 * TAU;
            of_angle(&|a| 3.0 * size * (-(away(a) / wide).powi(2)).exp())
        }
        _ => events(run.time.len(), dice).iter().map(|e| 3.0 * size * e).collect(),
    }
}
