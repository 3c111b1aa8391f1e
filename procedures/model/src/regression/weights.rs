//! Weights of rows from the residual's dependence on the time to the nearest reversal, the acceleration and the jerk.
//!
//! No row is removed; a row with a larger expected error gets a smaller weight.

use crate::linear::cholesky::Cholesky;
use crate::preprocess::form_error::FormError;
use crate::stats::summary::quantile;

/// Bounds of the weights; the median weight is 1.
const LEAST: f64 = 0.2;
const MOST: f64 = 3.0;
/// Added to times [s], and to accelerations and jerks as a share of the largest, before the logarithm.
const SOON_S: f64 = 0.05;
const LATE_S: f64 = 2.0;
const STILL: f64 = 0.05;
/// Added to squared errors before the logarithm, as a share of their median.
const EXACT: f64 = 1e-3;

/// One over the standard deviation of the residual, as a smooth function of reversal time, acceleration and jerk.
pub fn weights(form_error: &FormError, residual: &[f64]) -> Vec<f64> {
    let middle = quantile(residual.iter().map(|e| e * e), 0.5);
    let floor = (EXACT * middle).max(f64::MIN_POSITIVE);
    let sizes: Vec<f64> = residual.iter().map(|e| (e * e + floor).ln()).collect();
    let fast = form_error.fast.each_ref().map(|size| {
        let still = STILL * size.iter().fold(0.0f64, |most, v| most.max(*v)) + 1e-12;
        size.iter().map(|v| (v + still).ln()).collect::<Vec<f64>>()
    });
    let turn: Vec<f64> = form_error.turn_s.iter().map(|t| (t.min(LATE_S) + SOON_S).ln()).collect();
    let one = vec![1.0; residual.len()];
    let columns = [&one, &turn, &fast[0], &fast[1]];
    let expected = regressed(&columns, &sizes);
    let usual = quantile(expected.iter().copied(), 0.5);
    expected.into_iter().map(|e| (-0.5 * (e - usual)).exp().clamp(LEAST, MOST)).collect()
}

/// Least-squares prediction of values from some columns. The first column is constant.
fn regressed(columns: &[&Vec<f64>], values: &[f64]) -> Vec<f64> {
    let n = values.len().max(1) as f64;
    let means: Vec<f64> = columns.iter().map(|c| c.iter().sum::<f64>() / n).collect();
    let about = |k: usize, row: usize| if k == 0 { 1.0 } else { columns[k][row] - means[k] };
    let p = columns.len();
    let (mut gram, mut side) = (vec![0.0; p * p], vec![0.0; p]);
    for (row, value) in values.iter().enumerate() {
        for a in 0..p {
            side[a] += about(a, row) * value;
            for b in 0..p {
                gram[a * p + b] += about(a, row) * about(b, row);
            }
        }
    }
    let coefficients = Cholesky::new(&gram, p, 1e-9).solve(&side);
    (0..values.len()).map(|row| (0..p).map(|k| coefficients[k] * about(k, row)).sum()).collect()
}
