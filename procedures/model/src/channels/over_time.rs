//! Functions over time. Nothing is computed across a pause.

use std::ops::Range;

/// A pause is a time step longer than this multiple of the usual one.
const PAUSE: f64 = 5.0;

/// Rows that follow each other without a pause.
pub fn stretches(time_s: &[f64]) -> Vec<Range<usize>> {
    let longest = PAUSE * usual_step_s(time_s);
    let mut found = Vec::new();
    let mut begin = 0;
    for (i, pair) in time_s.windows(2).enumerate() {
        let step_s = pair[1] - pair[0];
        if step_s.is_nan() || step_s > longest {
            found.push(begin..i + 1);
            begin = i + 1;
        }
    }
    found.push(begin..time_s.len());
    found
}

/// The median step [s].
pub fn usual_step_s(time_s: &[f64]) -> f64 {
    let mut steps: Vec<f64> = time_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
    if steps.is_empty() {
        return f64::NAN;
    }
    let middle = steps.len() / 2;
    *steps.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// Central difference, one-sided at the ends of a stretch.
pub fn derivative(time_s: &[f64], values: &[f64]) -> Vec<f64> {
    let mut slopes = vec![f64::NAN; values.len()];
    for stretch in stretches(time_s).into_iter().filter(|stretch| stretch.len() > 1) {
        for i in stretch.clone() {
            let (before, after) = (i.saturating_sub(1).max(stretch.start), (i + 1).min(stretch.end - 1));
            slopes[i] = (values[after] - values[before]) / (time_s[after] - time_s[before]);
        }
    }
    slopes
}

/// Trapezoidal integral from the first row on. A missing value and a pause add nothing.
pub fn integral(time_s: &[f64], values: &[f64]) -> Vec<f64> {
    let mut sums = vec![0.0; values.len()];
    let mut sum = 0.0;
    for stretch in stretches(time_s) {
        for i in stretch.clone() {
            if i > stretch.start {
                let area = (values[i] + values[i - 1]) / 2.0 * (time_s[i] - time_s[i - 1]);
                sum += if area.is_finite() { area } else { 0.0 };
            }
            sums[i] = sum;
        }
    }
    sums
}

/// Mean over an interval of `over_s` around each row, without missing values.
pub fn smooth(time_s: &[f64], values: &[f64], over_s: f64) -> Vec<f64> {
    let mut means = vec![f64::NAN; values.len()];
    for stretch in stretches(time_s) {
        let (mut first, mut end, mut sum, mut n) = (stretch.start, stretch.start, 0.0, 0_usize);
        for i in stretch.clone() {
            // The clock of a run has a resolution of microseconds, so that half a microsecond is a tolerance.
            let (low, high) = (time_s[i] - over_s / 2.0 - 5e-7, time_s[i] + over_s / 2.0 + 5e-7);
            while end < stretch.end && time_s[end] <= high {
                (sum, n) = if values[end].is_finite() { (sum + values[end], n + 1) } else { (sum, n) };
                end += 1;
            }
            while time_s[first] < low {
                (sum, n) = if values[first].is_finite() { (sum - values[first], n - 1) } else { (sum, n) };
                first += 1;
            }
            means[i] = if n > 0 { sum / n as f64 } else { f64::NAN };
        }
    }
    means
}
