//! Points and histograms of an encoder.

use crate::identification::{Mark, Series};

/// Largest number of points in a figure, evenly spaced.
const MOST_POINTS: usize = 1500;

pub fn scatter(label: &str, x: &[f64], y: &[f64]) -> Series {
    let every = x.len().div_ceil(MOST_POINTS).max(1);
    let thin = |all: &[f64]| all.iter().copied().step_by(every).collect();
    Series::new(label, Mark::Points, thin(x), thin(y))
}

/// Relative frequencies of the values in equal bins between the lowest and the highest.
pub fn histogram(label: &str, values: &[f64], bins: usize) -> Series {
    let (low, high) = values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
    let width = ((high - low) / bins as f64).max(f64::MIN_POSITIVE);
    let mut shares = vec![0.0; bins];
    for value in values {
        shares[(((value - low) / width) as usize).min(bins - 1)] += 1.0 / values.len() as f64;
    }
    let x = (0..bins).map(|bin| low + (bin as f64 + 0.5) * width).collect();
    Series::new(label, Mark::Bars, x, shares)
}
