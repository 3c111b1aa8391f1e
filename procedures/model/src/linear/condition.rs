//! Whether the columns of the reported fit are linearly independent: QR of scaled columns, and the singular values of
//! R.

use crate::linear::basis::dot;
use nalgebra::DMatrix;

/// How well the coefficients of columns are determined.
#[derive(Debug, Clone, PartialEq)]
pub struct Condition {
    /// Ratio of the largest to the smallest singular value of the scaled columns.
    pub number: f64,
    /// A linearly dependent column, and the column that contributes most to the dependence, if the condition number
    /// is too large.
    pub dependent: Option<(usize, usize)>,
}

/// Largest usable condition number. Least squares on exactly dependent columns of different size is wrong without a
/// warning, and the condition number of the scaled columns detects it.
const WORST: f64 = 1e9;

/// Cost O(rows·columns²).
pub fn condition(columns: &[&[f64]]) -> Condition {
    let (n, p) = (columns.first().map_or(0, |c| c.len()), columns.len());
    if p == 0 {
        return Condition { number: 1.0, dependent: None };
    }
    let norm: Vec<f64> = columns.iter().map(|c| dot(c, c).sqrt()).collect();
    // A column with an infinite norm counts as zero; the decomposition would not terminate on it.
    let counts: Vec<bool> = norm.iter().map(|norm| *norm > 0.0 && norm.is_finite()).collect();
    // Rows of zeros do not change singular values and guarantee at least as many rows as columns.
    let scaled = DMatrix::from_fn(n.max(p), p, |i, j| if i < n && counts[j] { columns[j][i] / norm[j] } else { 0.0 });
    let svd = scaled.qr().unpack_r().svd(false, true);
    let (largest, smallest) = (svd.singular_values[0], svd.singular_values[p - 1]);
    let number = if smallest > 0.0 { largest / smallest } else { f64::INFINITY };
    let vanishing = svd.v_t.filter(|_| number > WORST).map(|v| v.row(p - 1).into_owned());
    let dependent = vanishing.map(|weights| {
        // The two largest entries of the vanishing combination identify the dependent columns.
        let mut order: Vec<usize> = (0..p).collect();
        order.sort_by(|a, b| weights[*b].abs().total_cmp(&weights[*a].abs()));
        let a = order[0];
        // A column of zeros is dependent by itself.
        let b = order.get(1).copied().filter(|b| weights[*b].abs() > 1e-9).unwrap_or(a);
        (a.min(b), a.max(b))
    });
    Condition { number, dependent }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_size_of_a_column_is_no_matter() {
        let x: Vec<f64> = (0..50).map(f64::from).collect();
        let huge: Vec<f64> = x.iter().map(|x| 1e9 * (0.1 * x).sin()).collect();
        let found = condition(&[&x, &huge]);
        assert!(found.number < 10.0 && found.dependent.is_none(), "{found:?}");
    }

    #[test]
    fn two_unit_vectors_at_an_angle_have_the_condition_of_its_half() {
        // Singular values of two unit vectors: √(1 ± cos φ).
        let (a, b) = ([1.0, 0.0, 0.0], [0.6, 0.8, 0.0]);
        assert!((condition(&[&a, &b]).number - (1.6f64 / 0.4).sqrt()).abs() < 1e-12);
    }

    #[test]
    fn proportional_columns_are_refused() {
        let x: Vec<f64> = (0..50).map(f64::from).collect();
        let z: Vec<f64> = x.iter().map(|x| 1e6 * x).collect();
        let one = vec![1.0; 50];
        assert_eq!(condition(&[&one, &x, &z]).dependent, Some((1, 2)));
        assert_eq!(condition(&[&[0.0; 4]]).dependent, Some((0, 0)));
    }

    #[test]
    fn a_column_beyond_the_range_of_numbers_is_refused() {
        for beyond in [f64::INFINITY, 1e200, f64::NAN] {
            let found = condition(&[&[1.0, 1.0, 1.0], &[1.0, 2.0, 3.0], &[beyond, 1.0, 0.0]]);
            assert_eq!(found.dependent, Some((2, 2)), "{beyond}");
        }
    }
}
