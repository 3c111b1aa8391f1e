//! Individuals chart and capability of a quantity over units.
//!
//! Chart: mean and σ from moving ranges (Shewhart 1931), rules of Western Electric 1956. Capability: the variance between
//! units apart from the uncertainty of each value by the generalised Q statistic (Paule and Mandel 1982), its interval
//! from the quantiles of the same statistic (Viechtbauer 2007).

use super::{Answer, Lab, LabError};
use crate::limits::{self, Requirement};
use crate::store::UnitRunRecord;
use crate::view::{Capability, ControlChart, ControlPoint, ControlRule, EmptyChart, Quantity, QuantityTitle};
use jointbench_model::stats::proportion::Z95;
use jointbench_model::stats::student;
use jointbench_procedure::RunState;
use statrs::distribution::{ChiSquared, ContinuousCDF};
use std::collections::BTreeMap;

/// Limit of the points.
const MOST: usize = 500;
/// Mean moving range of two normal values in standard deviations (d₂).
const D2: f64 = 1.128;
/// Least number of units for a capability.
const LEAST_UNITS: usize = 5;

/// A rule: so many of the last points have to be beyond a multiple of σ on one side.
struct Pattern {
    rule: ControlRule,
    beyond: usize,
    of: usize,
    sigmas: f64,
}

const PATTERNS: [Pattern; 4] = [
    Pattern { rule: ControlRule::BeyondThreeSigma, beyond: 1, of: 1, sigmas: 3.0 },
    Pattern { rule: ControlRule::TwoOfThreeBeyondTwoSigma, beyond: 2, of: 3, sigmas: 2.0 },
    Pattern { rule: ControlRule::FourOfFiveBeyondOneSigma, beyond: 4, of: 5, sigmas: 1.0 },
    Pattern { rule: ControlRule::EightOnOneSide, beyond: 8, of: 8, sigmas: 0.0 },
];

impl Lab {
    /// The chart of a quantity over the units that match a search. Without a name the first quantity with an interval.
    pub async fn control_chart(&self, search: &str, procedure: &str, quantity: Option<&str>) -> Answer<ControlChart> {
        let newest = newest_of_units(self.inner.store.unit_runs(search).await?, procedure);
        let (found, pending) = self.quantities_of_runs(newest, |run| run.run).await?;
        let Some(chosen) = chosen(&found, quantity) else {
            return Ok(ControlChart { pending, ..empty(&found, procedure, quantity) });
        };
        let limit = match found.iter().rev().find(|(run, _)| run.limits.is_some()) {
            Some((run, _)) => limits::of_run(&self.run(run.run).await?)
                .map_err(LabError::Internal)?
                .into_iter()
                .find(|limit| limit.name == chosen.name),
            None => None,
        };
        Ok(ControlChart { pending, ..chart(&found, &chosen, procedure, limit.as_ref()) })
    }
}

type Found = (UnitRunRecord, Vec<Quantity>);

/// The newest complete run of each unit that is no reference, in the order of the runs.
fn newest_of_units(runs: Vec<UnitRunRecord>, procedure: &str) -> Vec<UnitRunRecord> {
    let meant =
        |run: &UnitRunRecord| run.state == RunState::Completed && run.procedure == procedure && !run.is_reference;
    let complete = runs.into_iter().filter(meant);
    let newest: BTreeMap<String, UnitRunRecord> = complete.map(|run| (run.unit.serial.clone(), run)).collect();
    let mut newest: Vec<UnitRunRecord> = newest.into_values().collect();
    newest.sort_by_key(|run| run.run);
    newest.split_off(newest.len().saturating_sub(MOST))
}

/// The named quantity, or the first one with an interval.
fn chosen(found: &[Found], name: Option<&str>) -> Option<Quantity> {
    let mut all = found.iter().rev().flat_map(|(_, quantities)| quantities);
    let chosen = match name {
        Some(name) => all.find(|quantity| quantity.name == name),
        None => all.clone().find(|quantity| quantity.ci95.is_some()).or_else(|| all.next()),
    };
    chosen.cloned()
}

