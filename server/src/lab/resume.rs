//! Runs that continue an earlier run that ended too soon.

use super::benches::previewed;
use super::units::TestedUnit;
use super::{Answer, Lab, LabError};
use crate::job::Job;
use crate::limits::LimitsFile;
use crate::store::{EventRecord, RunRecord};
use crate::view::{Preview, Run, reread};
use jiff::Timestamp;
use jointbench_instrument::{Meta, RunTable, TableFault};
use jointbench_procedure::resume::{Continuation, FinishedSteps, joined};
use jointbench_procedure::{DeferredPlan, Plan, RunState};

impl Lab {
    /// Starts a run with the remaining steps of another run, after steps that restore their history.
    pub async fn continue_run(&self, id: i64, by: &str) -> Answer<Run> {
        let mut record = self.inner.store.run(id).await?;
        if !record.state.is_final()
            && let Ok(bench) = self.handle(&record.bench)
        {
            // `GET /runs/{id}` already shows an end that is not stored.
            self.wait_for_stored_ends(bench).await;
            record = self.inner.store.run(id).await?;
        }
        let name = &record.procedure;
        match record.state {
            RunState::Completed => {
                return Err(LabError::Over(format!("run {id} is complete: there is nothing to resume")));
            }
            state if !state.is_final() => {
                return Err(LabError::Conflict(format!("run {id} is {state}: resume it, or wait until it finishes")));
            }
            _ => {}
        }
        if let Some(later) = self.inner.store.continued_by(id).await? {
            return Err(LabError::Over(format!(
                "run {id} was already continued by run {later}: continue that run instead"
            )));
        }
        let again = format!("start {name} again instead");
        let procedure = jointbench_procedure::procedure(name).ok_or_else(|| {
            LabError::Invalid(format!("run {id} used procedure {name}, which does not exist in this version"))
        })?;
        procedure
            .can_resume()
            .map_err(|why| LabError::Invalid(format!("run {id} cannot be resumed: {why}; {again}")))?;
        let (bench, plan) = self.plan(&record.bench, name, &record.parameters).await?;
        let done = self.done(&record, Some(&plan)).await?;
        let rest = plan
            .remaining(id, done.steps, done.next_segment, &bench.facts())
            .ok_or_else(|| LabError::Invalid(format!("run {id} has no finished step to resume from: {again}")))?;
        // The earlier data may be long: read it only if the plan needs it.
        let rest = match rest.deferred.clone() {
            Some(deferred) => {
                let recalled = self.recall(id, deferred).await?;
                recalled.into_iter().fold(rest, |rest, (measured, done)| rest.with_earlier_measurement(measured, done))
            }
            None => rest,
        };
        // Another person may continue the run.
        let limits = LimitsFile::kept(&record.provenance).map_err(LabError::Internal)?;
        let tested = TestedUnit { unit: record.unit, operator: None, limits };
        self.launch(bench, rest, tested, by).await
    }

    /// The steps of a run. For a continuing run: the restoring steps and the remaining steps.
    pub async fn plan_of(&self, id: i64) -> Answer<Preview> {
        let record = self.inner.store.run(id).await?;
        let (bench, plan) = self.plan(&record.bench, &record.procedure, &record.parameters).await?;
        let plan = match continues(&record)? {
            Some(before) => plan
                .remaining(before.run, before.from_step, before.restored_from, &bench.facts())
                .ok_or_else(|| LabError::Invalid(format!("run {id} was planned by an incompatible version")))?,
            None => plan,
        };
        Ok(previewed(bench, &plan))
    }

    /// The step in which a run ended: `step 3 of 41`, or `step 3` if the run can no longer be planned.
    pub(super) async fn last_step(&self, id: i64) -> Answer<Option<String>> {
        let events = self.inner.store.events(id, 0).await?;
        let begun = |event: &EventRecord| event.data.get("step").and_then(serde_json::Value::as_u64);
        let Some(step) = events.iter().filter(|event| event.kind == "step_started").filter_map(begun).next_back()
        else {
            return Ok(None);
        };
        // `Box::pin` because of recursion: planning may use the result of an earlier run.
        let steps =
            Box::pin(self.plan_of(id)).await.map(|plan| format!(" of {}", plan.steps.len())).unwrap_or_default();
        Ok(Some(format!("step {}{steps}", step + 1)))
    }

