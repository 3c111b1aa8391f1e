//! Excitations over time of several kinds, between −1 and 1.

use crate::made::Dice;
use std::f64::consts::TAU;

/// Straight lines between corners, each after a number of seconds.
pub fn lines(corners: &[(f64, f64)], rate_hz: f64) -> Vec<f64> {
    let mut values = Vec::new();
    let mut from = corners.first().map_or(0.0, |c| c.1);
    for (lasts_s, to) in corners {
        let rows = (lasts_s * rate_hz).round().max(1.0) as usize;
        values.extend((0..rows).map(|i| from + (to - from) * (i + 1) as f64 / rows as f64));
        from = *to;
    }
    values
}

/// Levels that are approached in `rise_s` and held.
pub fn stairs(levels: &[f64], rise_s: f64, hold_s: f64, rate_hz: f64) -> Vec<f64> {
    lines(&levels.iter().flat_map(|l| [(rise_s, *l), (hold_s, *l)]).collect::<Vec<_>>(), rate_hz)
}

pub fn sine(frequency: f64, periods: f64, rate_hz: f64) -> Vec<f64> {
    (0..(periods / frequency * rate_hz) as usize).map(|i| (TAU * frequency * i as f64 / rate_hz).sin()).collect()
}

pub fn multisine(lasts_s: f64, rate_hz: f64, dice: &mut Dice) -> Vec<f64> {
    let parts: Vec<(f64, f64, f64)> =
        (0..6).map(|k| (dice.size(0.03, 0.09) * 1.6f64.powi(k), 0.8f64.powi(k), dice.phase())).collect();
    let wave = |t: f64| -> f64 { parts.iter().map(|(f, a, p)| a * (TAU * f * t + p).sin()).sum() };
    scaled((0..(lasts_s * rate_hz) as usize).map(|i| wave(i as f64 / rate_hz)).collect())
}

/// Corners at random levels.
pub fn random_walk(lasts_s: f64, rate_hz: f64, dice: &mut Dice) -> Vec<f64> {
    let (mut corners, mut time) = (vec![(0.01, 0.0)], 0.0);
    while time < lasts_s {
        let step = dice.uniform(0.8, 3.0);
        corners.push((step, dice.uniform(-1.0, 1.0)));
        time += step;
    }
    lines(&corners, rate_hz)
}

fn scaled(mut values: Vec<f64>) -> Vec<f64> {
    let peak = values.iter().fold(0.0f64, |m, v| m.max(v.abs()));
    values.iter_mut().for_each(|v| *v /= peak);
    values
}

/// First-order lag of a column, from its first value.
pub fn lag(values: &[f64], share: f64) -> Vec<f64> {
    let mut state = values.first().copied().unwrap_or(0.0);
    let next = |v: &f64| {
        state += (v - state) * share;
        state
    };
    values.iter().map(next).collect()
}

/// Relays on a triangle of thresholds with a smooth density (Preisach 1935): −1 to 1 over inputs between −1 and 1.
pub fn preisach(inputs: &[f64], middle: f64, wide: f64) -> Vec<f64> {
    const GRID: usize = 24;
    let level = |i: usize| -1.0 + 2.0 * (i as f64 + 0.5) / GRID as f64;
    let mut relays = Vec::new();
    for up in 0..GRID {
        for down in 0..up {
            let (gap, centre) = (level(up) - level(down), 0.5 * (level(up) + level(down)));
            let weight = (-(gap / wide).powi(2) - ((centre - middle) / 0.6).powi(2)).exp();
            relays.push((level(up), level(down), weight, -1.0));
        }
    }
    let all: f64 = relays.iter().map(|r| r.2).sum();
    let mut state: f64 = -all;
    let mut last = f64::NAN;
    let mut after = |input: f64| {
        if input != last {
            for (up, down, weight, sign) in &mut relays {
                let next = if input >= *up {
                    1.0
                } else if input <= *down {
                    -1.0
                } else {
                    *sign
                };
                state += *weight * (next - *sign);
                *sign = next;
            }
        }
        last = input;
        state / all
    };
    inputs.iter().map(|i| after(*i)).collect()
}

/// Bouc 1967, Wen 1976: a state that follows an input over a reach and saturates smoothly.
pub fn bouc_wen(inputs: &[f64], reach: f64, sharp: f64) -> Vec<f64> {
    let (mut state, mut last) = (0.0f64, inputs.first().copied().unwrap_or(0.0));
    let mut after = |input: f64| {
        let way = (input - last) / reach;
        let closing = 0.5 * (way.abs() * state * state.abs().powf(sharp - 1.0) + way * state.abs().powf(sharp));
        state = (state + way - closing).clamp(-1.0, 1.0);
        last = input;
        state
    };
    inputs.iter().map(|i| after(*i)).collect()
}

/// A gap that an input crosses before it moves the output.
pub fn play(inputs: &[f64], half: f64) -> Vec<f64> {
    let mut state = inputs.first().copied().unwrap_or(0.0);
    let mut after = |input: f64| {
        state = state.clamp(input - half, input + half);
        state
    };
    inputs.iter().map(|i| after(*i)).collect()
}

/// Events that do not repeat: start, end and size as shares.
pub fn events(rows: usize, dice: &mut Dice) -> Vec<f64> {
    let mut values = vec![0.0; rows];
    for _ in 0..dice.uniform(3.0, 9.0) as usize {
        let from = dice.uniform(0.0, rows as f64) as usize;
        let to = (from + (rows as f64 * dice.size(0.003, 0.03)) as usize).min(rows);
        let size = dice.uniform(0.5, 1.0) * dice.sign();
        values[from..to].fill(size);
    }
    values
}
