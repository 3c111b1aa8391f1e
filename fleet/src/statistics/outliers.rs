//! Units that differ from the others by more than the variance between units and their own error explain.

use super::false_discovery::{RATE, discoveries};
use super::random_effects::Estimate;
use super::{median, normal_p_value};

/// Ratio of the standard deviation of a normal distribution to its median absolute deviation.
const NORMAL_MAD: f64 = 1.482_602_218_505_602;

/// The deviation of each unit in standard deviations, and whether the unit is an outlier.
///
/// Location and spread are the median and the median absolute deviation (Hampel 1974), so that outliers do not hide
/// each other. `group` numbers the batch of each unit: deviations are from the median of the batch, because a batch
/// that differs as a whole is no list of outliers. The test is normal, with the false discovery rate [`RATE`].
pub fn outliers(estimates: &[Estimate], group: &[usize]) -> Vec<(f64, bool)> {
    let groups = group.iter().max().map_or(0, |last| last + 1);
    let of_group = |g: usize| (0..group.len()).filter(move |i| group[*i] == g);
    let middle: Vec<f64> = (0..groups)
        .map(|g| median(of_group(g).map(|i| estimates[i].value).filter(|v| v.is_finite())).unwrap_or(0.0))
        .collect();
    let deviation: Vec<f64> = estimates.iter().zip(group).map(|(e, g)| e.value - middle[*g]).collect();
    let finite = || estimates.iter().zip(&deviation).filter(|(e, d)| d.is_finite() && e.standard_error.is_finite());
    let spread = NORMAL_MAD * median(finite().map(|(_, d)| d.abs())).unwrap_or(0.0);
    let error = median(finite().map(|(e, _)| e.standard_error.powi(2))).unwrap_or(0.0);
    let between = (spread.powi(2) - error).max(0.0);
    let score = |(e, d): (&Estimate, &f64)| d / (between + e.standard_error.powi(2)).sqrt();
    let scores: Vec<f64> = estimates.iter().zip(&deviation).map(score).collect();
    let p_values: Vec<f64> = scores.iter().map(|z| normal_p_value(*z)).collect();
    scores.into_iter().zip(discoveries(&p_values, RATE)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_far_unit_is_an_outlier_and_an_uncertain_or_a_shifted_one_is_not() {
        let spread = |i: usize| ((i * 37 % 101) as f64 / 101.0 - 0.5) * 2.0;
        let mut estimates: Vec<Estimate> =
            (0..200).map(|i| Estimate { value: 10.0 + spread(i), standard_error: 0.1 }).collect();
        let group: Vec<usize> = (0..200).map(|i| usize::from(i >= 150)).collect();
        estimates[150..].iter_mut().for_each(|e| e.value += 40.0);
        estimates[7].value = 25.0;
        estimates[9] = Estimate { value: 25.0, standard_error: 20.0 };
        let found: Vec<usize> = (0..200).filter(|i| outliers(&estimates, &group)[*i].1).collect();
        assert_eq!(found, [7]);
    }
}
