//! Autopilots: create, list, stop. [`autopilot_task`](super::autopilot_task) contains their steps.

use super::autopilot_task::{AutopilotTask, Goal};
use super::{Answer, Lab, LabError};
use crate::store::AutopilotRecord;
use crate::view::{Autopilot, AutopilotState, AutopilotStep, NewAutopilot, NewExperiment, reread, word};
use jointbench_instrument::Kind;
use serde_json::{Map, Value};
use std::collections::HashMap;
use std::sync::{Mutex, MutexGuard, PoisonError};
use tokio::sync::watch;
use tokio::task::JoinHandle;

/// An active autopilot.
pub(super) struct ActiveAutopilot {
    bench: String,
    /// Sends the name of the person who requested the end.
    stop: watch::Sender<Option<String>>,
    task: JoinHandle<()>,
}

/// The active autopilots by id.
#[derive(Default)]
pub(super) struct ActiveAutopilots(Mutex<HashMap<i64, ActiveAutopilot>>);

impl ActiveAutopilots {
    fn lock(&self) -> MutexGuard<'_, HashMap<i64, ActiveAutopilot>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Aborts all autopilots immediately.
    pub fn abort(&self) {
        self.lock().drain().for_each(|(_, active)| active.task.abort());
    }
}

pub(super) const INTERRUPTED: &str = "the daemon terminated during the autopilot; its runs and models were kept";

impl Lab {
    pub async fn start_autopilot(&self, new: &NewAutopilot, by: &str) -> Answer<Autopilot> {
        self.handle(&new.bench)?;
        if new.runs == 0 {
            return Err(LabError::Invalid("runs = 0: give 1 or more".into()));
        }
        if new.bench_time_s.is_some_and(|s| !(s.is_finite() && s > 0.0)) {
            return Err(LabError::Invalid("bench_time_s: expected a time above 0 s".into()));
        }
        let kind = match new.from_run {
            Some(run) => self.measurement(run).await?.kind(),
            None => self.first_run(new).await?,
        };
        if let Some(effects) = &new.effects {
            self.spec(kind, effects, None).await?;
        }
        self.start_task(&new.bench, reread(new)?, Goal::Explain(new.clone()), by).await
    }

    /// Refuses an invalid first run now, not after the start.
    async fn first_run(&self, new: &NewAutopilot) -> Answer<Kind> {
        let handle = self.handle(&new.bench)?;
        let (_, plan) = self.plan(&new.bench, &new.procedure, &new.parameters).await?;
        let planned_s = plan.duration_s();
        if let Some(failed) = plan.preview(&handle.facts()).checks.into_iter().find(|check| !check.ok) {
            return Err(LabError::Invalid(format!("the first run was rejected: {}", failed.refusal())));
        }
        if new.bench_time_s.is_some_and(|budget_s| planned_s > budget_s) {
            return Err(LabError::Invalid(format!(
                "the first run alone takes up to {planned_s:.0} s: increase bench_time_s, or choose a shorter run"
            )));
        }
        Ok(plan.kind)
    }

    /// Executes the run that a diagnosis recommends and diagnoses the same model again with its data.
    pub async fn start_experiment(&self, diagnosis: i64, new: &NewExperiment, by: &str) -> Answer<Autopilot> {
        let (model, experiment) = self.recommended_run(diagnosis, &new.bench).await?;
        let experiment = experiment.ok_or_else(|| {
            LabError::Invalid(format!("diagnosis {diagnosis} recommends no further run on {}", new.bench))
        })?;
        let mut request: Map<String, Value> = reread(new)?;
        request.insert("diagnosis".into(), diagnosis.into());
        let goal = Goal::Decide { runs: model.runs(), model: model.id, effects: model.effects, experiment };
        self.start_task(&new.bench, request, goal, by).await
    }

    async fn start_task(&self, bench: &str, request: Map<String, Value>, goal: Goal, by: &str) -> Answer<Autopilot> {
        self.check_is_free(bench)?;
        if let Some(block) = self.inner.store.bench_block(bench).await? {
            return Err(LabError::Conflict(format!("bench {bench} is blocked: {}", block.reason)));
        }
        let state = word(AutopilotState::Running);
        let id = self.inner.store.create_autopilot(bench, &request, &state).await?;
        tracing::info!(autopilot.id = id, bench, by, "autopilot started");
        self.spawn_task(id, bench, goal, format!("{by}, autopilot {id}"));
        self.autopilot(id).await
    }

    fn spawn_task(&self, id: i64, bench: &str, goal: Goal, by: String) {
        let (stop, stopped) = watch::channel(None);
        let (lab, bench, used) = (self.clone(), bench.to_owned(), bench.to_owned());
        let task = AutopilotTask::new(lab.clone(), id, bench.clone(), stopped, by);
        // The lock is held until the autopilot is inserted: the task must not remove it earlier.
        let mut active_autopilots = self.inner.active_autopilots.lock();
        let task = tokio::spawn(async move {
            task.run(goal).await;
            lab.inner.active_autopilots.lock().remove(&id);
            lab.inner.queues.notify(&used);
        });
        active_autopilots.insert(id, ActiveAutopilot { bench, stop, task });
    }

    /// The autopilot that uses a bench.
    pub(super) fn active_autopilot(&self, bench: &str) -> Option<i64> {
        self.inner.active_autopilots.lock().iter().find(|(_, active)| active.bench == bench).map(|(id, _)| *id)
    }

    fn check_is_free(&self, bench: &str) -> Answer<()> {
        match self.active_autopilot(bench) {
            Some(id) => Err(LabError::Conflict(format!(
                "autopilot {id} uses bench {bench}: stop it, or wait until it finishes"
            ))),
            None if self.handle(bench)?.is_busy() => Err(LabError::Conflict(format!(
                "a run is in progress on bench {bench}: stop it, or wait until it \
                                                finishes"
            ))),
            None => Ok(()),
        }
    }

    pub async fn autopilots(&self) -> Answer<Vec<Autopilot>> {
        self.inner.store.autopilots().await?.into_iter().map(autopilot).collect()
    }

    pub async fn autopilot(&self, id: i64) -> Answer<Autopilot> {
        autopilot(self.inner.store.autopilot(id).await?)
    }

    /// Ends the autopilot after its current step. An active run ends as with `POST /runs/{id}/stop`.
    pub async fn stop_autopilot(&self, id: i64, by: &str) -> Answer<Autopilot> {
        let by = Some(by.to_owned());
        let is_signalled =
            self.inner.active_autopilots.lock().get(&id).is_some_and(|active| active.stop.send(by).is_ok());
        let now = self.autopilot(id).await?;
        if !is_signalled {
            return Err(LabError::Over(format!("autopilot {id} has already ended")));
        }
        Ok(now)
    }
}

fn autopilot(record: AutopilotRecord) -> Answer<Autopilot> {
    let steps: Vec<AutopilotStep> = reread(&record.steps)?;
    let newest = |of: fn(&AutopilotStep) -> Option<i64>| steps.iter().rev().find_map(of);
    let mut runs: Vec<i64> = steps.iter().filter_map(|step| step.run).collect();
    runs.dedup();
    Ok(Autopilot {
        id: record.id,
        bench: record.bench,
        state: reread(&record.state)?,
        reason: record.reason,
        request: record.request,
        runs,
        bench_time_s: steps.iter().filter_map(|step| step.bench_time_s).fold(0.0, |sum, time_s| sum + time_s),
        model: newest(|step| step.model),
        verdict: steps.iter().rev().find_map(|step| step.verdict),
        steps,
        created_at: record.created_at,
        finished_at: record.finished_at,
    })
}
