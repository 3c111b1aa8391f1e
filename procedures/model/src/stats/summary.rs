//! Range, mean, quantiles and standard deviation of values.

/// Smallest and largest value. Infinite and reversed without values.
pub fn range(values: &[f64]) -> (f64, f64) {
    values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(*v), high.max(*v)))
}

/// Largest absolute value. Zero without values.
pub fn peak(values: &[f64]) -> f64 {
    values.iter().fold(0.0f64, |most, v| most.max(v.abs()))
}

/// Root of the mean square. Zero without values.
pub fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|v| v * v).sum::<f64>() / values.len().max(1) as f64).sqrt()
}

/// Arithmetic mean. NaN without values.
pub fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Differences from the mean.
pub fn deviations(values: impl ExactSizeIterator<Item = f64> + Clone) -> impl Iterator<Item = f64> {
    let mean = values.clone().sum::<f64>() / values.len() as f64;
    values.map(move |v| v - mean)
}

/// Standard deviation. Zero for a single value.
pub fn deviation(values: &[f64]) -> f64 {
    let squares = deviations(values.iter().copied()).map(|d| d.powi(2));
    (squares.sum::<f64>() / (values.len() as f64 - 1.0).max(1.0)).sqrt()
}

/// Standard error of the mean of independent values.
pub fn standard_error(values: &[f64]) -> f64 {
    let n = values.len() as f64;
    let square: f64 = deviations(values.iter().copied()).map(|d| d.powi(2)).sum();
    (square / (n - 1.0) / n).sqrt()
}

/// The upper one of the middle two of an even number of values. Zero without values.
pub fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    if values.is_empty() {
        return 0.0;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// The nearest value to a quantile. Zero without values.
pub fn quantile(values: impl IntoIterator<Item = f64>, share: f64) -> f64 {
    let mut values: Vec<f64> = values.into_iter().collect();
    let at = (share * values.len().saturating_sub(1) as f64).round() as usize;
    if values.is_empty() { 0.0 } else { *values.select_nth_unstable_by(at, f64::total_cmp).1 }
}
