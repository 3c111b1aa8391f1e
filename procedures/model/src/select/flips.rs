//! Error control over everything that is looked at: sign flips of whole blocks with the maximum over all candidates.
//!
//! Westfall and Young 1993; under the null a block's residual is as likely as its mirror image, whatever its
//! autocorrelation and whatever the candidates have in common. Statistics of different size are put on one scale by
//! Wilson and Hilferty's cube root.

use crate::linear::{Spd, dot};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// One signed sum for each block, whitened so that their squared total is the studentised score.
pub struct Score {
    /// Column by column: `parts[c][g]`.
    parts: Vec<Vec<f64>>,
}

impl Score {
    /// `sums[c][g]`: product of what column c has of its own with the residual over group g.
    pub fn new(sums: &[Vec<f64>]) -> Self {
        let k = sums.len();
        let mut spread = vec![0.0; k * k];
        for a in 0..k {
            for b in 0..k {
                spread[a * k + b] = dot(&sums[a], &sums[b]);
            }
        }
        let spd = Spd::new(&spread, k, 1e-9);
        let groups = sums.first().map_or(0, Vec::len);
        let mut parts = vec![vec![0.0; groups]; k];
        for g in 0..groups {
            let of_group: Vec<f64> = sums.iter().map(|s| s[g]).collect();
            for (c, v) in spd.whiten(&of_group).into_iter().enumerate() {
                parts[c][g] = v;
            }
        }
        Self { parts }
    }

    /// The score on the scale of a standard normal.
    pub fn z(&self) -> f64 {
        let total: f64 = self.parts.iter().map(|p| p.iter().sum::<f64>().powi(2)).sum();
        normal_scale(total, self.parts.len())
    }

    fn z_flipped(&self, signs: &[f64]) -> f64 {
        let total: f64 = self.parts.iter().map(|p| dot(p, signs).powi(2)).sum();
        normal_scale(total, self.parts.len())
    }
}

fn normal_scale(chi2: f64, k: usize) -> f64 {
    if k == 0 {
        return f64::NEG_INFINITY;
    }
    let k = k as f64;
    let spread = 2.0 / (9.0 * k);
    ((chi2 / k).cbrt() - (1.0 - spread)) / spread.sqrt()
}

/// The largest score of all for each flip, in rising order.
pub struct Null {
    largest: Vec<f64>,
}

impl Null {
    pub fn new(scores: &[Score], flips: usize, seed: u64) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let groups = scores.iter().flat_map(|s| &s.parts).map(Vec::len).max().unwrap_or(0);
        let mut signs = vec![1.0; groups];
        let mut largest: Vec<f64> = (0..flips)
            .map(|_| {
                signs.iter_mut().for_each(|s| *s = if random.random::<bool>() { 1.0 } else { -1.0 });
                scores.iter().map(|s| s.z_flipped(&signs)).fold(f64::NEG_INFINITY, f64::max)
            })
            .collect();
        largest.sort_by(f64::total_cmp);
        Self { largest }
    }

    /// Share of flips whose largest score is as large.
    pub fn p_value(&self, z: f64) -> f64 {
        let below = self.largest.partition_point(|l| *l < z);
        (1 + self.largest.len() - below) as f64 / (1 + self.largest.len()) as f64
    }
}
