//! Brake runs: the coil current up and down at several speeds, iron with hysteresis, and cogging poles.

use super::{Coloured, Dice, rounded, table};
use jointbench_instrument::{Kind, Meta, RunTable};

pub const SINGLES: &[&str] = &["saturation", "hysteresis", "velocity_dependence", "cogging", "temperature_dependence"];

pub const PAIRS: &[[&str; 2]] = &[
    ["saturation", "hysteresis"],
    ["hysteresis", "velocity_dependence"],
    ["hysteresis", "temperature_dependence"],
    ["saturation", "cogging"],
];

const STEP_S: f64 = 0.02;
const ROWS: usize = 600;

/// Iron and air gap. Torques as shares of the full torque, currents as shares of the rated current. Zero if an effect
/// is not hidden.
#[derive(Default)]
struct Iron {
    /// Hill's curve: half of the torque at this current, with this steepness.
    half: f64,
    steep: f64,
    /// Domains that switch back when the current has fallen this far, each with its share.
    domains: Vec<(f64, f64)>,
    drag: f64,
    eddies: f64,
    air: f64,
    pull: f64,
    warm: f64,
}

impl Iron {
    fn hide(&mut self, effect: &str, dice: &mut Dice) {
        match effect {
            "saturation" => (self.half, self.steep) = (dice.uniform(0.35, 0.6), dice.uniform(1.8, 2.8)),
            "hysteresis" => {
                let (total, middle, wide) =
                    (dice.uniform(0.08, 0.3), dice.uniform(0.25, 0.5), dice.uniform(0.15, 0.35));
                let weight = |i: usize| (-((i as f64 / 30.0 - middle) / wide).powi(2)).exp();
                let all: f64 = (1..=30).map(weight).sum();
                self.domains = (1..=30).map(|i| (i as f64 / 30.0, total * weight(i) / all)).collect();
            }
            "velocity_dependence" if dice.coin() => self.eddies = dice.uniform(0.03, 0.12),
            "velocity_dependence" => self.air = dice.uniform(0.02, 0.08),
            "cogging" => self.pull = dice.uniform(0.01, 0.06),
            _ => self.warm = dice.uniform(0.002, 0.006),
        }
    }

    fn curve(&self, current: f64) -> f64 {
        if self.steep == 0.0 {
            return current;
        }
        let raised = current.max(0.0).powf(self.steep);
        raised / (raised + self.half.powf(self.steep)) * (1.0 + self.half.powf(self.steep))
    }

    /// Torque at a state of the domains and an angle of the poles.
    fn torque(&self, bent: &[f64], current: f64, speed: f64, warmth: f64, poles: f64) -> f64 {
        let mut torque = self.drag + self.curve(current);
        for (bent, (_, part)) in bent.iter().zip(&self.domains) {
            torque -= part * bent;
        }
        torque * (1.0 + self.eddies * speed / 60.0) * (1.0 - self.warm * warmth)
            + self.air * speed / 60.0
            + self.pull * current * poles.sin()
    }
}

const NAMES: [&str; 8] = [
    "time_s",
    "brake_current_a",
    "brake_torque_nm",
    "velocity_rad_s",
    "position_rad",
    "temperature_c",
    "segment",
    "repeat",
];

pub fn make(dice: &mut Dice, hidden: &[&str]) -> RunTable {
    let rated = *dice.pick(&[0.6, 1.0, 1.5, 2.0]);
    let full_nm = dice.uniform(6.0, 16.0);
    let poles = *dice.pick(&[12u32, 16, 20, 24]);
    let mut iron = Iron::default();
    hidden.iter().for_each(|h| iron.hide(h, dice));
    iron.drag = dice.uniform(0.005, 0.02);
    let mut noise = Coloured::new(dice.uniform(1e-3, 4e-3), dice.uniform(0.1, 0.5), dice.uniform(0.6, 0.9));
    let scatter = dice.uniform(5e-5, 2e-4);
    let speeds = [5.0, 20.0, 60.0].map(|v| v * dice.uniform(0.8, 1.2));
    let (heating, heats_s, phase) = (dice.uniform(8.0, 18.0), dice.uniform(80.0, 200.0), dice.phase());

    let (mut angle, mut time, mut segment, mut last) = (0.0, 0.0f64, 0.0, 0.0);
    let mut bent = vec![0.0f64; iron.domains.len()];
    let mut columns = vec![Vec::new(); NAMES.len()];
    for repeat in 0..3 {
        for speed in speeds {
            for up in [true, false] {
                let moved = scatter * dice.normal();
                for row in 0..ROWS {
                    let share = (row as f64 + 0.5) / ROWS as f64;
                    let current = if up { share } else { 1.0 - share };
                    time += STEP_S;
                    angle += speed * STEP_S;
                    let warmth = heating * (1.0 - (-time / heats_s).exp());
                    for (bent, (wide, _)) in bent.iter_mut().zip(&iron.domains) {
                        *bent = (*bent + (current - last) / wide).clamp(-1.0, 1.0);
                    }
                    last = current;
                    let torque = iron.torque(&bent, current, speed, warmth, f64::from(poles) * angle + phase);
                    let values = [
                        time,
                        rated * (current + 4e-4 * dice.normal()),
                        full_nm * (torque + moved + noise.next(dice)),
                        speed * (1.0 + 2e-3 * dice.normal()),
                        angle,
                        rounded(25.0 + warmth, 0.1),
                        segment,
                        f64::from(repeat),
                    ];
                    columns.iter_mut().zip(values).for_each(|(c, v)| c.push(v));
                }
                segment += 1.0;
            }
        }
    }
    let meta = Meta {
        kind: Some(Kind::Brake),
        rated_current_a: Some(rated),
        poles: Some(poles),
        baseline: vec!["drag".into(), "torque_per_current".into()],
        sample_rate_hz: Some(1.0 / STEP_S),
        ..Meta::default()
    };
    table(meta, NAMES.map(String::from).into(), columns)
}