    /// A run and the runs that it continues, in reverse order.
    async fn parts(&self, id: i64) -> Answer<Vec<RunRecord>> {
        let mut parts = vec![self.inner.store.run(id).await?];
        while let Some(before) = continues(&parts[parts.len() - 1])? {
            parts.push(self.inner.store.run(before.run).await?);
        }
        Ok(parts)
    }

    /// The runs of one measurement, in order.
    pub(super) async fn together(&self, id: i64) -> Answer<Vec<i64>> {
        Ok(self.parts(id).await?.iter().rev().map(|part| part.id).collect())
    }

    /// All data of a measurement, including the runs that this run continues.
    pub(super) async fn measurement(&self, id: i64) -> Answer<RunTable> {
        Ok(self.measured(id).await?.0)
    }

    /// The same with its finished steps.
    async fn measured(&self, id: i64) -> Answer<(RunTable, FinishedSteps)> {
        let mut parts = self.parts(id).await?;
        let (Some(first), later) = (parts.pop(), parts.into_iter().rev()) else { unreachable!("at least one part") };
        let mut whole = self.table(first.id).await?;
        let mut done = self.done(&first, None).await?;
        for part in later {
            let table = self.table(part.id).await?;
            let later_s = began(&part)?.duration_since(began(&first)?).as_secs_f64();
            whole = joined(&whole, &done, &table, later_s)?;
            let more = self.done(&part, None).await?;
            done.segments.extend(more.segments);
        }
        Ok((whole, done))
    }

    /// The part of a measurement that a deferred plan needs. `None` if it was not measured.
    async fn recall(&self, run: i64, deferred: DeferredPlan) -> Answer<Option<(RunTable, FinishedSteps)>> {
        let bytes = self.compute_json(Job::Recall { run, lesson: deferred }).await?;
        rmp_serde::from_slice(&bytes)
            .map_err(|fault| LabError::Internal(format!("run {run} cannot be recalled: {fault}")))
    }

    /// The same as bytes, because JSON has no NaN.
    pub(super) async fn recall_here(&self, run: i64, deferred: &DeferredPlan) -> Answer<Vec<u8>> {
        let (whole, done) = self.measured(run).await?;
        let recalled = match deferred.source_rows(&whole) {
            Err(TableFault::Empty) => None,
            part => Some((part?, done)),
        };
        rmp_serde::to_vec_named(&recalled).map_err(|fault| LabError::Internal(fault.to_string()))
    }

    /// The steps of the procedure's plan that a run and its predecessors have finished. With a `plan`, its steps are
    /// compared with the events.
    async fn done(&self, record: &RunRecord, plan: Option<&Plan>) -> Answer<FinishedSteps> {
        let continues = continues(record)?;
        let mut done =
            FinishedSteps { steps: continues.map_or(0, |continues| continues.from_step), ..FinishedSteps::default() };
        for event in self.inner.store.events(record.id, 0).await? {
            let number = |name: &str| event.data.get(name).and_then(serde_json::Value::as_u64);
            let (Some(step), Some(segment)) = (number("step"), number("segment")) else { continue };
            done.add(continues, step as usize, segment as u32, event.kind == "step_finished");
            let (from, restored) = continues.map_or((0, 0), |continues| (continues.from_step, continues.restored));
            let label = event.data.get("label").and_then(serde_json::Value::as_str);
            let planned = (step as usize)
                .checked_sub(restored)
                .zip(plan)
                .map(|(step, plan)| plan.steps.get(from + step).map(|step| step.label.as_str()));
            if let (Some(label), Some(planned)) = (label, planned)
                && planned != Some(label)
            {
                return Err(LabError::Invalid(format!(
                    "run {} was planned by an incompatible version (step {step}, {label}): start {} again instead",
                    record.id, record.procedure
                )));
            }
        }
        Ok(done)
    }
}

fn continues(record: &RunRecord) -> Answer<Option<Continuation>> {
    let meta: Meta = reread(&record.meta)?;
    Ok(Continuation::of(&meta))
}

fn began(record: &RunRecord) -> Answer<Timestamp> {
    let text = record.started_at.as_deref().unwrap_or(&record.created_at);
    text.parse().map_err(|fault| LabError::Internal(format!("run {} began at {text}: {fault}", record.id)))
}
