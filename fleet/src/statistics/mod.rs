//! Statistics over units. No function knows of files or models.

pub mod false_discovery;
pub mod outliers;
pub mod proportion;
pub mod random_effects;
pub mod shift;

use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

pub use jointbench_model::stats::proportion::Z95;

/// Two-sided p-value of a standard normal statistic.
pub fn normal_p_value(z: f64) -> f64 {
    2.0 * Normal::standard().sf(z.abs())
}

/// Half width of a 95 % interval of an estimate with `freedom` degrees of freedom, in standard errors (Student's t).
/// Infinite without a degree of freedom.
pub fn student_95(freedom: f64) -> f64 {
    StudentsT::new(0.0, 1.0, freedom).map_or(f64::INFINITY, |law| law.inverse_cdf(0.975))
}

/// Two-sided p-value of Student's t with `freedom` degrees of freedom; 1 without a degree of freedom.
pub fn student_p_value(freedom: f64, t: f64) -> f64 {
    StudentsT::new(0.0, 1.0, freedom).map_or(1.0, |law| 2.0 * law.sf(t.abs()))
}

/// Median: the mean of the middle two of an even number of values. `None` without values.
pub fn median(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.into_iter().collect();
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    match values.len() {
        0 => None,
        n if n % 2 == 1 => Some(values[middle]),
        _ => Some(0.5 * (values[middle - 1] + values[middle])),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tails_are_those_of_tables() {
        assert!((normal_p_value(Z95) - 0.05).abs() < 1e-9 && (normal_p_value(-Z95) - 0.05).abs() < 1e-9);
        assert!((student_95(4.0) - 2.776).abs() < 1e-3 && student_95(0.0).is_infinite());
        assert!((student_p_value(4.0, -2.776) - 0.05).abs() < 1e-4);
        assert_eq!((median([3.0, 1.0, 2.0]), median([4.0, 1.0]), median([])), (Some(2.0), Some(2.5), None));
    }
}
