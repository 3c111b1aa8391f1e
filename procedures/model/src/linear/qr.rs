//! The fit that is shown: QR on scaled columns, refused where columns are dependent.

use faer::linalg::solvers::SolveLstsqCore;
use faer::{Conj, Mat, Par};

/// Factors of the columns, and how well they are determined.
#[derive(Debug, Clone, PartialEq)]
pub struct Solution {
    pub factors: Vec<f64>,
    /// Ratio of the largest to the smallest singular value of the scaled columns.
    pub condition: f64,
    /// A column that is a sum of others, with the strongest of them, where the condition is beyond use.
    pub dependent: Option<(usize, usize)>,
}

/// Every QR is silently wrong on exactly dependent columns of different size; the condition of the scaled ones tells.
const WORST_CONDITION: f64 = 1e9;

/// Least squares of `y` on columns of the same length. Cost O(rows·columns²).
pub fn solve(columns: &[&[f64]], y: &[f64]) -> Solution {
    faer::set_global_parallelism(Par::Seq);
    let (n, p) = (y.len(), columns.len());
    if p == 0 {
        return Solution { factors: Vec::new(), condition: 1.0, dependent: None };
    }
    let norm: Vec<f64> = columns.iter().map(|c| super::dot(c, c).sqrt()).collect();
    let scaled = Mat::from_fn(n, p, |i, j| if norm[j] > 0.0 { columns[j][i] / norm[j] } else { 0.0 });
    let qr = scaled.qr();
    let r = qr.thin_R().to_owned();
    let (condition, dependent) = condition(&r);
    let mut factors = Mat::from_fn(n, 1, |i, _| y[i]);
    if dependent.is_none() {
        qr.solve_lstsq_in_place_with_conj(Conj::No, factors.as_mut());
    }
    let factors = (0..p).map(|j| if dependent.is_none() { factors[(j, 0)] / norm[j] } else { 0.0 }).collect();
    Solution { factors, condition, dependent }
}

fn condition(r: &Mat<f64>) -> (f64, Option<(usize, usize)>) {
    let p = r.ncols();
    let Ok(svd) = r.svd() else { return (f64::INFINITY, Some((0, p - 1))) };
    let values = svd.S().column_vector();
    let (largest, smallest) = (values[0], values[p - 1]);
    let condition = if smallest > 0.0 { largest / smallest } else { f64::INFINITY };
    if condition <= WORST_CONDITION {
        return (condition, None);
    }
    // The last right singular vector is the combination that vanishes: its two largest entries are the culprits.
    let v = svd.V();
    let mut order: Vec<usize> = (0..p).collect();
    order.sort_by(|a, b| v[(*b, p - 1)].abs().total_cmp(&v[(*a, p - 1)].abs()));
    let (a, b) = (order[0], *order.get(1).unwrap_or(&order[0]));
    (condition, Some((a.min(b), a.max(b))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_found_whatever_its_units() {
        let x: Vec<f64> = (0..50).map(f64::from).collect();
        let huge: Vec<f64> = x.iter().map(|x| 1e9 * (0.1 * x).sin()).collect();
        let y: Vec<f64> = x.iter().zip(&huge).map(|(x, h)| 3.0 * x + 2e-9 * h).collect();
        let s = solve(&[&x, &huge], &y);
        assert!((s.factors[0] - 3.0).abs() < 1e-9 && (s.factors[1] - 2e-9).abs() < 1e-18, "{s:?}");
        assert!(s.condition < 10.0);
    }

    #[test]
    fn it_agrees_with_the_singular_value_decomposition_of_nalgebra() {
        let n = 200;
        let columns: Vec<Vec<f64>> = (1..=6)
            .map(|k| (0..n).map(|i| (0.013 * f64::from(k) * i as f64).sin() * 10f64.powi(k - 3)).collect())
            .collect();
        let y: Vec<f64> = (0..n).map(|i| (0.07 * i as f64).cos()).collect();
        let refs: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
        let own = solve(&refs, &y);
        let matrix = nalgebra::DMatrix::from_fn(n, 6, |i, j| columns[j][i]);
        let oracle = matrix.svd(true, true).solve(&nalgebra::DVector::from_vec(y), 1e-14).unwrap();
        for (a, b) in own.factors.iter().zip(oracle.iter()) {
            assert!((a / b - 1.0).abs() < 1e-8, "{a} {b}");
        }
    }

    #[test]
    fn proportional_columns_are_refused() {
        let x: Vec<f64> = (0..50).map(f64::from).collect();
        let z: Vec<f64> = x.iter().map(|x| 1e6 * x).collect();
        let one = vec![1.0; 50];
        assert_eq!(solve(&[&one, &x, &z], &x).dependent, Some((1, 2)));
    }
}
