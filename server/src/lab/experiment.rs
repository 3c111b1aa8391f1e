//! What to measure next: the menu of a bench, or of what a run itself has shown, put to the model.

use super::{Answer, Lab, LabError, convert};
use crate::store::{DiagnosisRecord, ModelRecord};
use crate::view;
use jointbench_instrument::RunTable;
use jointbench_model::{Next, Open, Options};
use jointbench_procedure::{BenchFacts, menu};
use serde_json::{Map, Value};

/// A bench with the parameters that its runs so far were made with.
#[derive(Debug, Clone)]
pub struct Offer {
    pub bench: BenchFacts,
    pub parameters: Map<String, Value>,
}

impl Offer {
    /// Where there is no bench: what the run has shown to be possible.
    pub fn shown_by(run: &RunTable) -> Self {
        Self { bench: BenchFacts::shown_by(run), parameters: Map::new() }
    }
}

/// The run to make next. A diagnosis stands without it: where it cannot be worked out there is none.
pub fn next_run(run: &RunTable, open: &Open, offer: &Offer, options: &Options) -> Next {
    let menu = menu(&offer.bench, run, &offer.parameters);
    jointbench_model::next_run(run, open, &menu, options).unwrap_or_else(|fault| {
        tracing::warn!(%fault, "no next run was worked out");
        Next::default()
    })
}

impl Lab {
    /// What can be measured next to these runs: on the bench named, else on the one that made the first of them, else what
    /// they have shown.
    pub(super) async fn offer(&self, table: &RunTable, runs: &[i64], bench: Option<&str>) -> Answer<Offer> {
        let Some(first) = runs.first() else { return Ok(Offer::shown_by(table)) };
        let record = self.inner.store.run(*first).await?;
        let handle = match bench {
            Some(name) => self.handle(name)?,
            None => match self.handle(&record.bench) {
                Ok(handle) => handle,
                Err(_) => return Ok(Offer::shown_by(table)),
            },
        };
        let mut parameters = record.parameters;
        // Each further run in another order.
        if let Some(seed) = parameters.get("order_seed").and_then(Value::as_f64) {
            parameters.insert("order_seed".into(), (seed + runs.len() as f64 - 1.0).into());
        }
        Ok(Offer { bench: handle.facts(), parameters })
    }

    /// The run that a kept diagnosis asks for on this bench, with the model that was diagnosed.
    pub(super) async fn asked_for(
        &self,
        diagnosis: i64,
        bench: &str,
    ) -> Answer<(ModelRecord, Option<view::Experiment>)> {
        let record: DiagnosisRecord = self.inner.store.diagnosis(diagnosis).await?;
        let model = self.inner.store.model(record.model).await?;
        let table = self.tables(&model.runs()).await?;
        let offer = self.offer(&table, &model.runs(), Some(bench)).await?;
        check_same_joint(&table, &offer.bench)?;
        let found: jointbench_model::Diagnosis = convert::reread(&record.diagnosis)?;
        let open = Open { own: self.own_effects(table.kind()).await?, ..Open::from(&found) };
        let next = super::models::blocking(move || Ok(next_run(&table, &open, &offer, &Options::default()))).await?;
        Ok((model, next.experiment.map(|next| convert::reread(&next)).transpose()?))
    }
}

/// A run of another joint than the bench carries could not be looked at together with one made there.
fn check_same_joint(run: &RunTable, bench: &BenchFacts) -> Answer<()> {
    let (meta, constants) = (run.meta(), &bench.constants);
    let facts = [
        ("gear ratio", meta.gear_ratio, constants.gear_ratio),
        ("torque constant", meta.torque_constant_nm_per_a, constants.torque_constant_nm_per_a),
    ];
    match facts.into_iter().find(|(_, of_run, of_bench)| of_run.is_some_and(|value| value != *of_bench)) {
        Some((fact, Some(of_run), of_bench)) => Err(LabError::Invalid(format!(
            "{} carries another joint than this run was made with: its {fact} is {of_bench}, that of the run {of_run}",
            bench.name
        ))),
        _ => Ok(()),
    }
}
