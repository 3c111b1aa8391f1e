//! Units that differ from the others by more than the variance between units and their own error explain.

use super::random_effects::Estimate;
use super::{median, student_p_value};

/// Ratio of the standard deviation of a normal distribution to its median absolute deviation.
const NORMAL_MAD: f64 = 1.482_602_218_505_602;
/// Efficiency of the median absolute deviation for normal values (Hampel 1974): so many degrees of freedom has each value.
const EFFICIENCY: f64 = 0.37;
/// The median of fewer units is not used: it follows the units too closely, so that their deviations are too small.
const FEWEST: usize = 50;

/// The deviation of a unit in standard deviations, and its two-sided p-value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Deviation {
    /// In standard deviations of a unit: between units, and its own error.
    pub score: f64,
    /// Student's t.
    pub p_value: f64,
}

/// The deviation of each unit from the other units.
///
/// Location and spread are the median and the median absolute deviation (Hampel 1974), so that outliers do not hide
/// each other. `group` numbers the batch of each unit: if every batch has at least 50 units, deviations are from the
/// median of the batch, because a batch that differs as a whole is no list of outliers. Otherwise they are from the
/// median of all units.
pub fn deviations(estimates: &[Estimate], group: &[usize]) -> Vec<Deviation> {
    let groups = group.iter().max().map_or(0, |last| last + 1);
    let size = |g: usize| group.iter().filter(|other| **other == g).count();
    let is_by_batch = (0..groups).all(|g| size(g) >= FEWEST);
    let of_group = |g: usize| (0..group.len()).filter(move |i| !is_by_batch || group[*i] == g);
    let middle: Vec<f64> = (0..if is_by_batch { groups } else { 1 })
        .map(|g| median(of_group(g).map(|i| estimates[i].value).filter(|v| v.is_finite())).unwrap_or(0.0))
        .collect();
    let place = |g: usize| if is_by_batch { g } else { 0 };
    let distance: Vec<f64> = estimates.iter().zip(group).map(|(e, g)| e.value - middle[place(*g)]).collect();
    let finite = || estimates.iter().zip(&distance).filter(|(e, d)| d.is_finite() && e.standard_error.is_finite());
    let freedom = (finite().count() as f64 - middle.len() as f64).max(0.0);
    let scale = NORMAL_MAD * (finite().count() as f64 / freedom).sqrt();
    let spread = scale * median(finite().map(|(_, d)| d.abs())).unwrap_or(0.0);
    let error = median(finite().map(|(e, _)| e.standard_error.powi(2))).unwrap_or(0.0);
    let between = (spread.powi(2) - error).max(0.0);
    let deviation = |(e, d): (&Estimate, &f64)| {
        let score = d / (between + e.standard_error.powi(2)).sqrt();
        Deviation { score, p_value: student_p_value(EFFICIENCY * freedom, score) }
    };
    estimates.iter().zip(&distance).map(deviation).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_far_unit_is_an_outlier_and_an_uncertain_or_a_shifted_one_is_not() {
        let spread = |i: usize| ((i * 37 % 101) as f64 / 101.0 - 0.5) * 2.0;
        let mut estimates: Vec<Estimate> =
            (0..200).map(|i| Estimate { value: 10.0 + spread(i), standard_error: 0.1 }).collect();
        let group: Vec<usize> = (0..200).map(|i| usize::from(i >= 150)).collect();
        estimates[150..].iter_mut().for_each(|e| e.value += 40.0);
        estimates[7].value = 25.0;
        estimates[9] = Estimate { value: 25.0, standard_error: 20.0 };
        let found = deviations(&estimates, &group);
        let far: Vec<usize> = (0..200).filter(|i| found[*i].p_value < 1e-6).collect();
        assert_eq!(far, [7]);
        assert!(found[9].p_value > 0.1 && found[160].p_value > 0.1, "{:?} {:?}", found[9], found[160]);
    }

    #[test]
    fn few_units_have_few_degrees_of_freedom() {
        let estimates: Vec<Estimate> =
            [0.0, 1.0, -1.0, 0.5, 4.0].map(|value| Estimate { value, standard_error: 0.01 }).into();
        let found = deviations(&estimates, &[0, 0, 1, 1, 1]);
        assert!(found[4].score > 3.0 && found[4].p_value > 0.05, "{found:?}");
        assert_eq!(deviations(&estimates[..1], &[0])[0].p_value, 1.0);
    }
}
