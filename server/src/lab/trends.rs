//! Results of complete runs over time.

use super::{Answer, Lab};
use crate::store::{RunFilter, RunRecord, Search};
use crate::view::{TrendRun, Trends};
use jointbench_model::stats::summary::mean;
use jointbench_procedure::RunState;

/// Limit of a plot.
const MOST: u32 = 500;
/// Number of sections for the mean temperature of a run.
const STRETCHES: usize = 200;

impl Lab {
    /// Results of the newest complete runs that match a search, the oldest first. Computes some missing results;
    /// `pending` counts those for later requests.
    pub async fn trends(&self, search: &str) -> Answer<Trends> {
        let (understood, _) = Search::understood(search);
        let filter = RunFilter {
            limit: MOST,
            offset: 0,
            search: Some(format!("{understood} state:completed")),
            ..RunFilter::default()
        };
        let (total, records) = self.inner.store.runs(&filter).await?;
        let records: Vec<&RunRecord> =
            records.iter().rev().filter(|record| has_result(record.state, &record.procedure)).collect();
        let (found, pending) = self.quantities_of_runs(records, |record| record.id).await?;
        let mut runs = Vec::new();
        for (record, quantities) in found {
            let temperature_c = self.temperature_of(record.id).await?;
            runs.push(TrendRun {
                run: record.id,
                created_at: record.created_at.clone(),
                bench: record.bench.clone(),
                procedure: record.procedure.clone(),
                unit: record.unit.as_ref().map(|unit| unit.serial.clone()),
                tags: record.tags.clone(),
                temperature_c,
                quantities,
            });
        }
        Ok(Trends { runs, pending, left_out: total.saturating_sub(u64::from(MOST)) })
    }

    /// Mean temperature of the run [°C], from the midpoints of its sections.
    pub(super) async fn temperature_of(&self, run: i64) -> Answer<Option<f64>> {
        // The records of a list have no channels.
        let record = self.inner.store.run(run).await?;
        let Some(channel) = record.channels.iter().find(|channel| channel.unit() == Some("°C")) else {
            return Ok(None);
        };
        let view =
            self.inner.store.window(run, Some(std::slice::from_ref(&channel.name)), None, None, STRETCHES).await?;
        let middles = view.columns.iter().flat_map(|column| column.min.iter().zip(&column.max));
        let middles: Vec<f64> =
            middles.map(|(low, high)| (low + high) / 2.0).filter(|middle| middle.is_finite()).collect();
        Ok((!middles.is_empty()).then(|| mean(&middles)))
    }
}

/// Whether a run is complete and has a verdict. An imported run has none.
pub(super) fn has_result(state: RunState, procedure: &str) -> bool {
    state == RunState::Completed && jointbench_procedure::procedure(procedure).is_some()
}
