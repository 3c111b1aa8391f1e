//! A share with its interval.

use super::Z95;
use serde::Serialize;

/// Number of units with a property.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Share {
    /// Units with the property.
    pub count: usize,
    /// All units.
    pub of: usize,
    /// `count / of`; 0 without units.
    pub share: f64,
    /// 95 % interval of the share (Wilson 1927).
    pub ci95: [f64; 2],
}

impl Share {
    /// The score interval: it contains only possible shares, also for a count of 0.
    pub fn new(count: usize, of: usize) -> Self {
        if of == 0 {
            return Self { count, of, share: 0.0, ci95: [0.0, 1.0] };
        }
        let (n, share, square) = (of as f64, count as f64 / of as f64, Z95 * Z95);
        let middle = (share + square / (2.0 * n)) / (1.0 + square / n);
        let half = Z95 / (1.0 + square / n) * (share * (1.0 - share) / n + square / (4.0 * n * n)).sqrt();
        Self { count, of, share, ci95: [(middle - half).max(0.0), (middle + half).min(1.0)] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_interval_solves_the_score_equation() {
        // Both ends are shares whose test statistic of the observed share is the normal quantile.
        let found = Share::new(60, 2000);
        for end in found.ci95 {
            let z = (found.share - end) / (end * (1.0 - end) / 2000.0).sqrt();
            assert!((z.abs() - Z95).abs() < 1e-9, "{found:?}");
        }
        let none = Share::new(0, 100);
        assert!(none.ci95[0].abs() < 1e-12 && (none.ci95[1] - 0.03699).abs() < 1e-5, "{none:?}");
        assert_eq!(Share::new(0, 0).ci95, [0.0, 1.0]);
    }
}
