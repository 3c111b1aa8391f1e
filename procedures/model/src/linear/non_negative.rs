//! Least squares with non-negative coefficients.

use crate::linear::cholesky::Cholesky;

/// Coefficients x ≥ 0 that minimise xᵀ·gram·x − 2·sideᵀ·x (Lawson and Hanson 1974, ch. 23). `gram` is row-major.
pub fn non_negative(gram: &[f64], side: &[f64]) -> Vec<f64> {
    let n = side.len();
    let slack = 1e-10 * side.iter().fold(0.0f64, |most, s| most.max(s.abs()));
    let (mut x, mut free) = (vec![0.0; n], vec![false; n]);
    for _ in 0..3 * n {
        let slope = |i: usize| side[i] - (0..n).map(|k| gram[i * n + k] * x[k]).sum::<f64>();
        let rising = (0..n).filter(|i| !free[*i]).map(|i| (i, slope(i))).filter(|(_, s)| *s > slack);
        let Some((steepest, _)) = rising.max_by(|a, b| a.1.total_cmp(&b.1)) else { break };
        free[steepest] = true;
        // Each round frees no coefficient and binds at least one.
        for _ in 0..=n {
            let wanted = among(gram, side, &free);
            let bound = (0..n).filter(|i| free[*i] && wanted[*i] <= 0.0);
            let Some(share) = bound.map(|i| x[i] / (x[i] - wanted[i])).reduce(f64::min) else {
                x = wanted;
                break;
            };
            for i in 0..n {
                x[i] += share * (wanted[i] - x[i]);
                if free[i] && x[i] <= 1e-12 * wanted.iter().fold(0.0f64, |most, w| most.max(w.abs())) {
                    (x[i], free[i]) = (0.0, false);
                }
            }
        }
    }
    x
}

/// The solution with the bound coefficients at zero.
fn among(gram: &[f64], side: &[f64], free: &[bool]) -> Vec<f64> {
    let n = side.len();
    let kept: Vec<usize> = (0..n).filter(|i| free[*i]).collect();
    let part: Vec<f64> = kept.iter().flat_map(|a| kept.iter().map(move |b| gram[a * n + b])).collect();
    let of_kept: Vec<f64> = kept.iter().map(|a| side[*a]).collect();
    let mut x = vec![0.0; n];
    let solved = Cholesky::new(&part, kept.len(), 1e-9).solve(&of_kept);
    kept.into_iter().zip(solved).for_each(|(i, value)| x[i] = value);
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_coefficient_that_would_be_negative_is_zero() {
        // Columns (1, 0), (1, 1) and the target (1, −1): the unconstrained second coefficient is −1.
        let x = non_negative(&[1.0, 1.0, 1.0, 2.0], &[1.0, 0.0]);
        assert!((x[0] - 1.0).abs() < 1e-6 && x[1] == 0.0, "{x:?}");
        let x = non_negative(&[1.0, 1.0, 1.0, 2.0], &[3.0, 4.0]);
        assert!((x[0] - 2.0).abs() < 1e-6 && (x[1] - 1.0).abs() < 1e-6, "{x:?}");
    }
}
