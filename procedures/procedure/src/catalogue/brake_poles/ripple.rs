//! Torque ripple of whole numbers of periods in one turn, with its interval over repeated turns.

use crate::findings::{Hold, Mean, solve};
use statrs::distribution::{ContinuousCDF, FisherSnedecor};
use std::f64::consts::TAU;
use std::ops::Range;

/// Highest order that is tested: the second harmonic of 25 poles (one tooth every 17° is 21 poles; Magtrol 2025).
pub const ORDERS: usize = 50;

/// One order in one turn.
#[derive(Debug, Clone, Copy)]
pub struct Wave {
    /// Direction of rotation, +1 or −1.
    pub direction: f64,
    /// Cosine and sine part.
    pub parts: [f64; 2],
}

/// Columns of a run: angle of the link, and torque against the rotation.
pub struct Turning<'a> {
    pub link_rad: &'a [f64],
    pub torque_nm: &'a [f64],
    /// Turns of the brake for each turn of the link.
    pub gear_ratio: f64,
}

impl Turning<'_> {
    /// Each order from 1 on, by least squares over the last whole turn of the brake. `None` if the leg is shorter.
    pub fn waves(&self, hold: &Hold) -> Option<Vec<Wave>> {
        let rows = self.last_turn(&hold.rows)?;
        let direction = hold.velocity_rad_s.signum();
        let torque: Vec<f64> = self.torque_nm[rows.clone()].iter().map(|nm| direction * nm).collect();
        let wave = |order: usize| {
            let row = |link_rad: &f64| {
                let (sine, cosine) = (order as f64 * self.gear_ratio * link_rad).sin_cos();
                [1.0, cosine, sine]
            };
            let columns: Vec<[f64; 3]> = self.link_rad[rows.clone()].iter().map(row).collect();
            let [_, cosine, sine] = solve(&columns, &torque)?.values;
            Some(Wave { direction, parts: [cosine, sine] })
        };
        (1..=ORDERS).map(wave).collect()
    }

    fn last_turn(&self, rows: &Range<usize>) -> Option<Range<usize>> {
        let end_rad = self.link_rad[rows.end - 1];
        let is_before = |row: &usize| (self.link_rad[*row] - end_rad).abs() * self.gear_ratio >= TAU;
        let start = rows.clone().rev().find(is_before)?;
        Some(start + 1..rows.end)
    }
}

/// One order over repeated turns in both directions. A delay between angle and torque shifts its phase against the
/// rotation, so that only turns of one direction have one phase.
#[derive(Debug, Clone, Copy)]
pub struct Ripple {
    /// Root mean square over the directions of the amplitude of the mean wave.
    pub amplitude: f64,
    /// Amplitude that noise exceeds in 5 % of all cases, in any of `tests` orders.
    pub reach: f64,
    /// Mean amplitude of single turns, for a ripple that is larger than noise.
    pub single: Mean,
}

impl Ripple {
    /// `None` with fewer than two turns in each direction.
    ///
    /// The test is that of the mean parts of both directions against the scatter between turns (F test with the
    /// Bonferroni correction for `tests` orders).
    pub fn of(waves: &[Wave], tests: usize) -> Option<Self> {
        let (mut between, mut within) = (0.0, 0.0);
        for direction in [1.0, -1.0] {
            let turns: Vec<[f64; 2]> =
                waves.iter().filter(|wave| wave.direction == direction).map(|wave| wave.parts).collect();
            if turns.len() < 2 {
                return None;
            }
            for part in [0, 1] {
                let mean = turns.iter().map(|parts| parts[part]).sum::<f64>() / turns.len() as f64;
                between += turns.len() as f64 * mean.powi(2);
                within += turns.iter().map(|parts| (parts[part] - mean).powi(2)).sum::<f64>();
            }
        }
        let n = waves.len() as f64;
        let (parts, freedom) = (4.0, 2.0 * (n - 2.0));
        let f = FisherSnedecor::new(parts, freedom).ok()?.inverse_cdf(1.0 - 0.05 / tests as f64);
        let single: Vec<f64> = waves.iter().map(|wave| wave.parts[0].hypot(wave.parts[1])).collect();
        Some(Self {
            amplitude: (between / n).sqrt(),
            reach: (parts * within / freedom * f / n).sqrt(),
            single: Mean::of(&single)?,
        })
    }

    pub fn is_significant(&self) -> bool {
        self.amplitude > self.reach
    }

    /// Largest amplitude that the scatter allows.
    pub fn most(&self) -> f64 {
        self.amplitude + self.reach
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    /// The interval contains the amplitude of a delayed wave, and noise is no wave, in 95 of 100 cases.
    #[test]
    fn a_wave_lies_in_its_interval_and_noise_is_none() {
        let mut random = ChaCha8Rng::seed_from_u64(3);
        // The sum of 12 uniform numbers is normal with variance 1.
        let mut noise = move || (0..12).map(|_| random.random_range(-0.5..0.5)).sum::<f64>();
        let (mut inside, mut within) = (0, 0);
        for _ in 0..1000 {
            let mut turns = |lag: f64, size: f64| -> Vec<Wave> {
                let turn = |direction: f64| {
                    let (sine, cosine) = (0.6 + direction * lag).sin_cos();
                    Wave { direction, parts: [size * cosine + noise(), size * sine + noise()] }
                };
                [1.0, -1.0, 1.0, -1.0, 1.0, -1.0].map(turn).into()
            };
            let [low, high] = Ripple::of(&turns(0.4, 50.0), 1).unwrap().single.ci95;
            inside += u32::from((low..=high).contains(&50.0));
            within += u32::from(!Ripple::of(&turns(0.0, 0.0), 1).unwrap().is_significant());
        }
        assert!((930..=970).contains(&inside) && (930..=970).contains(&within), "{inside} {within}");
    }
}
