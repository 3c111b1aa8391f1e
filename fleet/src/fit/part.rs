//! The population of each parameter over the units of a part: mean, variance between units, outliers and batches.

use super::{UnitFit, UnitParameter};
use crate::statistics::false_discovery::{RATE, discoveries, limit};
use crate::statistics::outliers::{Deviation, deviations};
use crate::statistics::random_effects::{Estimate, Population, population};
use crate::statistics::shift::{BatchMean, batch_means};
use crate::statistics::student_95;
use serde::Serialize;
use std::collections::BTreeMap;

/// The units of one part number.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PartFit {
    /// Part number; empty for runs without one.
    pub part: String,
    /// Number of fitted units.
    pub units: usize,
    /// Parameters, in the order of the model.
    pub parameters: Vec<PartParameter>,
}

/// One parameter over the units of a part.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PartParameter {
    /// Id of the effect.
    pub effect: String,
    /// Name within the effect.
    pub name: String,
    /// Unit of all figures.
    pub unit: String,
    /// Mean and standard deviation between units. `None` with fewer than two units.
    pub population: Option<Population>,
    /// Each batch with at least five units, if there are two of them.
    pub batches: Vec<BatchFit>,
    /// Units that differ from the other units, at a false discovery rate of 5 % over all parts, parameters and units.
    pub outliers: Vec<Outlier>,
}

/// The mean of a batch.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BatchFit {
    /// Batch.
    pub batch: String,
    /// Its units.
    pub population: Population,
    /// Mean of the batch minus the median of the means of all batches.
    pub difference: f64,
    /// 95 % interval of the difference.
    pub difference_ci95: [f64; 2],
    /// Two-sided p-value of the difference.
    pub p_value: f64,
    /// Whether the batch differs, at a false discovery rate of 5 % over all parts, parameters and batches.
    pub is_shifted: bool,
}

/// A unit that differs from the other units.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Outlier {
    /// Batch of the unit.
    pub batch: String,
    /// Its serial number.
    pub serial: String,
    /// Its estimate.
    pub value: f64,
    /// Deviation from the median of its batch, or of all units if batches are small, in standard deviations of a unit.
    pub deviation: f64,
    /// Two-sided p-value of the deviation.
    pub p_value: f64,
}

/// The parts of fitted units, which are sorted by part.
pub fn parts(units: &[UnitFit]) -> Vec<PartFit> {
    let mut parts: Vec<PartFit> = units.chunk_by(|a, b| a.unit.part == b.unit.part).map(part).collect();
    let batches = parts.iter().flat_map(|part| &part.parameters).flat_map(|parameter| &parameter.batches);
    let p_values: Vec<f64> = batches.map(|batch| batch.p_value).collect();
    let shifted = discoveries(&p_values, RATE);
    let batches = parts.iter_mut().flat_map(|part| &mut part.parameters).flat_map(|parameter| &mut parameter.batches);
    batches.zip(shifted).for_each(|(batch, is_shifted)| batch.is_shifted = is_shifted);
    let units = parts.iter().flat_map(|part| &part.parameters).flat_map(|parameter| &parameter.outliers);
    let limit = limit(&units.map(|unit| unit.p_value).collect::<Vec<f64>>(), RATE);
    for parameter in parts.iter_mut().flat_map(|part| &mut part.parameters) {
        parameter.outliers.retain(|unit| unit.p_value <= limit);
    }
    parts
}

fn part(units: &[UnitFit]) -> PartFit {
    let mut keys: Vec<(&str, &str, &str)> = Vec::new();
    for p in units.iter().flat_map(|unit| &unit.parameters) {
        let key = (p.effect.as_str(), p.name.as_str(), p.unit.as_str());
        if !keys.contains(&key) {
            keys.push(key);
        }
    }
    let parameters = keys.into_iter().map(|key| parameter(units, key)).collect();
    PartFit { part: units[0].unit.part.clone(), units: units.len(), parameters }
}

fn parameter<'u>(units: &'u [UnitFit], (effect, name, unit): (&str, &str, &str)) -> PartParameter {
    let is_meant = |p: &&UnitParameter| p.effect == effect && p.name == name && p.unit == unit;
    let with = |fit: &'u UnitFit| Some((fit, fit.parameters.iter().find(is_meant)?.estimate()));
    let known: Vec<(&UnitFit, Estimate)> = units.iter().filter_map(with).collect();
    let mut by_batch: BTreeMap<&str, Vec<Estimate>> = BTreeMap::new();
    known.iter().for_each(|(fit, estimate)| by_batch.entry(&fit.unit.batch).or_default().push(*estimate));
    let names: Vec<&str> = by_batch.keys().copied().collect();
    let estimates: Vec<Estimate> = known.iter().map(|(_, estimate)| *estimate).collect();
    let group: Vec<usize> =
        known.iter().map(|(fit, _)| names.binary_search(&fit.unit.batch.as_str()).unwrap_or(0)).collect();
    // All units: those that are no outliers are removed when the parameters of all parts are known.
    let outlier = |((fit, estimate), found): (&(&UnitFit, Estimate), Deviation)| Outlier {
        batch: fit.unit.batch.clone(),
        serial: fit.unit.serial.clone(),
        value: estimate.value,
        deviation: found.score,
        p_value: found.p_value,
    };
    let found = known.iter().zip(deviations(&estimates, &group));
    let values: Vec<Vec<Estimate>> = by_batch.into_values().collect();
    let means = names.iter().zip(batch_means(&values));
    PartParameter {
        effect: effect.to_owned(),
        name: name.to_owned(),
        unit: unit.to_owned(),
        population: population(&estimates),
        batches: means.filter_map(|(name, mean)| Some(batch(name, mean?))).collect(),
        outliers: found.map(outlier).collect(),
    }
}

fn batch(name: &str, mean: BatchMean) -> BatchFit {
    let half = student_95(mean.population.units as f64 - 1.0) * mean.standard_error;
    BatchFit {
        batch: name.to_owned(),
        population: mean.population,
        difference: mean.difference,
        difference_ci95: [mean.difference - half, mean.difference + half],
        p_value: mean.p_value,
        is_shifted: false,
    }
}
