//! Means over groups of neighbouring rows, and deviations from them.

use std::ops::Range;

/// Deviations of values from the mean of their leg.
pub fn within(values: &[f64], legs: &[Range<usize>]) -> Vec<f64> {
    let mut left = values.to_vec();
    for (mean, leg) in means(values, legs).into_iter().zip(legs) {
        left[leg.clone()].iter_mut().for_each(|value| *value -= mean);
    }
    left
}

/// Mean of each group.
pub fn means(values: &[f64], legs: &[Range<usize>]) -> Vec<f64> {
    legs.iter().map(|leg| values[leg.clone()].iter().sum::<f64>() / leg.len() as f64).collect()
}
