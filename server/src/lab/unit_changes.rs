//! What changed since the previous run of a unit, and whether this is beyond the scatter of its earlier runs.
//!
//! The earlier runs with the same settings give the mean, or a line over temperature if they are enough, and the 95 %
//! prediction interval of one further run (Student's t; Draper, Smith 1998, chapter 1).

use super::{Answer, Lab};
use crate::store::{RunRecord, UnitRunRecord};
use crate::view::{Quantity, QuantityChange, SettingChange, UnitChanges};
use jointbench_model::stats::student;
use jointbench_procedure::RunState;
use serde_json::Value;
use std::collections::BTreeSet;

/// Limit of the earlier runs.
const MOST: usize = 50;
/// With fewer degrees of freedom, a prediction interval says nothing.
const LEAST_FREEDOM: usize = 2;

/// An earlier run with the same settings.
struct EarlierRun {
    temperature_c: Option<f64>,
    quantities: Vec<Quantity>,
}

impl Lab {
    /// `None` if the run is not complete or has no unit, or no earlier complete run of its unit and procedure exists.
    pub async fn unit_changes(&self, id: i64) -> Answer<Option<UnitChanges>> {
        let record = self.inner.store.run(id).await?;
        let unit = record.unit.clone().filter(|_| record.state == RunState::Completed);
        let Some(unit) = unit else { return Ok(None) };
        let runs = self.inner.store.runs_of_unit(&unit.serial).await?;
        let is_earlier = |run: &&UnitRunRecord| {
            run.run < id && run.procedure == record.procedure && run.state == RunState::Completed
        };
        let earlier: Vec<i64> = runs.iter().rev().filter(is_earlier).take(MOST).map(|run| run.run).collect();
        let Some(previous) = earlier.first() else { return Ok(None) };
        let previous = self.inner.store.run(*previous).await?;
        let temperature_c = self.temperature_of(id).await?;
        let comparable = self.comparable(&earlier, &record).await?;
        let (before, now) = (self.quantities(previous.id).await?, self.quantities(id).await?);
        let change = |present: Quantity| {
            let previous = before.iter().find(|previous| previous.name == present.name)?;
            Some(quantity_change(previous, present, &comparable, temperature_c))
        };
        Ok(Some(UnitChanges {
            unit: unit.serial,
            previous_run: previous.id,
            comparable_runs: comparable.len(),
            settings: settings(&previous, &record),
            previous_temperature_c: self.temperature_of(previous.id).await?,
            temperature_c,
            quantities: now.into_iter().filter_map(change).collect(),
        }))
    }

    /// The earlier runs with the settings of a run. Those without a result are omitted.
    async fn comparable(&self, earlier: &[i64], record: &RunRecord) -> Answer<Vec<EarlierRun>> {
        let mut same = Vec::new();
        for run in earlier {
            if self.inner.store.run(*run).await?.parameters == record.parameters {
                same.push(*run);
            }
        }
        let (found, _) = self.quantities_of_runs(same, |run| *run).await?;
        let mut comparable = Vec::new();
        for (run, quantities) in found {
            comparable.push(EarlierRun { temperature_c: self.temperature_of(run).await?, quantities });
        }
        Ok(comparable)
    }
}

fn settings(previous: &RunRecord, present: &RunRecord) -> Vec<SettingChange> {
    let names: BTreeSet<&String> = previous.parameters.keys().chain(present.parameters.keys()).collect();
    let of = |record: &RunRecord, name: &String| record.parameters.get(name).cloned().unwrap_or(Value::Null);
    names
        .into_iter()
        .map(|name| SettingChange { parameter: name.clone(), previous: of(previous, name), present: of(present, name) })
        .filter(|change| change.previous != change.present)
        .collect()
}

fn quantity_change(
    previous: &Quantity,
    present: Quantity,
    comparable: &[EarlierRun],
    temperature_c: Option<f64>,
) -> QuantityChange {
    let half = |quantity: &Quantity| quantity.ci95.map(|[low, high]| (high - low) / 2.0);
    let change = present.value - previous.value;
    let reach = half(previous).zip(half(&present)).map(|(previous, present)| previous.hypot(present));
    let value = |run: &EarlierRun| run.quantities.iter().find(|one| one.name == present.name).map(|one| one.value);
    let values: Vec<f64> = comparable.iter().filter_map(value).collect();
    let warm: Option<Vec<(f64, f64)>> =
        comparable.iter().filter(|run| value(run).is_some()).map(|run| run.temperature_c.zip(value(run))).collect();
    let line = warm.zip(temperature_c).and_then(|(warm, at)| line_prediction(&warm, at));
    QuantityChange {
        previous: previous.value,
        present: present.value,
        change_ci95: reach.map(|reach| [change - reach, change + reach]),
        prediction95: line.or_else(|| mean_prediction(&values)),
        follows_temperature: line.is_some(),
        name: present.name,
        symbol: present.symbol,
        title: present.title,
        unit: present.unit,
    }
}

/// Prediction interval of one further value.
fn mean_prediction(values: &[f64]) -> Option<[f64; 2]> {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let squares = values.iter().map(|value| (value - mean).powi(2)).sum();
    prediction(mean, squares, values.len().checked_sub(1)?, 1.0 + 1.0 / n)
}

/// Prediction interval of one further value at `at`, from a line through the points.
fn line_prediction(points: &[(f64, f64)], at: f64) -> Option<[f64; 2]> {
    let n = points.len() as f64;
    let (x0, y0) = (points.iter().map(|p| p.0).sum::<f64>() / n, points.iter().map(|p| p.1).sum::<f64>() / n);
    let sxx: f64 = points.iter().map(|(x, _)| (x - x0).powi(2)).sum();
    let slope = points.iter().map(|(x, y)| (x - x0) * (y - y0)).sum::<f64>() / sxx;
    let squares = points.iter().map(|(x, y)| (y - y0 - slope * (x - x0)).powi(2)).sum();
    prediction(y0 + slope * (at - x0), squares, points.len().checked_sub(2)?, 1.0 + 1.0 / n + (at - x0).powi(2) / sxx)
}

fn prediction(centre: f64, squares: f64, freedom: usize, variance_factor: f64) -> Option<[f64; 2]> {
    if freedom < LEAST_FREEDOM {
        return None;
    }
    let t = student::t95(freedom as f64)?;
    let reach = t * (squares / freedom as f64 * variance_factor).sqrt();
    reach.is_finite().then_some([centre - reach, centre + reach])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_further_value_lies_in_the_prediction_interval_of_the_tables() {
        // n = 4, s = 1.2910, t(3) = 3.1824: 2.5 ± 3.1824 · 1.2910 · √1.25.
        let [low, high] = mean_prediction(&[1.0, 2.0, 3.0, 4.0]).unwrap();
        assert!((low + 2.0934).abs() < 1e-3 && (high - 7.0934).abs() < 1e-3, "{low} {high}");
        assert_eq!(mean_prediction(&[1.0, 2.0]), None);
    }

    #[test]
    fn a_line_over_temperature_predicts_at_the_temperature_of_the_run() {
        let points = [(20.0, 10.0), (25.0, 7.6), (30.0, 4.9), (35.0, 2.5)];
        let [low, high] = line_prediction(&points, 30.0).unwrap();
        assert!(low < 5.0 && high > 5.0 && high - low < 1.0, "{low} {high}");
        assert_eq!(line_prediction(&points.map(|(_, y)| (20.0, y)), 20.0), None, "one temperature gives no line");
        assert_eq!(line_prediction(&points[..3], 30.0), None);
    }
}
