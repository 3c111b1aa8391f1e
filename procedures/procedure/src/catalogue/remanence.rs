//! The torque of a brake without current over one turn, and the criterion of a demagnetised brake.

use super::brake_run::{load_gear_ratio, rated_nm};
use super::legs::{Legs, turn_s};
use crate::bench_facts::BenchFacts;
use crate::findings::{Hold, quantity, scatter};
use crate::identification::{Axis, Figure, Form, Quantity, Series};
use crate::thresholds::REMANENCE;
use jointbench_instrument::RunTable;
use jointbench_model::words;
use std::f64::consts::TAU;

/// Angles of a turn at which the torque is averaged: several for each of up to 25 poles.
const PLACES: usize = 120;
/// The range of this number of noise means is about this multiple of their standard deviation.
const RANGE_OF_NOISE: f64 = 5.2;

/// Demagnetises the brake. Then a turn without current in each direction, with `repeat` as its purpose.
pub(super) fn demagnetise(legs: &mut Legs, speed_rad_s: f64, top_a: f64, turns: f64, repeat: u32, bench: &BenchFacts) {
    legs.demagnetise(speed_rad_s, top_a, turns, bench);
    let before = std::mem::replace(&mut legs.repeat, repeat);
    for speed_rad_s in [speed_rad_s, -speed_rad_s] {
        legs.leg(speed_rad_s, turn_s(1.2, speed_rad_s, bench, 1.0), 0.0);
    }
    legs.repeat = before;
}

/// Torque of one turn of the brake without current.
struct Turn {
    /// Brake angle and mean torque.
    means: Vec<(f64, f64)>,
    /// Range of these means, peak to peak.
    range_nm: f64,
    /// Part of that range that noise explains.
    noise_nm: f64,
}

impl Turn {
    fn of(hold: &Hold, angle_rad: &[f64], torque_nm: &[f64], gear_ratio: f64) -> Self {
        let rows = hold.tail(0.9);
        let mut sums = vec![(0.0, 0.0); PLACES];
        for row in rows.clone() {
            let turns = (angle_rad[row] * gear_ratio).rem_euclid(TAU) / TAU;
            let place = (turns * PLACES as f64) as usize % PLACES;
            sums[place] = (sums[place].0 + torque_nm[row], sums[place].1 + 1.0);
        }
        let means: Vec<(f64, f64)> = sums
            .iter()
            .enumerate()
            .filter(|(_, (_, n))| *n > 0.0)
            .map(|(place, (sum, n))| ((place as f64 + 0.5) / PLACES as f64 * TAU, sum / n))
            .collect();
        let (low, high) = means.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), (_, v)| (v.min(l), v.max(h)));
        // Noise from differences of consecutive samples, within which the rotor does not pass a pole.
        let steps = torque_nm[rows.clone()].windows(2).map(|w| (w[1] - w[0]).powi(2));
        let sigma_nm = (steps.sum::<f64>() / (2.0 * (rows.len() - 1) as f64)).sqrt();
        let noise_nm = RANGE_OF_NOISE * sigma_nm / (rows.len() as f64 / means.len() as f64).sqrt();
        Self { means, range_nm: high - low, noise_nm }
    }
}

/// Torque that remains without current, over several turns.
pub(super) struct Remanence {
    turns: Vec<Turn>,
    left_nm: f64,
    noise_nm: f64,
    allowed_nm: f64,
}

impl Remanence {
    /// Of the turns after [`demagnetise`]; of any others, only their courses count. `None` without holds, or if the run
    /// belongs to another procedure.
    pub fn of(run: &RunTable, holds: &[Hold]) -> Option<Self> {
        let (torque, angle) = (run.column("brake_torque_nm")?, run.column("position_rad")?);
        let turns: Vec<Turn> = holds.iter().map(|hold| Turn::of(hold, angle, torque, load_gear_ratio(run))).collect();
        let most = |of: fn(&Turn) -> f64| turns.iter().map(of).reduce(f64::max);
        let (left_nm, noise_nm) = (most(|turn| turn.range_nm)?, most(|turn| turn.noise_nm)?);
        let allowed_nm = REMANENCE * rated_nm(run)? + noise_nm;
        Some(Self { turns, left_nm, noise_nm, allowed_nm })
    }

    pub fn is_clean(&self) -> bool {
        self.left_nm <= self.allowed_nm
    }

    pub fn sentence(&self) -> String {
        format!(
            "Torque variation over one turn without current: {}, {} the limit of {} (noise + 0.5 % of rated).",
            words::figure(self.left_nm, "Nm"),
            if self.is_clean() { "below" } else { "above" },
            words::figure(self.allowed_nm, "Nm"),
        )
    }

    /// A maximum over turns and the noise in it; neither has an interval.
    pub fn quantities(&self) -> Vec<Quantity> {
        vec![
            quantity(["left", "ΔT", "Remanent torque over one turn, peak to peak", "Nm"], self.left_nm, None),
            quantity(["noise", "σ", "Noise contribution, peak to peak", "Nm"], self.noise_nm, None),
        ]
    }

    /// # Panics
    /// If there is no such turn.
    pub fn series(&self, turn: usize, label: &str) -> Series {
        scatter(label, self.turns[turn].means.iter().copied())
    }
}

/// The figure of such turns, without its series.
pub(super) fn over_angle(title: &str) -> Figure {
    Figure {
        name: "torque_over_angle".into(),
        title: title.into(),
        form: Form::Polar,
        x: Axis::of("brake angle", "rad"),
        y: Axis::of("torque", "Nm"),
        series: Vec::new(),
    }
}
