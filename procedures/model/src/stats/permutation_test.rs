//! Permutation test over all candidates: sign flips of whole blocks with the maximum statistic (max-T, family-wise).
//!
//! Westfall and Young 1993. Under the null hypothesis the residual of a block is as likely as its negative, for any
//! autocorrelation within blocks and any correlation between candidates. The Wilson-Hilferty cube root puts
//! statistics with different degrees of freedom on one scale.

use crate::linear::basis::dot;
use crate::linear::cholesky::Cholesky;
use crate::stats::student;
use crate::thresholds::OWN_SCATTER_SHARE;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use statrs::distribution::{ContinuousCDF, Normal};
use std::borrow::Borrow;

/// One signed sum for each block, whitened so that their squared total is the studentised score.
pub struct Score {
    /// Column by column: `parts[c][g]`.
    parts: Vec<Vec<f64>>,
}

impl Score {
    /// `sums[c][g]`: product of the orthogonal part of column c with the residual over group g.
    pub fn new(sums: &[Vec<f64>]) -> Self {
        let k = sums.len();
        let mut spread = vec![0.0; k * k];
        for a in 0..k {
            for b in 0..k {
                spread[a * k + b] = dot(&sums[a], &sums[b]);
            }
        }
        let spd = Cholesky::new(&spread, k, 1e-9);
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

    /// Ratio of a coefficient to its noise that is required for the score `z`, with `deciding` equivalent equal
    /// groups. For several columns by [`Score::z`], whose scatter includes the effect itself, for a single column by
    /// its jackknife.
    pub fn needed(&self, z: f64, deciding: f64) -> f64 {
        if self.parts.len() == 1 {
            let t = student::quantile(deciding - 1.0, 0.5 * Normal::standard().sf(z));
            return t.map_or(f64::INFINITY, |t| -t);
        }
        let chi2 = chi2_scale(z, self.parts.len());
        (chi2 / (1.0 - chi2 / deciding).max(OWN_SCATTER_SHARE)).sqrt()
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

/// Inverse of [`normal_scale`].
fn chi2_scale(z: f64, k: usize) -> f64 {
    let k = k as f64;
    let spread = 2.0 / (9.0 * k);
    k * (z * spread.sqrt() + 1.0 - spread).powi(3)
}

/// The largest score of all candidates for each flip, in rising order.
pub struct MaxTNull {
    largest: Vec<f64>,
}

impl MaxTNull {
    pub fn new(scores: &[impl Borrow<Score> + Sync], flips: usize, seed: u64) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let groups = scores.iter().flat_map(|s| &s.borrow().parts).map(Vec::len).max().unwrap_or(0);
        // One byte for each flip: as floating-point numbers all flips would be as large as columns of the run.
        let flips: Vec<bool> = (0..flips * groups).map(|_| !random.random::<bool>()).collect();
        let largest_of = |flips: &[bool]| {
            let signs: Vec<f64> = flips.iter().map(|flipped| if *flipped { -1.0 } else { 1.0 }).collect();
            scores.iter().map(|s| s.borrow().z_flipped(&signs)).fold(f64::NEG_INFINITY, f64::max)
        };
        let mut largest: Vec<f64> = flips.par_chunks(groups.max(1)).map(largest_of).collect();
        largest.sort_by(f64::total_cmp);
        Self { largest }
    }

    /// The score that this share of flips stays below.
    pub fn quantile(&self, share: f64) -> f64 {
        self.largest.get((share * self.largest.len() as f64) as usize).copied().unwrap_or(f64::INFINITY)
    }

    /// Share of flips whose largest score is at least `z`. It is one if no candidate has an orthogonal part.
    pub fn p_value(&self, z: f64) -> f64 {
        let below = self.largest.partition_point(|l| *l < z);
        (1 + self.largest.len() - below) as f64 / (1 + self.largest.len()) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sums of one column over many groups, with a total of zero.
    fn sums(groups: usize, turn: f64) -> Vec<f64> {
        let noise = |g: usize| (turn * (g * g) as f64).sin();
        let mean = (0..groups).map(noise).sum::<f64>() / groups as f64;
        (0..groups).map(|g| noise(g) - mean).collect()
    }

    #[test]
    fn a_coefficient_at_the_required_multiple_of_its_noise_reaches_the_score() {
        for columns in [1, 3] {
            let noise: Vec<Vec<f64>> = (0..columns).map(|c| sums(1000, 1.0 + c as f64)).collect();
            let first = &noise[0];
            let times = Score::new(&noise).needed(3.0, 1000.0);
            // The sums of the first column, shifted so that their total is this number of standard errors.
            let each = times * dot(first, first).sqrt() / 1000.0;
            let mut moved = noise.clone();
            moved[0].iter_mut().for_each(|s| *s += each);
            let z = Score::new(&moved).z();
            assert!((z - 3.0).abs() < 0.1, "{columns} columns: {times} times gives a score of {z}");
        }
    }

    #[test]
    fn what_has_nothing_of_its_own_is_chance() {
        assert_eq!(MaxTNull::new(&[Score::new(&[])], 499, 0).p_value(5.0), 1.0);
        let noise = Score::new(&[sums(50, 1.0)]);
        assert_eq!(MaxTNull::new(&[noise], 499, 0).p_value(50.0), 0.002);
    }
}
