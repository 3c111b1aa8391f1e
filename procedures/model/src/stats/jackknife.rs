//! Delete-group jackknife: scatter of a figure from its values without each group.

use crate::stats::student;
use crate::stats::summary::deviations;

/// Variance of a figure from its squared changes without each of `groups` groups, or its covariance with another one
/// from their products.
pub fn variance(products: impl Iterator<Item = f64>, groups: f64) -> f64 {
    (groups - 1.0) / groups * products.sum::<f64>()
}

/// Variance of a figure from its values without each group, about their mean.
pub fn variance_about_mean(values: impl ExactSizeIterator<Item = f64> + Clone) -> f64 {
    let groups = values.len() as f64;
    variance(deviations(values).map(|d| d.powi(2)), groups)
}

/// Half width of a 95 % interval, from the changes of a figure without each group.
pub fn half_width_95(steps: impl ExactSizeIterator<Item = f64>) -> f64 {
    let groups = steps.len().max(2) as f64;
    let spread = variance(steps.map(|step| step * step), groups);
    student::half_width_95(groups - 1.0) * spread.sqrt()
}

/// Logarithm of the ratio of two sums over groups, `after` to `before`, and its standard error.
///
/// Both sums grow with the same groups. The error of their ratio is therefore much smaller than that of either sum
/// (ratio estimator, Cochran 1977, ch. 6).
pub fn log_ratio(before: &[f64], after: &[f64]) -> (f64, f64) {
    let sum = |values: &[f64]| values.iter().sum::<f64>();
    let (from, to) = (sum(before), sum(after));
    let ratio = |to: f64, from: f64| (to.max(f64::MIN_POSITIVE) / from.max(f64::MIN_POSITIVE)).ln();
    let without: Vec<f64> = before.iter().zip(after).map(|(b, a)| ratio(to - a, from - b)).collect();
    (ratio(to, from), variance_about_mean(without.iter().copied()).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stats::summary::{mean, standard_error};

    #[test]
    fn the_jackknife_of_a_mean_is_its_standard_error() {
        let values = [1.0, 4.0, 2.0, 8.0, 5.0, 7.0];
        let sum: f64 = values.iter().sum();
        let without = values.map(|v| (sum - v) / 5.0);
        let error = variance_about_mean(without.into_iter()).sqrt();
        assert!((error - standard_error(&values)).abs() < 1e-12);
        let half_width = half_width_95(without.into_iter().map(|w| w - mean(&values)));
        assert!((half_width - 2.571 * error).abs() < 1e-3 * error);
    }

    #[test]
    fn a_ratio_that_is_equal_in_all_groups_is_certain_and_one_that_rests_on_a_single_group_is_not() {
        let before = [1.0, 100.0, 2.0, 50.0];
        let (log, error) = log_ratio(&before, &before.map(|b| 0.5 * b));
        assert!((log - 0.5f64.ln()).abs() < 1e-12 && error < 1e-12);
        let (log, error) = log_ratio(&before, &[1.0, 20.0, 2.0, 50.0]);
        assert!(-log / error < 1.0, "{log} {error}");
    }
}
