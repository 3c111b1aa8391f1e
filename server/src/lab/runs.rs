//! Runs: start, control, read.

use super::leases::checked_lease;
use super::names::{LONGEST_NOTE, checked_text};
use super::units::TestedUnit;
use super::{Answer, Lab, LabError};
use crate::bench::{BenchHandle, Status, show_unstored_end};
use crate::limits::ACCEPTANCE_LIMITS;
use crate::store::{NewRun, RunFilter, RunRecord, Search};
use crate::view::{self, Run, RunEvent, RunList, Samples, reread, run_event, run_summary, run_view, word};
use jointbench_instrument::{Meta, RunTable};
use jointbench_procedure::{Control, Demand, Plan};
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use std::time::Duration;
use tokio::time::timeout;

/// Time limit to store the end of a run; exceeded if the disk accepts no data.
const STORES: Duration = Duration::from_secs(2);

impl Lab {
    /// Plans, checks the limits, and passes the plan to the thread of the bench.
    pub async fn start_run(&self, new: &view::NewRun, by: &str) -> Answer<Run> {
        let tested = TestedUnit::of(new)?;
        let lease = checked_lease(new.lease_s)?;
        let note = new.note.as_deref().map(|note| checked_text("note", note, LONGEST_NOTE)).transpose()?;
        let (bench, plan) = self.plan(&new.bench, &new.procedure, &new.parameters).await?;
        let run = self.launch(bench, plan, tested, by).await?;
        let id = run.summary.id;
        if let Some(lease) = lease {
            self.watch_lease(bench, id, lease);
        }
        // The run has started: a note that cannot be stored does not make it an error.
        if let Some(note) = note
            && let Err(fault) = self.inner.store.save_note(id, None, note).await
        {
            tracing::error!(run.id = id, note, %fault, "the note cannot be stored");
        }
        Ok(run)
    }

    pub(super) async fn launch(&self, bench: &BenchHandle, plan: Plan, tested: TestedUnit, by: &str) -> Answer<Run> {
        check_plan(bench, &plan)?;
        bench.check_not_blocked()?;
        self.wait_for_stored_ends(bench).await;
        let claim = bench.claim()?;
        if bench.status().faults().is_some() {
            bench.reopen().await?;
        }
        if let Some(faults) = bench.status().faults() {
            return Err(LabError::Bench(format!("bench {} is not ready: {faults}", bench.name())));
        }
        let run = self.inner.store.create_run(&new_run(bench, &plan, tested, by)?).await?;
        let procedure = plan.procedure.clone();
        tracing::info!(run.id = run, bench = bench.name(), procedure, by, planned_s = plan.duration_s(), "run queued");
        claim.start(run, plan).await?;
        self.judge_when_ended(bench, run);
        self.run(run).await
    }

    /// Waits until every ended run of this bench is stored and has released the bench.
    pub(super) async fn wait_for_stored_ends(&self, bench: &BenchHandle) {
        let over: Vec<i64> =
            bench.status().runs.iter().filter(|(_, run)| run.state.is_final()).map(|(id, _)| *id).collect();
        let gone = |status: &Status| over.iter().all(|run| !status.runs.contains_key(run));
        // A run that cannot be stored keeps the bench; the next claim reports this.
        drop(timeout(STORES, bench.watch().wait_for(gone)).await);
    }

    pub async fn run(&self, id: i64) -> Answer<Run> {
        let record = self.inner.store.run(id).await?;
        let status = self.inner.benches.iter().map(BenchHandle::status).find(|status| status.runs.contains_key(&id));
        let progress =
            status.as_ref().filter(|status| status.run == Some(id)).and_then(|status| status.progress.clone());
        let mut run = run_view(record, progress);
        status.inspect(|status| show_unstored_end(&mut run.summary, status));
        run.archive = self.archive_of(id).await?;
        Ok(run)
    }

    pub async fn runs(&self, filter: &RunFilter) -> Answer<RunList> {
        let (total, records) = self.inner.store.runs(filter).await?;
        let mut runs: Vec<view::RunSummary> = records.iter().map(run_summary).collect();
        for bench in &self.inner.benches {
            let status = bench.status();
            runs.iter_mut().for_each(|run| show_unstored_end(run, &status));
        }
        Ok(RunList { total, runs, unclear: None })
    }

    /// Runs that match the valid part of a search. An incomplete key does not filter.
    pub async fn runs_while_typing(&self, filter: &RunFilter) -> Answer<RunList> {
        let (understood, mut refused) = Search::understood(filter.search.as_deref().unwrap_or_default());
        let before = Search::before_key(&understood);
        let mut found = self.runs(&RunFilter { search: Some(understood), ..filter.clone() }).await?;
        if let (0, None, Some((before, begun))) = (found.total, &refused, before) {
            (found, refused) = (self.runs(&RunFilter { search: Some(before), ..filter.clone() }).await?, Some(begun));
        }
        Ok(RunList { unclear: refused.map(|fault| fault.to_string()), ..found })
    }

