//! The look-up table over the turn, and the remaining error, averaged over the counts of the reference.

use super::sweeps::Sweep;
use crate::findings::solve;
use crate::identification::{Mark, Series};
use std::f64::consts::TAU;

/// Terms of an error that do not depend on the angle.
#[derive(Debug, Clone, Copy)]
pub struct Terms {
    pub offset_rad: f64,
    /// Half width of the hysteresis, against the motion.
    pub hysteresis_rad: f64,
    pub delay_s: f64,
}

impl Terms {
    /// `None` if the sweeps do not separate the terms, for example at a single speed.
    pub fn of(sweeps: &[Sweep]) -> Option<Self> {
        let points: Vec<(f64, f64)> =
            sweeps.iter().filter_map(|sweep| Some((sweep.speed_rad_s, sweep.shape()?.mean_rad))).collect();
        let rows: Vec<[f64; 3]> = points.iter().map(|(v, _)| [1.0, -v.signum(), -v]).collect();
        let means: Vec<f64> = points.iter().map(|(_, mean)| *mean).collect();
        let [offset_rad, hysteresis_rad, delay_s] = solve(&rows, &means)?.values;
        Some(Self { offset_rad, hysteresis_rad, delay_s })
    }

    pub fn at(&self, speed_rad_s: f64) -> f64 {
        self.offset_rad - self.hysteresis_rad * speed_rad_s.signum() - self.delay_s * speed_rad_s
    }
}

/// Errors over the reading of the encoder under test, in equal steps of the turn, with linear interpolation.
#[derive(Debug, Clone)]
pub struct Table {
    entries_rad: Vec<f64>,
}

impl Table {
    /// Means of the error without the terms. `None` if more than a tenth of the entries has no sample.
    pub fn of(sweeps: &[Sweep], terms: &Terms, size: usize) -> Option<Self> {
        let mut sums = vec![(0.0, 0u32); size];
        for sweep in sweeps {
            let rest_rad = terms.at(sweep.speed_rad_s);
            for (angle, error) in sweep.angle_rad.iter().zip(&sweep.error_rad) {
                let (sum, count) = &mut sums[bin(angle + error, size)];
                *sum += error - rest_rad;
                *count += 1;
            }
        }
        let met: Vec<usize> = (0..size).filter(|i| sums[*i].1 > 0).collect();
        if met.len() < size - size / 10 {
            return None;
        }
        // Missing entries are interpolated between their neighbours.
        let mean = |i: usize| sums[i].0 / f64::from(sums[i].1);
        let entry = |i: usize| {
            if sums[i].1 > 0 {
                return mean(i);
            }
            let after = met.partition_point(|known| *known < i);
            let (left, right) = (met[(after + met.len() - 1) % met.len()], met[after % met.len()]);
            let way = |from: usize, to: usize| ((to + size - from) % size) as f64;
            mean(left) + (mean(right) - mean(left)) * way(left, i) / way(left, right)
        };
        Some(Self { entries_rad: (0..size).map(entry).collect() })
    }

    pub fn len(&self) -> usize {
        self.entries_rad.len()
    }

    pub fn at(&self, angle_rad: f64) -> f64 {
        let size = self.len();
        // Entries are the values at the middle of their steps.
        let place = angle_rad.rem_euclid(TAU) / TAU * size as f64 - 0.5;
        let below = place.floor();
        let (left, right) = (below.rem_euclid(size as f64) as usize, (below + 1.0).rem_euclid(size as f64) as usize);
        let share = place - below;
        (1.0 - share) * self.entries_rad[left] + share * self.entries_rad[right]
    }

    pub fn mean(&self) -> f64 {
        self.entries_rad.iter().sum::<f64>() / self.len() as f64
    }

    /// Cosine and sine of the harmonic of this order.
    pub fn wave(&self, order: u32) -> [f64; 2] {
        let step = TAU * f64::from(order) / self.len() as f64;
        let part = |wave: fn(f64) -> f64| -> f64 {
            self.entries_rad.iter().enumerate().map(|(i, entry)| entry * wave(step * (i as f64 + 0.5))).sum()
        };
        [f64::cos, f64::sin].map(|wave| 2.0 * part(wave) / self.len() as f64)
    }

    /// Amplitude of the harmonic of this order.
    pub fn harmonic(&self, order: u32) -> f64 {
        let [cos, sin] = self.wave(order);
        cos.hypot(sin)
    }

    pub fn series(&self, label: &str) -> Series {
        let angle = (0..self.len()).map(|i| (i as f64 + 0.5) * TAU / self.len() as f64).collect();
        Series::new(label, Mark::Line, angle, self.entries_rad.clone())
    }
}

fn bin(angle_rad: f64, size: usize) -> usize {
    ((angle_rad.rem_euclid(TAU) / TAU * size as f64) as usize).min(size - 1)
}

