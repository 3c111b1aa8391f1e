//! Randomness of a simulated machine.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;

pub struct Dice(ChaCha8Rng);

impl Dice {
    pub fn new(seed: u64) -> Self {
        Self(ChaCha8Rng::seed_from_u64(seed))
    }

    pub fn uniform(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.random::<f64>()
    }

    /// Log-uniform, for magnitudes.
    pub fn size(&mut self, low: f64, high: f64) -> f64 {
        self.uniform(low.ln(), high.ln()).exp()
    }

    pub fn phase(&mut self) -> f64 {
        self.uniform(0.0, std::f64::consts::TAU)
    }

    pub fn normal(&mut self) -> f64 {
        self.0.sample(StandardNormal)
    }

    pub fn coin(&mut self) -> bool {
        self.0.random()
    }

    pub fn sign(&mut self) -> f64 {
        if self.coin() { 1.0 } else { -1.0 }
    }

    pub fn pick<'a, T>(&mut self, of: &'a [T]) -> &'a T {
        &of[self.0.random_range(0..of.len())]
    }

    pub fn shuffle<T>(&mut self, of: &mut [T]) {
        for i in (1..of.len()).rev() {
            of.swap(i, self.0.random_range(0..=i));
        }
    }
}

/// White and correlated (AR(1)) noise with a given total RMS.
pub struct Coloured {
    white: f64,
    slow: f64,
    keep: f64,
    state: f64,
}

impl Coloured {
    /// `share` of the power is coloured with the correlation `keep` from sample to sample.
    pub fn new(rms: f64, share: f64, keep: f64) -> Self {
        Self { white: rms * (1.0 - share).sqrt(), slow: rms * share.sqrt(), keep, state: 0.0 }
    }

    pub fn next(&mut self, dice: &mut Dice) -> f64 {
        self.state = self.keep * self.state + (1.0 - self.keep * self.keep).sqrt() * dice.normal();
        self.white * dice.normal() + self.slow * self.state
    }
}
