//! The task of one queue: it starts waiting runs, and decides after each run whether its plan and the queue proceed.

use super::computation::with_retries;
use super::{Answer, Lab, LabError};
use crate::bench::BenchHandle;
use crate::view::{LimitOutcome, NewRun, ProceedIf, QueueState, reread, word};
use jointbench_procedure::RunState;
use std::time::Duration;

/// Waiting time after a fault of the store.
const AGAIN: Duration = Duration::from_secs(1);

impl Lab {
    /// The task of one queue. Observes every run of the bench, also those that did not wait.
    pub(super) async fn serve_queue(self, bench: BenchHandle) {
        let Some(changed) = self.inner.queues.changed.get(bench.name()).cloned() else { return };
        let mut last = None;
        loop {
            last = bench.status().runs.last_key_value().map(|(run, _)| *run).or(last);
            bench.until_free().await;
            let done = match last {
                Some(run) => self.after_run(&bench, run).await,
                None => Ok(()),
            };
            let next = match done {
                Ok(()) => {
                    last = None;
                    self.start_next(&bench).await
                }
                Err(fault) => Err(fault),
            };
            match next {
                Ok(Some(run)) => last = Some(run),
                Ok(None) => tokio::select! {
                    () = changed.notified() => {}
                    () = bench.until_busy() => {}
                },
                Err(fault) => {
                    tracing::error!(bench = bench.name(), %fault, "the queue waits");
                    tokio::time::sleep(AGAIN).await;
                }
            }
        }
    }

    /// Decides after a run whether its plan and the queue proceed.
    async fn after_run(&self, bench: &BenchHandle, run: i64) -> Answer<()> {
        let record = self.inner.store.run(run).await?;
        if let Some(entry) = self.inner.store.queue_entry_of_run(run).await?
            && let Some(plan) = entry.plan
            && let Some(reason) = self.ends_plan(run, record.state, entry.new.proceed_if).await?
        {
            self.inner.store.remove_rest_of_plan(plan, &reason).await?;
            self.queue_changed(bench.name());
        }
        let proceeds = self.inner.leases.remove_expired(run) || record.state == RunState::Completed;
        let Some(next) = self.inner.store.waiting(bench.name()).await?.into_iter().next() else { return Ok(()) };
        let next: NewRun = reread(&next.new.request)?;
        let (mounted, needed) = (record.unit.map(|unit| unit.serial), next.unit.map(|unit| unit.serial));
        if !proceeds {
            self.hold_queue(bench.name(), &format!("run {run} is {}: inspect the bench", record.state)).await?;
        } else if let (Some(mounted), Some(needed)) = (mounted, needed)
            && mounted != needed
        {
            self.hold_queue(bench.name(), &format!("the next run is of unit {needed}: mount it in place of {mounted}"))
                .await?;
        }
        Ok(())
    }

    /// Why a plan does not proceed after this run.
    async fn ends_plan(&self, run: i64, state: RunState, proceed_if: ProceedIf) -> Answer<Option<String>> {
        if state != RunState::Completed {
            return Ok(Some(format!("run {run} of the test plan is {state}")));
        }
        if proceed_if == ProceedIf::Completed {
            return Ok(None);
        }
        let found = match with_retries(|| self.identification(run)).await {
            Ok(found) => found,
            Err(fault) => return Ok(Some(format!("run {run} of the test plan has no result: {fault}"))),
        };
        let verdict = found.result.verdict;
        if !verdict.is_identified() {
            return Ok(Some(format!("run {run} of the test plan is {}", word(verdict))));
        }
        let worst = found.limits.map(|check| check.outcome).filter(|worst| *worst != LimitOutcome::Pass);
        Ok(worst
            .filter(|_| proceed_if == ProceedIf::Pass)
            .map(|worst| format!("the limits of run {run} of the test plan are not met: {}", word(worst))))
    }

    /// Starts the first waiting entry, if the queue is not paused and no autopilot uses the bench.
    async fn start_next(&self, bench: &BenchHandle) -> Answer<Option<i64>> {
        let name = bench.name();
        if self.inner.store.queue_pause(name).await?.is_some() || self.active_autopilot(name).is_some() {
            return Ok(None);
        }
        let Some(entry) = self.inner.store.waiting(name).await?.into_iter().next() else { return Ok(None) };
        let (id, plan) = (entry.id, entry.plan);
        let (waiting, started) = (QueueState::Waiting, QueueState::Started);
        // A daemon that ends between here and the start of the run does not start it again.
        if !self.inner.store.set_queue_state(id, waiting, started, None).await? {
            return Ok(None);
        }
        let request: NewRun = reread(&entry.new.request)?;
        let run = match self.start_run(&request, &entry.new.who).await {
            Ok(run) => run.summary.id,
            Err(fault @ (LabError::Conflict(_) | LabError::Busy(_) | LabError::Bench(_))) => {
                self.inner.store.set_queue_state(id, started, waiting, None).await?;
                // Another run has started in the meantime: the queue waits for its end.
                if !bench.is_busy() {
                    self.hold_queue(name, &fault.to_string()).await?;
                }
                return Ok(None);
            }
            Err(fault) => {
                let reason = fault.to_string();
                self.inner.store.set_queue_state(id, started, QueueState::Failed, Some(&reason)).await?;
                if let Some(plan) = plan {
                    let reason = format!("queue entry {id} of the test plan could not start");
                    self.inner.store.remove_rest_of_plan(plan, &reason).await?;
                }
                self.queue_changed(name);
                return Ok(None);
            }
        };
        self.inner.store.set_queue_run(id, run).await?;
        self.queue_changed(name);
        Ok(Some(run))
    }
}
