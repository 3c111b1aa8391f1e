//! Encoder runs: two encoders on one shaft, one of them eccentric, tilted, delayed, warm, loose.

use super::{Coloured, Dice, rounded, table};
use jointbench_instrument::{Kind, Meta, RunTable};
use std::f64::consts::TAU;

pub const SINGLES: &[&str] = &[
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

pub const PAIRS: &[[&str; 2]] = &[
    ["harmonic_1", "harmonic_2"],
    ["harmonic_1", "pole_period"],
    ["direction_hysteresis", "harmonic_2"],
    ["temperature_drift", "harmonic_1"],
];

const STEP_S: f64 = 1e-3;

/// Error of the test encoder over the true angle. Parameters are zero if an effect is not hidden.
#[derive(Default)]
struct Ring {
    pole_pairs: f64,
    delay_s: f64,
    off_centre: f64,
    tilt: f64,
    waves: (f64, f64),
    /// Offset and unequal size of the two waves within a pole pair.
    crooked: (f64, f64),
    play: f64,
    warm: f64,
    slip: (f64, f64),
    zero: f64,
    zeros: [f64; 3],
    phase: f64,
}

impl Ring {
    fn hide(&mut self, effect: &str, last_s: f64, dice: &mut Dice) {
        match effect {
            "delay" => self.delay_s = dice.size(2e-5, 9e-5) * dice.sign(),
            "harmonic_1" => self.off_centre = dice.size(1e-4, 4e-3),
            "harmonic_2" => self.tilt = dice.size(1e-4, 3e-3),
            "harmonic_n" => self.waves = (*dice.pick(&[3.0, 4.0, 5.0, 6.0, 8.0, 12.0]), dice.size(1e-4, 1e-3)),
            "pole_period" => {
                let size = dice.size(6e-5, 4e-4) * self.pole_pairs;
                self.crooked = (size, size * dice.uniform(0.6, 1.5));
            }
            "direction_hysteresis" => self.play = dice.size(4e-5, 4e-4),
            "temperature_drift" => self.warm = dice.size(2e-5, 2e-4) * dice.sign(),
            "slip" => self.slip = (dice.uniform(0.2, 0.8) * last_s, dice.size(2e-4, 4e-3) * dice.sign()),
            _ => self.zeros = [0.0, 8e-4 * dice.normal() + 3e-4, 8e-4 * dice.normal() - 3e-4],
        }
    }

    /// Angle of the encoder behind its play, at first without a past.
    fn carried(&self, before: f64, shaft: f64) -> f64 {
        if before.is_nan() { shaft } else { before.clamp(shaft - self.play, shaft + self.play) }
    }

    fn read(&self, angle: f64, time: f64, warmth: f64, repeat: usize) -> f64 {
        let jump = if time > self.slip.0 { self.slip.1 } else { 0.0 };
        angle + self.error(angle) + self.zero + self.warm * warmth + jump + self.zeros[repeat]
    }

    /// Error of the reading at a true angle.
    fn error(&self, angle: f64) -> f64 {
        let (s, c) = (angle + self.phase).sin_cos();
        let centre = (s * self.off_centre).atan2(1.0 - c * self.off_centre);
        let tilt = 2.0 * self.tilt;
        let tilted = (-s * c * tilt).atan2(1.0 - s * s * tilt);
        let (h, size) = self.waves;
        let (ps, pc) = (self.pole_pairs * angle).sin_cos();
        let (shift, gain) = self.crooked;
        // Angle between the true phase and that of a shifted, stretched pair of waves.
        let (y, x) = (ps * (1.0 + gain) + shift, pc);
        let inside = (y * pc - x * ps).atan2(x * pc + y * ps) / self.pole_pairs;
        centre + tilted + size * (h * angle + self.phase).sin() + inside
    }
}

const NAMES: [&str; 7] =
    ["time_s", "reference_position_rad", "test_position_rad", "velocity_rad_s", "temperature_c", "segment", "repeat"];

pub fn make(dice: &mut Dice, hidden: &[&str]) -> RunTable {
    let pole_pairs = *dice.pick(&[16u32, 32, 64]);
    let slow = dice.uniform(1.0, 2.5);
    let speeds = [slow, dice.uniform(40.0, 60.0), dice.uniform(80.0, 110.0), dice.uniform(140.0, 170.0)];
    let lasts_s = [TAU / slow * dice.uniform(1.1, 1.5), 1.2, 1.2, 1.2];
    let last_s: f64 = 6.0 * lasts_s.iter().sum::<f64>();
    let mut ring = Ring { pole_pairs: f64::from(pole_pairs), phase: dice.phase(), ..Ring::default() };
    let known_delay = !hidden.contains(&"delay") && dice.coin();
    if known_delay {
        ring.hide("delay", last_s, dice);
    }
    hidden.iter().for_each(|h| ring.hide(h, last_s, dice));
    ring.zero = dice.uniform(-3.0, 3.0);
    let (test_bits, reference_bits) = (*dice.pick(&[16u32, 18]), *dice.pick(&[14u32, 16]));
    let (test_step, reference_step) = (TAU / f64::from(1u32 << test_bits), TAU / f64::from(1u32 << reference_bits));
    let mut noise = Coloured::new(dice.size(3e-5, 8e-5), dice.uniform(0.1, 0.5), dice.uniform(0.7, 0.95));
    let scatter = dice.uniform(1e-6, 5e-6);
    let (heating, heats_s) = (dice.uniform(4.0, 10.0), dice.uniform(15.0, 60.0));

    let (mut angle, mut velocity, mut carried, mut segment) = (dice.phase(), 0.0f64, f64::NAN, 0.0);
    let mut time = 0.0f64;
    let mut columns = vec![Vec::new(); NAMES.len()];
    for repeat in 0..3 {
        for (speed, lasts_s) in speeds.iter().zip(lasts_s) {
            for side in [1.0, -1.0] {
                let (moved, pace) = (scatter * dice.normal(), speed * (1.0 + 1e-3 * dice.normal()));
                for _ in 0..(lasts_s / STEP_S) as usize {
                    time += STEP_S;
                    velocity += (side * pace - velocity).clamp(-3.0, 3.0);
                    angle += velocity * STEP_S;
                    carried = ring.carried(carried, angle - velocity * ring.delay_s);
                    let warmth = heating * (1.0 - (-time / heats_s).exp());
                    let read = ring.read(carried, time, warmth, repeat);
                    let values = [
                        time,
                        rounded(angle + 4e-5 * dice.normal(), reference_step).rem_euclid(TAU),
                        rounded(read + moved + noise.next(dice), test_step).rem_euclid(TAU),
                        velocity * (1.0 + 2e-3 * dice.normal()),
                        rounded(24.0 + warmth, 0.1),
                        segment,
                        repeat as f64,
                    ];
                    columns.iter_mut().zip(values).for_each(|(c, v)| c.push(v));
                }
                segment += 1.0;
            }
        }
    }
    let meta = Meta {
        kind: Some(Kind::Encoder),
        reference_bits: Some(reference_bits),
        test_bits: Some(test_bits),
        pole_pairs: Some(pole_pairs),
        baseline: if known_delay { vec!["offset".into(), "delay".into()] } else { vec!["offset".into()] },
        sample_rate_hz: Some(1.0 / STEP_S),
        ..Meta::default()
    };
    table(meta, NAMES.map(String::from).into(), columns)
}
