//! Least squares with few parameters and their intervals.

use jointbench_model::stats::{jackknife, student};
use nalgebra::{SMatrix, SVector};
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Parameters with the half widths of their 95 % intervals.
#[derive(Debug, Clone, Copy)]
pub struct Solved<const N: usize> {
    pub values: [f64; N],
    pub reach: [f64; N],
}

impl<const N: usize> Solved<N> {
    pub fn ci95(&self, i: usize) -> [f64; 2] {
        [self.values[i] - self.reach[i], self.values[i] + self.reach[i]]
    }
}

/// `None` with fewer rows than parameters plus one, or if the rows do not separate the parameters.
pub fn solve<const N: usize>(rows: &[[f64; N]], y: &[f64]) -> Option<Solved<N>> {
    if rows.len() <= N || rows.len() != y.len() {
        return None;
    }
    let mut normal = SMatrix::<f64, N, N>::zeros();
    let mut right = SVector::<f64, N>::zeros();
    for (row, y) in rows.iter().zip(y) {
        let row = SVector::<f64, N>::from(*row);
        normal += row * row.transpose();
        right += row * *y;
    }
    let inverse = normal.cholesky()?.inverse();
    let values = inverse * right;
    let left = rows.iter().zip(y).map(|(row, y)| (y - SVector::<f64, N>::from(*row).dot(&values)).powi(2));
    let freedom = (rows.len() - N) as f64;
    let variance = left.sum::<f64>() / freedom;
    let t = t95(freedom);
    let reach = std::array::from_fn(|i| t * (variance * inverse[(i, i)]).sqrt());
    Some(Solved { values: values.into(), reach })
}

/// Half width of a 95 % interval, in standard errors. Infinite without a degree of freedom.
pub fn t95(freedom: f64) -> f64 {
    student::t95(freedom).unwrap_or(f64::INFINITY)
}

/// 95 % interval of a standard deviation, for independent normal deviations.
pub fn spread_ci95(spread: f64, freedom: f64) -> Option<[f64; 2]> {
    let squares = ChiSquared::new(freedom).ok()?;
    Some([0.975, 0.025].map(|share| spread * (freedom / squares.inverse_cdf(share)).sqrt()))
}

/// Half width of a 95 % interval, from the values of a figure without each of several parts (jackknife).
pub fn jackknife95(without: &[f64]) -> f64 {
    let variance = jackknife::variance_about_mean(without.iter().copied());
    t95(without.len() as f64 - 1.0) * variance.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The jackknife of a mean of 1, 2, 3 and 6 is its standard error √(14/3/4), times t₃ = 3.182.
    #[test]
    fn the_jackknife_of_a_mean_is_its_standard_error() {
        let without = [1.0, 2.0, 3.0, 6.0].map(|value| (12.0 - value) / 3.0);
        assert!((jackknife95(&without) - 3.182 * (14.0f64 / 12.0).sqrt()).abs() < 1e-3);
    }

    /// Twelve deviations: √(11/21.920) and √(11/3.816), from tables of χ².
    #[test]
    fn a_spread_has_the_interval_of_its_distribution() {
        let [low, high] = spread_ci95(1.0, 11.0).unwrap();
        assert!((low - 0.70840).abs() < 1e-4 && (high - 1.69788).abs() < 1e-4, "{low} {high}");
        assert_eq!(spread_ci95(1.0, 0.0), None);
    }

    /// y = 1 + 2x with deviations: slope 1.98, offset 1.04, Σ² = 0.036, standard error of the slope √(0.012/10).
    #[test]
    fn a_line_is_found_with_its_interval() {
        let rows: Vec<[f64; 2]> = (0..5).map(|x| [1.0, f64::from(x)]).collect();
        let solved = solve(&rows, &[1.1, 2.9, 5.1, 6.9, 9.0]).unwrap();
        assert!((solved.values[0] - 1.04).abs() < 1e-12 && (solved.values[1] - 1.98).abs() < 1e-12, "{solved:?}");
        assert!((solved.reach[1] - 3.182_446 * (0.012_f64 / 10.0).sqrt()).abs() < 1e-5, "{solved:?}");
        assert!(solve(&rows[..2], &[1.0, 2.0]).is_none());
        assert!(solve(&[[1.0, 2.0]; 4], &[1.0; 4]).is_none(), "all at one place");
    }
}
