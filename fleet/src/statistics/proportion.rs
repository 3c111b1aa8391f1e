//! A share with its interval.

use jointbench_model::stats::proportion::wilson_interval;
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
        let share = if of == 0 { 0.0 } else { count as f64 / of as f64 };
        Self { count, of, share, ci95: wilson_interval(count as u64, of as u64) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::Z95;

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
