//! Correlated noise, and segments that differ.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

const CORRELATION: f64 = 0.85;

/// Noise of one run.
pub struct Noise {
    random: ChaCha8Rng,
    state: f64,
    /// Standard deviation of the noise from sample to sample.
    size: f64,
    /// Standard deviation of offset, tilt and direction-dependent offset of each segment.
    scatter: f64,
    offset: f64,
    tilt: f64,
    directed: f64,
}

impl Noise {
    pub fn new(seed: u64, size: f64, scatter: f64) -> Self {
        let random = ChaCha8Rng::seed_from_u64(seed);
        let mut noise = Self { random, state: 0.0, size, scatter, offset: 0.0, tilt: 0.0, directed: 0.0 };
        noise.state = noise.normal();
        noise.segment();
        noise
    }

    fn normal(&mut self) -> f64 {
        StandardNormal.sample(&mut self.random)
    }

    /// Starts a new segment.
    pub fn segment(&mut self) {
        self.offset = self.scatter * self.normal();
        self.tilt = self.scatter * self.normal();
        self.directed = self.scatter * self.normal();
    }

    /// At `place` from −1 to 1 within the segment, moving in `direction`.
    pub fn next(&mut self, place: f64, direction: f64) -> f64 {
        let fresh = self.normal();
        self.state = CORRELATION * self.state + (1.0 - CORRELATION * CORRELATION).sqrt() * fresh;
        self.size * self.state + self.offset + self.tilt * place + self.directed * direction
    }
}
