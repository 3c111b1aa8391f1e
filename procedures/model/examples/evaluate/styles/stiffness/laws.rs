//! Twist of a joint, by laws of the literature that differ from the library's.

use super::Run;
use crate::made::Dice;
use crate::styles::waves::{bouc_wen, events, lag, preisach};
use std::f64::consts::{FRAC_2_PI, TAU};

pub const OF_TORQUE: &[&str] = &["backlash", "hardening", "torsional_hysteresis", "creep", "temperature_compliance"];
pub const OF_MOTION: &[&str] = &["directional_offset", "transmission_error", "delay"];
pub const OUTSIDE: &[&str] = &["intermittent", "soft_window"];
pub const OUTSIDE_OF_MOTION: &[&str] = &["tooth_at_angle", "intermittent", "soft_window"];

/// Contribution of a cause to the twist [rad], with a size in shares of the twist at full torque.
pub fn twist(id: &str, run: &Run, dice: &mut Dice) -> Vec<f64> {
    let size = run.full_twist * dice.size(0.02, 0.12);
    let shares: Vec<f64> = run.torque.iter().map(|t| t / run.full_nm).collect();
    let of_shares = |law: &dyn Fn(f64) -> f64| shares.iter().map(|s| law(*s)).collect::<Vec<f64>>();
    match id {
        "backlash" => {
            let narrow = dice.size(0.002, 0.012);
            of_shares(&|s| size * FRAC_2_PI * (s / narrow).atan())
        }
        "hardening" => hardening(&shares, size, dice),
        "torsional_hysteresis" => {
            let bent = if dice.coin() {
                preisach(&shares, 0.0, dice.uniform(0.3, 0.9))
            } else {
                bouc_wen(&shares, dice.uniform(0.1, 0.5), dice.uniform(1.0, 2.0))
            };
            // The part in phase with the torque is compliance.
            bent.iter().zip(&shares).map(|(b, s)| size * (b - s)).collect()
        }
        "creep" => creep(&shares, run, size * 1.5, dice),
        "temperature_compliance" => {
            let slope = dice.uniform(0.004, 0.015);
            let soft = |(s, w): (&f64, &f64)| run.full_twist * s * ((slope * w).exp() - 1.0);
            shares.iter().zip(&run.warmth).map(soft).collect()
        }
        "directional_offset" => bouc_wen(&run.link, dice.size(2e-4, 2e-3), 1.0).iter().map(|d| size * d).collect(),
        "transmission_error" => {
            let (order, phase, second_phase) =
                (*dice.pick(&[1.0, 2.0, 3.0, 6.0, 11.0, 20.0]), dice.phase(), dice.phase());
            let band = dice.uniform(0.0, 0.3);
            run.link
                .iter()
                .map(|q| size * ((order * q + phase).sin() + band * (2.0 * order * q + second_phase).sin()))
                .collect()
        }
        "delay" => {
            // The motor encoder passes a filter, the link encoder does not.
            let delay_s = dice.size(0.3, 4.0) * 0.5 * size / run.speed.max(1e-6);
            let after = lag(&run.link, (1.0 / (run.rate_hz * delay_s)).min(1.0));
            after.iter().zip(&run.link).map(|(a, q)| a - q).collect()
        }
        "tooth_at_angle" => {
            let (at, wide) = (dice.phase(), dice.uniform(0.04, 0.12));
            let away = |q: f64| (q - at + 0.5 * TAU).rem_euclid(TAU) - 0.5 * TAU;
            run.link.iter().map(|q| 2.0 * size * (-(away(*q) / wide).powi(2)).exp()).collect()
        }
        "soft_window" => {
            let (at, wide) = (dice.uniform(0.3, 0.6), dice.uniform(0.05, 0.12));
            of_shares(&|s| 1.5 * size * (-((s.abs() - at) / wide).powi(2)).exp())
        }
        _ => events(shares.len(), dice).iter().map(|e| size * e).collect(),
    }
}

fn hardening(shares: &[f64], size: f64, dice: &mut Dice) -> Vec<f64> {
    let (first, second) = (dice.uniform(0.1, 0.3), dice.uniform(0.45, 0.75));
    let (soft, medium) = (dice.uniform(1.6, 3.0), dice.uniform(1.1, 1.5));
    let pieces = |s: f64| {
        let a = s.abs();
        let way = soft * a.min(first) + medium * (a.min(second) - first).max(0.0) + (a - second).max(0.0);
        way * s.signum()
    };
    let law: Box<dyn Fn(f64) -> f64> = match dice.uniform(0.0, 3.0) as u32 {
        // Stiffness in three sections: catalogues of strain waves.
        0 => Box::new(move |s: f64| 3.0 * size * (pieces(s) - s)),
        1 => Box::new(move |s: f64| 3.0 * size * (s.abs().powf(0.6) * s.signum() - s)),
        // Torque = twist + b·twist³.
        _ => Box::new(move |s: f64| {
            let mut twist = s;
            (0..20).for_each(|_| twist -= (twist + 0.4 * twist.powi(3) - s) / (1.0 + 1.2 * twist * twist));
            4.0 * size * (twist - s)
        }),
    };
    shares.iter().map(|s| law(*s)).collect()
}

/// One, two or many retarded elements: Kelvin–Voigt, double, logarithmic.
fn creep(shares: &[f64], run: &Run, size: f64, dice: &mut Dice) -> Vec<f64> {
    let slow = dice.size(0.4, 3.0);
    let parts: Vec<(f64, f64)> = match dice.uniform(0.0, 3.0) as u32 {
        0 => vec![(slow, 1.0)],
        1 => vec![(slow, 0.6), (6.0 * slow, 0.4)],
        _ => (-1..=2).map(|k| (slow * 4f64.powi(k), 0.25)).collect(),
    };
    let mut twist = vec![0.0; shares.len()];
    for (slow, part) in parts {
        let after = lag(shares, 1.0 - (-1.0 / (run.rate_hz * slow)).exp());
        twist.iter_mut().zip(after).for_each(|(t, a)| *t += size * part * a);
    }
    twist
}
