//! Mean and variance of a parameter between units, from its estimate and standard error in each unit.

use super::student_95;
use serde::Serialize;

/// An estimate with its standard error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// Estimate.
    pub value: f64,
    /// Standard error, in the unit of the estimate.
    pub standard_error: f64,
}

/// Units as draws from a population (DerSimonian, Laird 1986).
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Population {
    /// Number of units.
    pub units: usize,
    /// Mean over the population.
    pub mean: f64,
    /// 95 % interval of the mean: Student's t with one degree of freedom less than units.
    pub ci95: [f64; 2],
    /// Standard deviation between units, without the error of the estimates.
    pub between_sd: f64,
    /// Share of the observed variance that is between units, 0 to 1 (I², Higgins, Thompson 2002).
    pub heterogeneity: f64,
}

impl Population {
    /// The standard error of the mean.
    pub fn standard_error(&self) -> f64 {
        (self.ci95[1] - self.mean) / student_95(self.units as f64 - 1.0)
    }
}

/// The moment estimate of DerSimonian and Laird. `None` for fewer than two finite estimates with a standard error.
pub fn population(estimates: &[Estimate]) -> Option<Population> {
    let is_usable = |e: &&Estimate| e.value.is_finite() && e.standard_error.is_finite() && e.standard_error > 0.0;
    let usable: Vec<&Estimate> = estimates.iter().filter(is_usable).collect();
    if usable.len() < 2 {
        return None;
    }
    let freedom = usable.len() as f64 - 1.0;
    let weight = |e: &Estimate, between: f64| 1.0 / (e.standard_error.powi(2) + between);
    let mean = |between: f64| {
        let sums = usable.iter().map(|e| (weight(e, between), weight(e, between) * e.value));
        let (weights, values) = sums.fold((0.0, 0.0), |(a, b), (w, v)| (a + w, b + v));
        (values / weights, weights)
    };
    let (fixed, weights) = mean(0.0);
    let q: f64 = usable.iter().map(|e| weight(e, 0.0) * (e.value - fixed).powi(2)).sum();
    let squares: f64 = usable.iter().map(|e| weight(e, 0.0).powi(2)).sum();
    let between = ((q - freedom) / (weights - squares / weights)).max(0.0);
    let (mean, weights) = mean(between);
    let half = student_95(freedom) / weights.sqrt();
    Some(Population {
        units: usable.len(),
        mean,
        ci95: [mean - half, mean + half],
        between_sd: between.sqrt(),
        heterogeneity: if q > 0.0 { ((q - freedom) / q).max(0.0) } else { 0.0 },
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn estimate(value: f64, standard_error: f64) -> Estimate {
        Estimate { value, standard_error }
    }

    #[test]
    fn equal_errors_give_the_variance_of_the_values_less_that_of_the_errors() {
        let values = [1.0, 2.0, 4.0, 7.0];
        let found = population(&values.map(|v| estimate(v, 0.5))).unwrap();
        let mean = 3.5;
        let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / 3.0;
        assert!((found.mean - mean).abs() < 1e-12);
        assert!((found.between_sd.powi(2) - (variance - 0.25)).abs() < 1e-12);
        assert!((found.standard_error() - (variance / 4.0).sqrt()).abs() < 1e-9);
    }

    #[test]
    fn equal_units_have_no_variance_between_them_and_precise_ones_count_more() {
        let found = population(&[estimate(1.0, 0.1), estimate(1.3, 0.3)]).unwrap();
        assert_eq!((found.between_sd, found.heterogeneity), (0.0, 0.0));
        assert!((found.mean - 1.03).abs() < 1e-12);
    }

    #[test]
    fn estimates_without_an_error_are_not_used() {
        let with = [estimate(1.0, 0.1), estimate(9.0, f64::INFINITY), estimate(f64::NAN, 0.1), estimate(1.2, 0.1)];
        assert_eq!(population(&with).unwrap().units, 2);
        assert_eq!(population(&with[..2]), None);
    }
}
