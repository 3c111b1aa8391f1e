//! Batches whose mean differs from that of the other batches.

use super::random_effects::{Estimate, Population, population};
use super::{median, student_p_value};

/// Fewer units do not estimate the variance within a batch.
const FEWEST: usize = 5;

/// The mean of a batch against the median of the means of all batches.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BatchMean {
    /// The units of the batch.
    pub population: Population,
    /// Its mean minus the median of all means.
    pub difference: f64,
    /// Standard error of the difference.
    pub standard_error: f64,
    /// Two-sided, Student's t.
    pub p_value: f64,
}

/// The mean of each batch with at least five units, in the order of the batches. `None` for other batches, and with
/// fewer than two batches.
///
/// The reference is the median of the means, so that one shifted batch does not make all others differ. Its variance is
/// π/2 times that of a mean, the ratio for normal values (Hampel 1974).
pub fn batch_means(batches: &[Vec<Estimate>]) -> Vec<Option<BatchMean>> {
    let means: Vec<Option<Population>> =
        batches.iter().map(|units| population(units).filter(|found| found.units >= FEWEST)).collect();
    let known: Vec<&Population> = means.iter().flatten().collect();
    let Some(reference) = median(known.iter().map(|p| p.mean)).filter(|_| known.len() > 1) else {
        return vec![None; batches.len()];
    };
    let count = known.len() as f64;
    let variances: f64 = known.iter().map(|p| p.standard_error().powi(2)).sum();
    let of_reference = std::f64::consts::FRAC_PI_2 * variances / (count * count);
    let compare = |population: &Population| {
        let difference = population.mean - reference;
        let standard_error = (population.standard_error().powi(2) + of_reference).sqrt();
        let p_value = student_p_value(population.units as f64 - 1.0, difference / standard_error);
        BatchMean { population: *population, difference, standard_error, p_value }
    };
    means.iter().map(|found| found.as_ref().map(compare)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_shifted_batch_differs() {
        let unit = |i: usize| Estimate { value: ((i * 29 % 61) as f64 / 61.0 - 0.5) * 0.1, standard_error: 0.01 };
        let mut batches: Vec<Vec<Estimate>> = (0..5).map(|b| (0..40).map(|i| unit(i + 3 * b)).collect()).collect();
        batches[3].iter_mut().for_each(|e| e.value += 0.05);
        batches.push(vec![unit(1); 2]);
        let found = batch_means(&batches);
        assert_eq!(found[5], None, "too few units");
        let known: Vec<BatchMean> = found.into_iter().flatten().collect();
        let differs: Vec<bool> = known.iter().map(|mean| mean.p_value < 1e-4).collect();
        assert_eq!(differs, [false, false, false, true, false], "{known:?}");
        assert!((known[3].difference - 0.05).abs() < 0.01, "{:?}", known[3]);
        assert_eq!(batch_means(&batches[..1]), [None]);
    }
}