/// All quantities by name, with their titles in the newest run.
fn titles(found: &[Found]) -> Vec<QuantityTitle> {
    let all = found.iter().flat_map(|(_, quantities)| quantities);
    let titles: BTreeMap<&str, &str> = all.map(|one| (one.name.as_str(), one.title.as_str())).collect();
    titles.into_iter().map(|(name, title)| QuantityTitle { name: name.to_owned(), title: title.to_owned() }).collect()
}

/// A chart without points, and why it has none.
fn empty(found: &[Found], procedure: &str, quantity: Option<&str>) -> ControlChart {
    let quantity = quantity.unwrap_or_default().to_owned();
    ControlChart {
        procedure: procedure.to_owned(),
        symbol: quantity.clone(),
        title: quantity.clone(),
        quantity,
        unit: String::new(),
        points: Vec::new(),
        empty: Some(if found.is_empty() { EmptyChart::NoRun } else { EmptyChart::NoQuantity }),
        mean: None,
        sigma: None,
        control_limits: None,
        capability: None,
        quantities: titles(found),
        pending: 0,
    }
}

fn chart(found: &[Found], of: &Quantity, procedure: &str, limit: Option<&Requirement>) -> ControlChart {
    let mut points: Vec<ControlPoint> = found
        .iter()
        .filter_map(|(run, quantities)| {
            let quantity = quantities.iter().find(|quantity| quantity.name == of.name)?;
            Some(ControlPoint {
                unit: run.unit.serial.clone(),
                batch: run.unit.batch.clone(),
                run: run.run,
                created_at: run.created_at.clone(),
                value: quantity.value,
                ci95: quantity.ci95,
                violates: Vec::new(),
            })
        })
        .collect();
    let values: Vec<f64> = points.iter().map(|point| point.value).collect();
    let mean = mean(&values);
    let sigma = sigma(&values);
    if let Some(sigma) = sigma {
        for (point, violates) in points.iter_mut().zip(violations(&values, mean, sigma)) {
            point.violates = violates;
        }
    }
    let bounds = limit.and_then(|limit| limit.bounds_in(&of.unit));
    let measured: Vec<(f64, f64)> = points
        .iter()
        .filter_map(|point| point.ci95.map(|[low, high]| (point.value, (high - low) / (2.0 * Z95))))
        .collect();
    ControlChart {
        procedure: procedure.to_owned(),
        quantity: of.name.clone(),
        symbol: of.symbol.clone(),
        title: of.title.clone(),
        unit: of.unit.clone(),
        points,
        empty: None,
        mean: Some(mean),
        sigma,
        control_limits: sigma.map(|sigma| [mean - 3.0 * sigma, mean + 3.0 * sigma]),
        capability: bounds.and_then(|[lower, upper]| capability(&measured, lower, upper)),
        quantities: titles(found),
        pending: 0,
    }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

/// From the mean moving range. `None` for fewer than two values.
fn sigma(values: &[f64]) -> Option<f64> {
    let ranges: Vec<f64> = values.windows(2).map(|pair| (pair[1] - pair[0]).abs()).collect();
    (!ranges.is_empty()).then(|| mean(&ranges) / D2)
}

/// The rules that each point violates.
fn violations(values: &[f64], mean: f64, sigma: f64) -> Vec<Vec<ControlRule>> {
    let violates = |last: usize, pattern: &Pattern| {
        let Some(first) = (last + 1).checked_sub(pattern.of) else { return false };
        [1.0, -1.0].into_iter().any(|side| {
            let is_beyond = |value: &&f64| side * (**value - mean) > pattern.sigmas * sigma;
            is_beyond(&&values[last]) && values[first..=last].iter().filter(is_beyond).count() >= pattern.beyond
        })
    };
    let rules = |last| PATTERNS.iter().filter(|pattern| violates(last, pattern)).map(|pattern| pattern.rule).collect();
    (0..values.len()).map(rules).collect()
}

/// Mean and scatter between units: values that have their own standard errors.
struct Between {
    mean: f64,
    /// Standard error of the mean.
    error: f64,
    deviation: f64,
    deviation_ci95: [f64; 2],
}

impl Between {
    fn of(measured: &[(f64, f64)]) -> Option<Self> {
        let freedom = measured.len().checked_sub(1).filter(|freedom| *freedom + 1 >= LEAST_UNITS)? as f64;
        let chi = ChiSquared::new(freedom).ok()?;
        let deviation = variance_at(measured, freedom).sqrt();
        let deviation_ci95 = [0.975, 0.025].map(|p| variance_at(measured, chi.inverse_cdf(p)).sqrt());
        let (mean, weight) = weighted_mean(measured, deviation.powi(2));
        Some(Self { mean, error: weight.sqrt().recip(), deviation, deviation_ci95 })
    }
}

/// Weighted mean for a variance between units, and the sum of the weights.
fn weighted_mean(measured: &[(f64, f64)], variance: f64) -> (f64, f64) {
    let weights = || measured.iter().map(|(value, error)| (value, 1.0 / (variance + error * error)));
    let sum: f64 = weights().map(|(_, weight)| weight).sum();
    (weights().map(|(value, weight)| value * weight).sum::<f64>() / sum, sum)
}

/// Weighted sum of squares about the mean; it falls with the variance between units.
fn q_statistic(measured: &[(f64, f64)], variance: f64) -> f64 {
    let (mean, _) = weighted_mean(measured, variance);
    measured.iter().map(|(value, error)| (value - mean).powi(2) / (variance + error * error)).sum()
}

/// The variance between units for which the Q statistic has this value, by bisection; zero if it is smaller everywhere.
fn variance_at(measured: &[(f64, f64)], q: f64) -> f64 {
    let values: Vec<f64> = measured.iter().map(|(value, _)| *value).collect();
    let centre = mean(&values);
    let squares: f64 = values.iter().map(|value| (value - centre).powi(2)).sum();
    // At this variance the statistic is below `q` even without errors of the values.
    let (mut low, mut high) = (f64::MIN_POSITIVE, squares / q);
    if high <= low || q_statistic(measured, low) <= q {
        return 0.0;
    }
    for _ in 0..200 {
        let middle = (low + high) / 2.0;
        if q_statistic(measured, middle) > q { low = middle } else { high = middle }
    }
    high
}

fn capability(measured: &[(f64, f64)], lower: Option<f64>, upper: Option<f64>) -> Option<Capability> {
    let between = Between::of(measured)?;
    let t = student::t95(measured.len() as f64 - 1.0)?;
    let nearest = |mean: f64| {
        let below = lower.map(|lower| mean - lower);
        let above = upper.map(|upper| upper - mean);
        below.into_iter().chain(above).fold(f64::INFINITY, f64::min)
    };
    let [least, most] = between.deviation_ci95;
    let index = |distance: f64, sigmas: f64| (between.deviation > 0.0).then(|| distance / (sigmas * between.deviation));
    let interval = |low: f64, high: f64, sigmas: f64| {
        let end = |distance: f64, deviation: f64| (deviation > 0.0).then(|| distance / (sigmas * deviation));
        // Beyond its limit, a larger deviation makes the index less negative.
        let [of_low, of_high] = [if low > 0.0 { most } else { least }, if high > 0.0 { least } else { most }];
        Some((end(low, of_low)?, end(high, of_high)))
    };
    let width = lower.zip(upper).map(|(lower, upper)| upper - lower);
    let (distance, half) = (nearest(between.mean), t * between.error);
    Some(Capability {
        lower,
        upper,
        deviation: between.deviation,
        deviation_ci95: between.deviation_ci95,
        cp: width.and_then(|width| index(width, 6.0)),
        cp_ci95: width.and_then(|width| interval(width, width, 6.0)),
        cpk: index(distance, 3.0),
        cpk_ci95: interval(distance - half, distance + half, 3.0),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, Normal};

    fn normal(seed: u64, n: usize, mean: f64, deviation: f64) -> Vec<f64> {
        Normal::new(mean, deviation).unwrap().sample_iter(ChaCha8Rng::seed_from_u64(seed)).take(n).collect()
    }

    /// Montgomery 2013, example 6.5: viscosity of fifteen batches, mean 33.52, mean moving range 0.48, upper limit 34.80.
    #[test]
    fn the_control_limits_agree_with_a_published_example() {
        let values =
            [33.75, 33.05, 34.00, 33.81, 33.46, 34.02, 33.68, 33.27, 33.49, 33.20, 33.62, 33.00, 33.54, 33.12, 33.84];
        let (mean, sigma) = (mean(&values), sigma(&values).unwrap());
        assert!((mean - 33.52).abs() < 0.005 && (sigma * D2 - 0.48).abs() < 0.005, "{mean} {sigma}");
        assert!(((mean + 3.0 * sigma) - 34.80).abs() < 0.01, "{}", mean + 3.0 * sigma);
        assert!(violations(&values, mean, sigma).iter().all(Vec::is_empty));
    }

    #[test]
    fn each_rule_names_the_point_that_completes_it() {
        use ControlRule as R;
        let last = |values: &[f64]| violations(values, 0.0, 1.0).pop().unwrap();
        assert_eq!(last(&[0.0, 3.1]), [R::BeyondThreeSigma]);
        assert_eq!(last(&[-2.1, 0.0, -2.2]), [R::TwoOfThreeBeyondTwoSigma]);
        assert_eq!(last(&[2.1, 0.0, -2.2]), [], "on different sides");
        assert_eq!(last(&[1.1, 1.2, -0.5, 1.1, 1.3]), [R::FourOfFiveBeyondOneSigma]);
        assert_eq!(last(&[0.1; 8]), [R::EightOnOneSide]);
        assert_eq!(last(&[0.1; 7]), []);
    }

    /// Forty units with a batch that drifts are named; forty without are named in few points.
    #[test]
    fn a_drifting_batch_is_named_and_a_null_batch_is_not() {
        let drifting: Vec<f64> =
            normal(1, 40, 30.0, 0.5).iter().enumerate().map(|(i, v)| v + 0.1 * (i as f64 - 20.0).max(0.0)).collect();
        let named = |values: &[f64]| {
            let found = violations(values, mean(values), sigma(values).unwrap());
            found.iter().filter(|rules| !rules.is_empty()).count()
        };
        assert!(named(&drifting) >= 5, "{} of 40 points", named(&drifting));
        let null: usize = (0..50).map(|seed| named(&normal(seed, 40, 30.0, 0.5))).sum();
        assert!(null < 50 * 40 / 20, "{null} of 2000 points");
    }

    /// The interval of the deviation between units holds the true one, with measurement errors of the same size.
    #[test]
    fn the_deviation_excludes_the_uncertainty_of_each_value() {
        let mut held = 0;
        for seed in 0..200 {
            let units = normal(2 * seed, 20, 10.0, 1.0);
            let errors = normal(2 * seed + 1, 20, 0.0, 1.0);
            let measured: Vec<(f64, f64)> = units.iter().zip(errors).map(|(unit, error)| (unit + error, 1.0)).collect();
            let [low, high] = Between::of(&measured).unwrap().deviation_ci95;
            held += usize::from(low <= 1.0 && 1.0 <= high);
        }
        assert!((184..=198).contains(&held), "{held} of 200");
    }

    #[test]
    fn indices_follow_from_limits_and_deviation() {
        let measured: Vec<(f64, f64)> = [9.0, 9.5, 10.0, 10.5, 11.0].map(|value| (value, 1e-6)).to_vec();
        let found = capability(&measured, Some(8.0), Some(13.0)).unwrap();
        let deviation = 0.625f64.sqrt();
        assert!((found.deviation - deviation).abs() < 1e-6, "{}", found.deviation);
        let (cp, cpk) = (found.cp.unwrap(), found.cpk.unwrap());
        assert!((cp - 5.0 / 6.0 / deviation).abs() < 1e-5 && (cpk - 2.0 / 3.0 / deviation).abs() < 1e-5, "{cp} {cpk}");
        let (low, high) = found.cpk_ci95.unwrap();
        assert!(low < cpk && cpk < high.unwrap(), "{low} {high:?}");
        let one = capability(&measured, None, Some(9.0)).unwrap();
        assert!(one.cp.is_none() && one.cpk.unwrap() < 0.0, "the mean exceeds the limit: {one:?}");
        assert_eq!(capability(&measured[..4], Some(8.0), None), None);
    }

    #[test]
    fn equal_units_have_no_index_but_a_lower_bound() {
        let measured: Vec<(f64, f64)> = normal(3, 12, 10.0, 0.01).into_iter().map(|value| (value, 1.0)).collect();
        let found = capability(&measured, Some(0.0), Some(20.0)).unwrap();
        assert_eq!((found.deviation, found.cp), (0.0, None));
        assert!(found.cp_ci95.is_none_or(|(low, high)| low > 0.0 && high.is_none()), "{found:?}");
    }
}
