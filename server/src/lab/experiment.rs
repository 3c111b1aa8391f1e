//! Recommended next run: selects from the menu of a bench, or of the conditions that the run itself covers.

use super::{Answer, Lab, LabError};
use crate::job::{Job, Offer};
use crate::store::{DiagnosisRecord, ModelRecord};
use crate::view::{self, reread};
use jointbench_instrument::RunTable;
use jointbench_model::{Next, Open, Options};
use jointbench_procedure::{BenchFacts, menu};
use serde_json::Value;

/// The recommended next run. A diagnosis is valid without one: an error gives an empty recommendation.
pub fn next_run(run: &RunTable, open: &Open, offer: &Offer, options: &Options) -> Next {
    let menu = menu(&offer.bench, run, &offer.parameters);
    jointbench_model::next_run(run, open, &menu, options).unwrap_or_else(|fault| {
        tracing::warn!(%fault, "no recommended run is available");
        Next::default()
    })
}

impl Lab {
    /// The possible next runs on the named bench, or else on the bench of the first run. `None` selects the conditions
    /// that the runs cover.
    pub(super) async fn offer(&self, runs: &[i64], bench: Option<&str>) -> Answer<Option<Offer>> {
        let Some(first) = runs.first() else { return Ok(None) };
        let record = self.inner.store.run(*first).await?;
        let handle = match bench {
            Some(name) => self.handle(name)?,
            None => match self.handle(&record.bench) {
                Ok(handle) => handle,
                Err(_) => return Ok(None),
            },
        };
        let mut parameters = record.parameters;
        // Each further run uses another random order.
        if let Some(seed) = parameters.get("order_seed").and_then(Value::as_f64) {
            parameters.insert("order_seed".into(), (seed + runs.len() as f64 - 1.0).into());
        }
        Ok(Some(Offer { bench: handle.facts(), parameters }))
    }

    /// The run that a stored diagnosis recommends on this bench, and the diagnosed model.
    pub(super) async fn recommended_run(
        &self,
        diagnosis: i64,
        bench: &str,
    ) -> Answer<(ModelRecord, Option<view::Experiment>)> {
        let record: DiagnosisRecord = self.inner.store.diagnosis(diagnosis).await?;
        let model = self.inner.store.model(record.model).await?;
        let next = match self.offer(&model.runs(), Some(bench)).await? {
            Some(offer) => self.compute(Job::NextRun { diagnosis, offer }).await?,
            None => None,
        };
        Ok((model, next))
    }

    pub(super) async fn next_run_here(&self, diagnosis: i64, offer: Offer) -> Answer<Option<view::Experiment>> {
        let record = self.inner.store.diagnosis(diagnosis).await?;
        let model = self.inner.store.model(record.model).await?;
        let table = self.tables(&model.runs()).await?;
        check_same_joint(&table, &offer.bench)?;
        let found: view::Finding = reread(&record.diagnosis)?;
        let open = Open { user_effects: found.user_effects.clone(), ..Open::from(&found) };
        let next = super::blocking::blocking(move || Ok(next_run(&table, &open, &offer, &Options::default()))).await?;
        Ok(next.experiment)
    }
}

/// Refuses a run of another joint: it cannot be combined with a run of this bench.
fn check_same_joint(run: &RunTable, bench: &BenchFacts) -> Answer<()> {
    let (meta, constants) = (run.meta(), &bench.constants);
    let facts = [
        ("gear ratio", meta.gear_ratio, constants.gear_ratio),
        ("torque constant", meta.torque_constant_nm_per_a, constants.torque_constant_nm_per_a),
    ];
    match facts.into_iter().find(|(_, of_run, of_bench)| of_run.is_some_and(|value| value != *of_bench)) {
        Some((fact, Some(of_run), of_bench)) => Err(LabError::Invalid(format!(
            "{} has a different joint than this run: {fact} = {of_bench}, in the run {of_run}",
            bench.name
        ))),
        _ => Ok(()),
    }
}
