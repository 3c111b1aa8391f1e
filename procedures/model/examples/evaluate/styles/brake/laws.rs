//! Torque of a hysteresis brake, by laws of the literature that differ from the library's. Currents as shares of the
//! rated current.

use super::Run;
use crate::made::Dice;
use crate::styles::waves::{events, preisach};

pub const EFFECTS: &[&str] =
    &["drag", "saturation", "hysteresis", "velocity_dependence", "cogging", "temperature_dependence"];
pub const OUTSIDE: &[&str] = &["current_window", "intermittent", "rub_at_angle"];

/// Contribution of a cause to the torque [Nm].
pub fn torque(id: &str, run: &Run, dice: &mut Dice) -> Vec<f64> {
    let full = run.full_nm;
    let rows = 0..run.time.len();
    match id {
        "drag" => vec![full * dice.size(0.003, 0.03); run.time.len()],
        "torque_per_current" => run.current.iter().map(|i| full * i).collect(),
        "saturation" => {
            let (law, size) = (saturation(dice), dice.uniform(0.5, 1.0));
            run.current.iter().map(|i| full * size * (law(*i) - i)).collect()
        }
        "hysteresis" => {
            let inputs: Vec<f64> = run.current.iter().map(|i| 2.0 * i - 1.0).collect();
            let bent = preisach(&inputs, dice.uniform(-0.3, 0.3), dice.uniform(0.3, 0.8));
            let size = full * dice.size(0.02, 0.12);
            // Magnetisation has hysteresis: more torque while the current falls.
            bent.iter().zip(&inputs).map(|(b, i)| size * (i - b)).collect()
        }
        "velocity_dependence" => {
            let (size, of_current) = (full * dice.uniform(0.02, 0.08), dice.coin());
            rows.map(|i| size * run.velocity[i] / run.fastest * if of_current { run.current[i] } else { 1.0 }).collect()
        }
        "cogging" => {
            let (size, phase, second_phase) = (full * dice.size(0.008, 0.04), dice.phase(), dice.phase());
            let (order, second) = (f64::from(run.poles), dice.uniform(0.0, 0.3));
            let wave = |a: f64| (order * a + phase).sin() + second * (2.0 * order * a + second_phase).sin();
            let excited = dice.coin();
            rows.map(|i| size * wave(run.angle[i]) * if excited { run.current[i] } else { 0.5 }).collect()
        }
        "temperature_dependence" => {
            let slope = dice.uniform(0.002, 0.008);
            rows.map(|i| full * run.current[i] * ((-slope * run.warmth[i]).exp() - 1.0)).collect()
        }
        "current_window" => {
            let (at, wide, size) = (dice.uniform(0.35, 0.65), dice.uniform(0.05, 0.1), full * dice.uniform(0.02, 0.06));
            let middle = 0.5 * run.fastest;
            rows.map(|i| {
                let side = ((run.velocity[i] - middle) / (0.2 * run.fastest)).tanh();
                size * (-((run.current[i] - at) / wide).powi(2)).exp() * side
            })
            .collect()
        }
        "rub_at_angle" => {
            let (at, wide, size) = (dice.phase(), dice.uniform(0.1, 0.25), full * dice.uniform(0.02, 0.06));
            rows.map(|i| size * (-((0.5 * (run.angle[i] - at)).sin() / (0.5 * wide)).powi(2)).exp()).collect()
        }
        _ => {
            let size = full * dice.uniform(0.02, 0.06);
            events(run.time.len(), dice).iter().map(|e| size * e).collect()
        }
    }
}

/// A curve from 0 to about 1 over the current.
fn saturation(dice: &mut Dice) -> Box<dyn Fn(f64) -> f64> {
    let bend = dice.uniform(0.35, 0.9);
    let langevin = |x: f64| if x < 1e-3 { x / 3.0 } else { 1.0 / x.tanh() - 1.0 / x };
    match dice.uniform(0.0, 4.0) as u32 {
        0 => Box::new(move |i: f64| (i / bend).tanh()),
        1 => Box::new(move |i: f64| 1.4 * langevin(3.0 * i.max(0.0) / bend)),
        2 => Box::new(move |i: f64| 1.5 * i / (bend + i.abs())),
        _ => Box::new(move |i: f64| {
            let x = i.max(0.0) / (0.7 * bend);
            x.powi(2) / (1.0 + x.powi(2))
        }),
    }
}