    pub async fn control(&self, id: i64, control: Control, by: &str) -> Answer<Run> {
        let demand = Demand { control, by: Some(by.to_owned()) };
        if !self.inner.benches.iter().any(|bench| bench.control(id, demand.clone())) {
            let state = self.run(id).await?.summary.state;
            return Err(LabError::Over(format!("run {id} has already ended ({})", word(state))));
        }
        self.run(id).await
    }

    pub async fn events(&self, id: i64, after: Option<u64>) -> Answer<Vec<RunEvent>> {
        let events = self.inner.store.events(id, after.unwrap_or(0)).await?;
        Ok(events.into_iter().map(run_event).collect())
    }

    /// A window of samples, at most `px` points.
    pub async fn samples(
        &self,
        id: i64,
        channels: Option<&[String]>,
        from_s: Option<f64>,
        to_s: Option<f64>,
        px: u32,
    ) -> Answer<Samples> {
        if px == 0 || px > 20_000 {
            return Err(LabError::Invalid(format!("px = {px}: choose 1 to 20000")));
        }
        let window = self.inner.store.window(id, channels, from_s, to_s, px as usize).await?;
        let column = |values: Vec<f64>| values.into_iter().map(view::finite).collect();
        let channels = window.columns.into_iter().map(|found| view::SampleColumn {
            unit: found.channel.unit().map(str::to_owned),
            name: found.channel.name,
            min: column(found.min),
            max: column(found.max),
        });
        Ok(Samples { time_s: window.time_s, channels: channels.collect(), exact: window.exact, rows: window.rows })
    }

    /// The whole run with its metadata, as input of a model.
    pub async fn table(&self, id: i64) -> Answer<RunTable> {
        let (meta, record) = self.facts(id).await?;
        if record.rows == 0 {
            return Err(LabError::Invalid(format!("run {id} has no samples: choose a run with samples")));
        }
        let trace = self.inner.store.trace(id, None, 0..record.rows).await?;
        Ok(RunTable::new(meta, trace)?)
    }

    /// Several runs of one joint, as input of a model.
    pub(super) async fn tables(&self, runs: &[i64]) -> Answer<RunTable> {
        let mut tables = Vec::new();
        for (i, run) in runs.iter().enumerate() {
            if runs[..i].contains(run) {
                return Err(LabError::Invalid(format!("run {run} is named twice: name each run once")));
            }
            tables.push(self.measurement(*run).await?);
        }
        if tables.is_empty() {
            return Err(LabError::Invalid("give at least one run".into()));
        }
        let first = tables.remove(0);
        first.join(tables).map_err(|fault| LabError::Invalid(fault.to_string()))
    }

    pub(super) async fn facts(&self, id: i64) -> Answer<(Meta, RunRecord)> {
        let record = self.inner.store.run(id).await?;
        let meta = serde_json::from_value(Value::Object(record.meta.clone()))
            .map_err(|fault| LabError::Internal(format!("the metadata of run {id} cannot be read: {fault}")))?;
        Ok((meta, record))
    }
}

/// [`LabError::Invalid`] with all failed checks of a plan.
pub(super) fn check_plan(bench: &BenchHandle, plan: &Plan) -> Answer<()> {
    let failed: Vec<String> = plan
        .preview(&bench.facts())
        .checks
        .iter()
        .filter(|check| !check.ok)
        .map(|check| format!("{}: {}", check.name, check.refusal()))
        .collect();
    match failed.is_empty() {
        true => Ok(()),
        false => Err(LabError::Invalid(format!("the plan was rejected: {}", failed.join("; ")))),
    }
}

fn new_run(bench: &BenchHandle, plan: &Plan, tested: TestedUnit, by: &str) -> Answer<NewRun> {
    let description = bench.description();
    let status = bench.status();
    let calibrated: BTreeMap<&str, String> =
        description.calibrated.iter().map(|(role, day)| (role.as_str(), day.to_string())).collect();
    let provenance = json!({
        "software": format!("jointbench {}", crate::VERSION),
        "by": by,
        "bench_description": description.text,
        "limits": description.limits,
        "constants": description.constants,
        "instruments": status.instruments,
        "calibrated": calibrated,
        "simulated": description.is_simulated(),
        "seed": description.seed(),
    });
    let mut provenance: Map<String, Value> = reread(&provenance)?;
    if let Some(limits) = &tested.limits {
        provenance.insert(ACCEPTANCE_LIMITS.to_owned(), reread(limits)?);
    }
    Ok(NewRun {
        bench: description.name.clone(),
        procedure: plan.procedure.clone(),
        kind: plan.kind.to_string(),
        simulated: description.is_simulated(),
        parameters: plan.parameters.clone(),
        provenance,
        meta: reread(&plan.meta)?,
        unit: tested.unit,
        operator: tested.operator,
    })
}
