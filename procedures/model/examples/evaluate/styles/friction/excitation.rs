//! Excitations of a joint: speeds as shares of the fastest, loads as shares of the heaviest, by milliseconds.

use crate::made::Dice;
use std::f64::consts::TAU;

pub const TICK_S: f64 = 1e-3;

pub const STYLES: &[&str] =
    &["stair_random", "stair_sorted", "step_hold", "trapezoid", "sine", "chirp", "multisine", "pick_place", "creep"];

/// One repeat.
#[derive(Default)]
pub struct Program {
    pub speed: Vec<f64>,
    pub segment: Vec<f64>,
    /// Change of speed in one tick, as a share of the fastest.
    rise: f64,
}

impl Program {
    pub fn draw(style: &str, dice: &mut Dice) -> Self {
        let mut program = Self { rise: TICK_S / dice.uniform(0.12, 0.4), ..Self::default() };
        match style {
            "stair_random" | "stair_sorted" => program.stairs(style == "stair_random", dice),
            "step_hold" => program.step_and_hold(dice),
            "trapezoid" => program.trapezoids(dice),
            "sine" => program.sines(dice),
            "chirp" => program.chirp(dice),
            "multisine" => program.multisine(dice),
            "pick_place" => program.pick_and_place(dice),
            _ => program.creep(dice),
        }
        program.hold(0.0, dice.uniform(0.1, 0.4));
        program
    }

    /// Ramps to a speed and holds it: one segment.
    fn hold(&mut self, speed: f64, lasts_s: f64) {
        let number = self.segment.last().map_or(0.0, |s| s + 1.0);
        let mut now = self.speed.last().copied().unwrap_or(0.0);
        let mut left = lasts_s;
        while left > 0.0 {
            let ramps = (speed - now).abs() > 1e-9;
            now += (speed - now).clamp(-self.rise, self.rise);
            left -= if ramps { 0.0 } else { TICK_S };
            self.speed.push(now);
            self.segment.push(number);
        }
    }

    /// Speeds by a function of time: one segment.
    fn wave(&mut self, lasts_s: f64, speed: impl Fn(f64) -> f64) {
        let number = self.segment.last().map_or(0.0, |s| s + 1.0);
        for tick in 0..(lasts_s / TICK_S) as usize {
            self.speed.push(speed(tick as f64 * TICK_S));
            self.segment.push(number);
        }
    }

    fn stairs(&mut self, random: bool, dice: &mut Dice) {
        let (count, slow) = (dice.uniform(6.0, 11.0) as usize, dice.uniform(0.02, 0.08));
        let lasts_s = dice.uniform(0.8, 1.8);
        let level = |i: usize| slow.powf(1.0 - i as f64 / (count - 1) as f64);
        let mut levels: Vec<f64> = (0..count).flat_map(|i| [level(i), -level(i)]).collect();
        if random {
            dice.shuffle(&mut levels);
        } else {
            levels.sort_by(f64::total_cmp);
        }
        levels.iter().for_each(|speed| self.hold(*speed, lasts_s));
    }

    fn step_and_hold(&mut self, dice: &mut Dice) {
        self.rise = TICK_S / dice.uniform(0.02, 0.06);
        for _ in 0..dice.uniform(6.0, 10.0) as usize {
            let speed = dice.size(0.05, 1.0) * dice.sign();
            for speed in [speed, 0.0, -speed * dice.uniform(0.7, 1.3).min(1.0 / speed.abs()), 0.0] {
                self.hold(speed, if speed == 0.0 { dice.uniform(0.2, 0.6) } else { dice.uniform(0.5, 1.2) });
            }
        }
    }

    fn trapezoids(&mut self, dice: &mut Dice) {
        for _ in 0..dice.uniform(4.0, 9.0) as usize {
            let (speed, lasts_s) = (dice.uniform(0.15, 1.0), dice.uniform(0.3, 1.2));
            self.hold(speed, lasts_s);
            self.hold(-speed, lasts_s);
        }
    }

