//! Control of the false discovery rate over many tests (Benjamini, Hochberg 1995).

/// Expected share of false discoveries among all discoveries, at most. The level of the daemon's own tests.
pub const RATE: f64 = jointbench_model::thresholds::ALPHA;

/// Which hypotheses are rejected at a false discovery rate, for independent or positively dependent p-values. NaN is
/// never rejected but counts as a test.
pub fn discoveries(p_values: &[f64], rate: f64) -> Vec<bool> {
    let limit = limit(p_values, rate);
    p_values.iter().map(|p| *p <= limit).collect()
}

/// The largest rejected p-value; negative if no hypothesis is rejected.
pub fn limit(p_values: &[f64], rate: f64) -> f64 {
    let mut sorted: Vec<f64> = p_values.iter().copied().filter(|p| !p.is_nan()).collect();
    sorted.sort_by(f64::total_cmp);
    let step = rate / p_values.len().max(1) as f64;
    let last = sorted.iter().enumerate().rev().find(|(rank, p)| **p <= step * (rank + 1) as f64);
    last.map_or(-1.0, |(_, p)| *p)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_example_of_the_authors_has_four_discoveries() {
        // Benjamini and Hochberg's table of 15 p-values: four are below their line at 0.05, Bonferroni has three.
        let p = [
            0.0001, 0.0004, 0.0019, 0.0095, 0.0201, 0.0278, 0.0298, 0.0344, 0.0459, 0.3240, 0.4262, 0.5719, 0.6528,
            0.7590, 1.0,
        ];
        let found = discoveries(&p, 0.05);
        assert_eq!(found.iter().filter(|is| **is).count(), 4);
        assert!(found[..4].iter().all(|is| *is));
    }

    #[test]
    fn untested_hypotheses_count_and_are_not_discovered() {
        assert_eq!(discoveries(&[0.04, f64::NAN], 0.05), [false, false]);
        assert_eq!(discoveries(&[0.02, f64::NAN], 0.05), [true, false]);
        assert!(discoveries(&[], 0.05).is_empty());
    }
}
