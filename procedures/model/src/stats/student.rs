//! Student's t distribution.

use statrs::distribution::{ContinuousCDF, StudentsT};

/// Half width of a 95 % interval in standard errors. `None` without a degree of freedom.
pub fn t95(freedom: f64) -> Option<f64> {
    quantile(freedom, 0.975)
}

/// The same, and two without a degree of freedom.
pub fn half_width_95(freedom: f64) -> f64 {
    t95(freedom).unwrap_or(2.0)
}

/// The value (in standard errors) that a share of the distribution stays below. `None` without a degree of freedom.
pub fn quantile(freedom: f64, share: f64) -> Option<f64> {
    Some(law(freedom)?.inverse_cdf(share))
}

/// Two-sided p-value of an absolute value. `None` without a degree of freedom.
pub fn p_value(freedom: f64, t: f64) -> Option<f64> {
    Some(2.0 * law(freedom)?.sf(t))
}

fn law(freedom: f64) -> Option<StudentsT> {
    StudentsT::new(0.0, 1.0, freedom).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn five_values_have_four_degrees_of_freedom() {
        assert!((half_width_95(4.0) - 2.776).abs() < 1e-3);
        assert!((p_value(4.0, 2.776).unwrap() - 0.05).abs() < 1e-4);
        assert_eq!((half_width_95(0.0), p_value(0.0, 1.0)), (2.0, None));
    }
}