    fn sines(&mut self, dice: &mut Dice) {
        for _ in 0..dice.uniform(2.0, 4.0) as usize {
            let (size, frequency) = (dice.uniform(0.2, 1.0), dice.size(0.12, 0.9));
            let periods = (dice.uniform(8.0, 16.0) * frequency).ceil();
            self.wave(periods / frequency, |t| size * (TAU * frequency * t).sin());
        }
    }

    fn chirp(&mut self, dice: &mut Dice) {
        let (from, to, lasts_s) = (dice.size(0.06, 0.15), dice.size(1.0, 2.5), dice.uniform(18.0, 40.0));
        let rate = (to / from).ln() / lasts_s;
        let size = dice.uniform(0.6, 1.0);
        let phase = |t: f64| TAU * from * ((rate * t).exp() - 1.0) / rate;
        self.wave(lasts_s, |t| size * phase(t).sin() / (1.0 + 0.4 * from * (rate * t).exp()));
    }

    fn multisine(&mut self, dice: &mut Dice) {
        let (base, lasts_s) = (dice.uniform(0.05, 0.12), dice.uniform(16.0, 40.0));
        let lines: Vec<(f64, f64, f64)> =
            (1..=7).map(|k| (base * f64::from(k * k) * 0.6 + base, 1.0 / f64::from(k).sqrt(), dice.phase())).collect();
        let wave = |t: f64| -> f64 { lines.iter().map(|(f, a, p)| a * (TAU * f * t + p).sin()).sum() };
        let peak = (0..4000).map(|i| wave(0.01 * f64::from(i)).abs()).fold(0.0, f64::max);
        self.wave(lasts_s, |t| wave(t) / peak * (t / 0.5).min(1.0));
    }

    fn pick_and_place(&mut self, dice: &mut Dice) {
        let mut at = 0.0;
        for _ in 0..dice.uniform(10.0, 18.0) as usize {
            let next = dice.uniform(-1.0, 1.0);
            let way: f64 = next - at;
            // Minimum jerk: its peak speed is 15/8 of the mean.
            let lasts_s = (1.875 * way.abs() / dice.uniform(0.3, 1.0)).max(0.25);
            self.wave(lasts_s, |t| 30.0 * way / lasts_s * (t / lasts_s * (1.0 - t / lasts_s)).powi(2));
            self.wave(dice.uniform(0.2, 0.8), |_| 0.0);
            at = next;
        }
    }

    fn creep(&mut self, dice: &mut Dice) {
        let slow = dice.uniform(0.02, 0.08);
        for _ in 0..dice.uniform(5.0, 8.0) as usize {
            let speed = slow * dice.uniform(0.15, 1.0);
            let lasts_s = dice.uniform(2.0, 4.0);
            self.hold(speed, lasts_s);
            self.hold(-speed, lasts_s);
        }
        self.hold(slow, dice.uniform(1.0, 3.0));
    }
}

/// Load of a brake over a whole run: levels that change sometimes, or a wave.
pub fn brake(waves: bool, ticks: usize, dice: &mut Dice) -> Vec<f64> {
    if waves {
        let (frequency, phase) = (dice.size(0.05, 0.4), dice.phase());
        return (0..ticks).map(|i| 0.5 + 0.5 * (TAU * frequency * i as f64 * TICK_S + phase).sin()).collect();
    }
    let (mut levels, mut level) = (Vec::with_capacity(ticks), 0.0);
    while levels.len() < ticks {
        let lasts = (dice.uniform(1.5, 5.0) / TICK_S) as usize;
        let next = *dice.pick(&[0.0, 0.0, 0.35, 0.7, 1.0]);
        for _ in 0..lasts.min(ticks - levels.len()) {
            level += (next - level) * TICK_S / 0.03;
            levels.push(level);
        }
    }
    levels
}
