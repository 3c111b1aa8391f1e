//! Least squares with standard errors that are robust against correlated errors.

use nalgebra::{DMatrix, DVector};

/// Coefficients and standard errors of a regression whose errors are correlated within blocks of rows (Liang and
/// Zeger 1986).
pub struct Regression {
    pub coefficients: Vec<f64>,
    pub errors: Vec<f64>,
}

const BLOCKS: usize = 30;

/// Regression of `y` on columns. `None` if the columns are linearly dependent.
pub fn regression(columns: &[&[f64]], y: &[f64]) -> Option<Regression> {
    let (n, p) = (y.len(), columns.len());
    let scales: Vec<f64> = columns.iter().map(|c| (c.iter().map(|v| v * v).sum::<f64>() / n as f64).sqrt()).collect();
    if scales.iter().any(|s| !s.is_normal()) {
        return None;
    }
    let x = DMatrix::from_fn(n, p, |i, j| columns[j][i] / scales[j]);
    let gram = x.tr_mul(&x);
    let values = gram.clone().symmetric_eigen().eigenvalues;
    if values.min() < 1e-10 * values.max() {
        return None;
    }
    let inverse = gram.try_inverse()?;
    let y = DVector::from_column_slice(y);
    let theta = &inverse * x.tr_mul(&y);
    let residual = y - &x * &theta;
    let mut meat = DMatrix::zeros(p, p);
    let length = n.div_ceil(BLOCKS);
    for start in (0..n).step_by(length) {
        let rows = length.min(n - start);
        let score = x.rows(start, rows).tr_mul(&residual.rows(start, rows));
        meat += &score * score.transpose();
    }
    let blocks = BLOCKS as f64;
    let covariance = &inverse * meat * &inverse * (blocks / (blocks - p as f64).max(1.0));
    Some(Regression {
        coefficients: (0..p).map(|j| theta[j] / scales[j]).collect(),
        errors: (0..p).map(|j| covariance[(j, j)].max(0.0).sqrt() / scales[j]).collect(),
    })
}
