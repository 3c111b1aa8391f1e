//! Stiffness runs: a joint turned against a brake whose torque changes from level to level, with its twist.

use super::{Coloured, Dice, rounded, table};
use jointbench_instrument::{Kind, Meta, RunTable};
use std::f64::consts::TAU;

pub const SINGLES: &[&str] = &[
    "directional_offset",
    "backlash",
    "hardening",
    "torsional_hysteresis",
    "transmission_error",
    "temperature_compliance",
    "creep",
];

pub const PAIRS: &[[&str; 2]] = &[
    ["hardening", "directional_offset"],
    ["transmission_error", "torsional_hysteresis"],
    ["hardening", "torsional_hysteresis"],
    ["directional_offset", "transmission_error"],
];

const STEP_S: f64 = 0.01;

/// A gear train. Parameters are zero if an effect is not hidden. Lengths as shares of the twist at full torque.
#[derive(Default)]
struct Train {
    rest: f64,
    gap: f64,
    /// Share of the stiffness from additional teeth in contact, or from teeth that yield at first.
    more_teeth: f64,
    soft_teeth: f64,
    /// Dry contacts: deflection before slip, and torque of each.
    contacts: Vec<(f64, f64)>,
    uneven: (f64, f64, f64),
    warm: f64,
    slow: (f64, f64),
}

impl Train {
    fn hide(&mut self, effect: &str, dice: &mut Dice) {
        match effect {
            "directional_offset" => self.rest = dice.uniform(0.03, 0.2),
            "backlash" => self.gap = dice.uniform(0.05, 0.2),
            "hardening" if dice.coin() => self.more_teeth = dice.uniform(0.1, 0.5),
            "hardening" => self.soft_teeth = dice.uniform(0.05, 0.2),
            "torsional_hysteresis" => {
                let (total, wide) = (dice.uniform(0.05, 0.15), dice.uniform(0.1, 0.5));
                let count = *dice.pick(&[1, 2, 4]);
                let share = |i: usize| wide * (i + 1) as f64 / count as f64;
                self.contacts = (0..count).map(|i| (share(i), total / count as f64)).collect();
            }
            "transmission_error" => {
                self.uneven = (*dice.pick(&[1.0, 2.0, 3.0, 4.0, 8.0, 16.0]), dice.uniform(0.03, 0.15), dice.phase());
            }
            "temperature_compliance" => self.warm = dice.uniform(0.004, 0.015),
            _ => self.slow = (dice.uniform(0.05, 0.2), dice.uniform(0.5, 2.0)),
        }
    }

    /// Twist of the elastic part under a torque, both as shares of the full values: torque = twist + more·twist³
    /// solved for the twist, and teeth that yield at first.
    fn spring(&self, torque: f64) -> f64 {
        let mut twist = torque;
        for _ in 0..12 {
            let too_much = twist + self.more_teeth * twist.powi(3) - torque;
            twist -= too_much / (1.0 + 3.0 * self.more_teeth * twist * twist);
        }
        twist + self.soft_teeth * (torque / 0.25).atan()
    }

    /// Twist under a torque at a link angle, both as shares of the full values.
    fn twist(&self, past: &Past, torque: f64, side: f64, warmth: f64, link: f64) -> f64 {
        let mut twist = self.spring(torque) * (1.0 + self.warm * warmth);
        twist += self.rest * side + self.gap * (torque / 0.01).clamp(-1.0, 1.0);
        for (bent, (slips, carries)) in past.bent.iter().zip(&self.contacts) {
            twist += carries * bent / slips;
        }
        twist += self.slow.0 * past.crept;
        let (order, size, phase) = self.uneven;
        twist + size * (order * link + phase).cos()
    }
}

/// Loading history of a gear train.
struct Past {
    /// Deflection of each dry contact.
    bent: Vec<f64>,
    crept: f64,
}

impl Past {
    /// One time step under a torque, after its change by `added`.
    fn load(&mut self, train: &Train, torque: f64, added: f64) {
        for (bent, (slips, _)) in self.bent.iter_mut().zip(&train.contacts) {
            *bent = (*bent + added).clamp(-slips, *slips);
        }
        self.crept += (torque - self.crept) * (1.0 - (-STEP_S / train.slow.1.max(1e-9)).exp());
    }
}

const NAMES: [&str; 8] = [
    "time_s",
    "motor_position_rad",
    "link_position_rad",
    "link_velocity_rad_s",
    "link_torque_nm",
    "temperature_c",
    "segment",
    "repeat",
];

pub fn make(dice: &mut Dice, hidden: &[&str]) -> RunTable {
    let gear = *dice.pick(&[36.0, 50.0, 100.0, 121.0, 177.8]);
    let full_nm = dice.uniform(8.0, 20.0);
    let full_twist = full_nm * dice.size(8e-5, 1.5e-3);
    let mut train = Train::default();
    hidden.iter().for_each(|h| train.hide(h, dice));
    let levels: Vec<f64> = (0..10).map(|i| full_nm * (0.04 + 0.96 * f64::from(i) / 9.0)).collect();
    let (speed, rise_s) = (dice.uniform(0.2, 0.5), dice.uniform(0.15, 0.4));
    let noise_rad = dice.size(2e-3, 8e-3) * full_twist;
    let mut noise = Coloured::new(noise_rad, dice.uniform(0.1, 0.5), dice.uniform(0.6, 0.9));
    let scatter = noise_rad * dice.uniform(0.03, 0.15);
    let zero = dice.uniform(-0.4, 0.4);
    let (heating, heats_s) = (dice.uniform(6.0, 14.0), dice.uniform(50.0, 120.0));
    let (motor_step, link_step) = (TAU / 4096.0, TAU / 524_288.0);

    let (mut link, mut torque, mut time, mut segment) = (0.0f64, 0.0f64, 0.0f64, 0.0);
    let mut past = Past { bent: vec![0.0; train.contacts.len()], crept: 0.0 };
    let mut columns = vec![Vec::new(); NAMES.len()];
    for repeat in 0..3 {
        for level in &levels {
            for side in [1.0, -1.0] {
                let (moved, pace) = (scatter * dice.normal(), speed * (1.0 + 1e-3 * dice.normal()));
                for _ in 0..300 {
                    time += STEP_S;
                    link += side * pace * STEP_S;
                    let before = torque;
                    torque += (side * level - torque) * (1.0 - (-STEP_S / rise_s).exp());
                    let share = torque / full_nm;
                    let warmth = heating * (1.0 - (-time / heats_s).exp());
                    past.load(&train, share, (torque - before) / full_nm);
                    let twist = train.twist(&past, share, side, warmth, link);
                    let motor = (link + zero + full_twist * twist + moved + noise.next(dice)) * gear;
                    let values = [
                        time,
                        rounded(motor, motor_step),
                        rounded(link, link_step),
                        side * speed,
                        torque + 1.5e-3 * full_nm * dice.normal(),
                        rounded(24.0 + warmth, 0.1),
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
        kind: Some(Kind::Stiffness),
        gear_ratio: Some(gear),
        baseline: vec!["offset".into(), "compliance".into()],
        sample_rate_hz: Some(1.0 / STEP_S),
        ..Meta::default()
    };
    table(meta, NAMES.map(String::from).into(), columns)
}