/// Readings in a bin, which average over the counts of the reference, because these are much coarser than the
/// evaluated error.
const READINGS_IN_A_BIN: usize = 40;
const BINS: [usize; 2] = [16, 256];

/// One sweep in bins of the turn.
pub struct Class<'a> {
    sweep: &'a Sweep,
    bins: usize,
}

impl<'a> Class<'a> {
    pub fn of(sweep: &'a Sweep) -> Self {
        Self { sweep, bins: (sweep.error_rad.len() / READINGS_IN_A_BIN).clamp(BINS[0], BINS[1]) }
    }

    /// The largest mean of any bin, without the readings of one turn.
    pub fn peak(&self, left: &dyn Fn(&Sweep, usize) -> f64, without_turn: Option<usize>) -> f64 {
        let kept = (0..self.sweep.angle_rad.len()).filter(|i| without_turn != Some(self.turn(*i)));
        let means = means_of(kept.map(|i| (self.sweep, i)), self.bins, left);
        means.into_iter().flatten().map(f64::abs).fold(0.0, f64::max)
    }

    /// Whole turns of the sweep.
    pub fn turns(&self) -> usize {
        let last = self.sweep.angle_rad.len().saturating_sub(1);
        let way_rad = self.sweep.angle_rad.get(last).map_or(0.0, |angle| (angle - self.sweep.angle_rad[0]).abs());
        (way_rad / TAU).round() as usize
    }

    /// The sweep without the readings of one turn.
    pub fn without(&self, turn: usize) -> Sweep {
        let kept = |all: &[f64]| {
            all.iter().enumerate().filter(|(i, _)| self.turn(*i) != turn).map(|(_, value)| *value).collect()
        };
        let [angle_rad, error_rad] = [&self.sweep.angle_rad, &self.sweep.error_rad].map(|all| kept(all));
        Sweep { angle_rad, error_rad, ..*self.sweep }
    }

    /// Number of the turn of a reading, from 0.
    fn turn(&self, reading: usize) -> usize {
        let way_rad = (self.sweep.angle_rad[reading] - self.sweep.angle_rad[0]).abs();
        ((way_rad / TAU) as usize).min(self.turns().saturating_sub(1))
    }
}

/// Mean remaining error in equal bins of the turn; `None` in a bin without samples.
pub fn means<'s>(
    sweeps: impl Iterator<Item = &'s Sweep>,
    bins: usize,
    left: &dyn Fn(&Sweep, usize) -> f64,
) -> Vec<Option<f64>> {
    means_of(sweeps.flat_map(|sweep| (0..sweep.angle_rad.len()).map(move |i| (sweep, i))), bins, left)
}

/// The same of single readings.
fn means_of<'s>(
    readings: impl Iterator<Item = (&'s Sweep, usize)>,
    bins: usize,
    left: &dyn Fn(&Sweep, usize) -> f64,
) -> Vec<Option<f64>> {
    let mut sums = vec![(0.0, 0u32); bins];
    for (sweep, i) in readings {
        let (sum, count) = &mut sums[bin(sweep.angle_rad[i], bins)];
        *sum += left(sweep, i);
        *count += 1;
    }
    sums.into_iter().map(|(sum, count)| (count > 0).then(|| sum / f64::from(count))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sweep(speed_rad_s: f64, turns: f64) -> Sweep {
        let angle_rad: Vec<f64> = (0..20_000).map(|i| f64::from(i) * turns * TAU / 20_000.0).collect();
        let error = |a: &f64| {
            2e-3 * a.sin() + 3e-4 * (64.0 * a).cos() + 1e-3 - 1e-4 * speed_rad_s.signum() - 5e-5 * speed_rad_s
        };
        Sweep { repeat: 0, speed_rad_s, error_rad: angle_rad.iter().map(error).collect(), angle_rad, radial_m: 0.0 }
    }

    #[test]
    fn a_table_takes_the_shape_and_the_terms_the_rest() {
        let sweeps = [sweep(5.0, 7.0), sweep(-5.0, 7.0), sweep(50.0, 7.0), sweep(-50.0, 7.0)];
        let terms = Terms::of(&sweeps).unwrap();
        assert!((terms.delay_s - 5e-5).abs() < 1e-9 && (terms.hysteresis_rad - 1e-4).abs() < 1e-7, "{terms:?}");
        let table = Table::of(&sweeps, &terms, 1024).unwrap();
        assert!((table.harmonic(1) - 2e-3).abs() < 1e-5 && (table.harmonic(64) - 3e-4).abs() < 2e-5);
        let left = |sweep: &Sweep, i: usize| {
            sweep.error_rad[i] - terms.at(sweep.speed_rad_s) - table.at(sweep.angle_rad[i] + sweep.error_rad[i])
        };
        for sweep in &sweeps {
            assert!(Class::of(sweep).peak(&left, None) < 6e-5, "{}", Class::of(sweep).peak(&left, None));
        }
        assert!(Table::of(&sweeps, &terms, 100_000).is_none(), "hardly any entry is met");
    }
}
