//! Torques and angles of stiffness runs.

use crate::made::Dice;
use crate::styles::waves::{lines, multisine, random_walk, sine, stairs};

pub const STYLES: &[&str] = &[
    "locked_sine",
    "locked_triangle",
    "locked_steps",
    "turning_sine",
    "turning_levels",
    "nested_loops",
    "random_torque",
];

pub fn is_turning(style: &str) -> bool {
    style.starts_with("turning")
}

/// Torque as a share of the full torque, link speed as a share of its own, and the number of the step, for one
/// repeat.
pub struct Program {
    pub torque: Vec<f64>,
    pub speed: Vec<f64>,
    pub segment: Vec<f64>,
}

pub fn draw(style: &str, rate_hz: f64, dice: &mut Dice) -> Program {
    let slow = dice.size(0.08, 0.4);
    let ends = |peaks: &[f64]| -> Vec<(f64, f64)> {
        let mut at = 0.0f64;
        let mut corner = |to: f64| {
            let lasts = (to - at).abs() / (4.0 * slow);
            at = to;
            (lasts.max(0.05), to)
        };
        std::iter::once((0.05, 0.0)).chain(peaks.iter().map(|p| corner(*p))).collect()
    };
    let mut torque = match style {
        "locked_sine" => sine(slow, 4.0, rate_hz),
        "locked_triangle" => lines(&ends(&[1.0, -1.0, 1.0, -1.0, 1.0, -1.0, 0.0]), rate_hz),
        "nested_loops" => {
            let peaks: Vec<f64> = [1.0, 0.8, 0.55, 0.35, 0.15].iter().flat_map(|p| [*p, -p]).chain([0.0]).collect();
            lines(&ends(&peaks), rate_hz)
        }
        "locked_steps" | "turning_levels" => {
            let count = dice.uniform(5.0, 8.0) as usize;
            let mut levels: Vec<f64> =
                (1..=count).flat_map(|i| [i as f64 / count as f64, -(i as f64) / count as f64]).collect();
            if dice.coin() {
                dice.shuffle(&mut levels);
            }
            stairs(&levels, dice.uniform(0.1, 0.3), dice.uniform(0.8, 2.0), rate_hz)
        }
        "turning_sine" => sine(slow, 5.0, rate_hz),
        _ if dice.coin() => multisine(dice.uniform(20.0, 40.0), rate_hz, dice),
        _ => random_walk(dice.uniform(20.0, 40.0), rate_hz, dice),
    };
    torque.push(torque.last().copied().unwrap_or(0.0));
    let speed = speed(style, torque.len(), slow, rate_hz, dice);
    let steps = if style.ends_with("steps") || style.ends_with("levels") { 10.0 } else { 6.0 };
    let segment = (0..torque.len()).map(|i| (steps * i as f64 / torque.len() as f64).floor()).collect();
    Program { torque, speed, segment }
}

/// A turning joint moves back and forth with separate periods.
fn speed(style: &str, rows: usize, slow: f64, rate_hz: f64, dice: &mut Dice) -> Vec<f64> {
    if !is_turning(style) {
        return vec![0.0; rows];
    }
    let (period_s, turns) = (dice.uniform(0.7, 1.6) / slow, dice.uniform(0.05, 0.15));
    let wave = |i: usize| (std::f64::consts::TAU * i as f64 / (rate_hz * period_s)).sin();
    (0..rows).map(|i| (wave(i) / turns).clamp(-1.0, 1.0)).collect()
}
