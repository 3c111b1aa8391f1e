//! Queues: one for each bench. A waiting run starts when the bench is free, with the same checks as any other run.
//!
//! The queue proceeds after a completed run, and after one that its lease ended. It pauses when a run ended in another
//! way, when the next run needs another unit, when the bench is not ready, and at the start of the daemon: nothing moves
//! until a person or a script resumes it.

use super::background::Tasks;
use super::leases::checked_lease;
use super::names::{LONGEST_NAME, LONGEST_NOTE, checked, checked_text};
use super::runs::check_plan;
use super::units::TestedUnit;
use super::{Answer, Lab, LabError};
use crate::bench::BenchHandle;
use crate::store::{NewQueueEntry, QueueRecord};
use crate::view::{
    BenchQueue, LiveMessage, NewRun, NewTestPlan, ProceedIf, QueueEntry, QueuePause, QueueState, reread, word,
};
use std::collections::HashMap;
use std::sync::Arc;
use tokio::sync::Notify;

/// Limit of the waiting entries of a bench.
const MOST_WAITING: usize = 500;
/// Limit of the runs of a plan.
const MOST_RUNS: usize = 100;
/// Number of displayed entries that left a queue.
const MOST_LEFT: u32 = 50;
const RESTARTED: &str = "the daemon was restarted: inspect the bench";
const NOT_STARTED: &str = "the daemon terminated while it started this run: queue it again";

/// Wakes the tasks of the queues.
#[derive(Default)]
pub(super) struct Queues {
    pub(super) changed: HashMap<String, Arc<Notify>>,
    /// One request at a time, so that a repeated one finds its entry.
    adding: tokio::sync::Mutex<()>,
    tasks: Tasks,
}

impl Queues {
    pub fn new<'b>(benches: impl Iterator<Item = &'b BenchHandle>) -> Self {
        Self { changed: benches.map(|bench| (bench.name().to_owned(), Arc::default())).collect(), ..Self::default() }
    }

    /// The queue, its pause or the use of the bench has changed.
    pub fn notify(&self, bench: &str) {
        self.changed.get(bench).inspect(|changed| changed.notify_one());
    }

    /// Ends all queues; the waiting entries are kept.
    pub fn abort(&self) {
        self.tasks.abort();
    }
}

impl Lab {
    /// Starts the task of each queue. Queues with waiting entries are paused.
    pub(super) async fn open_queues(&self) -> Answer<()> {
        self.inner.store.hold_queues(RESTARTED, NOT_STARTED).await?;
        for bench in &self.inner.benches {
            for entry in self.inner.store.waiting(bench.name()).await? {
                let request: NewRun = reread(&entry.new.request)?;
                checked_lease(request.lease_s)?.inspect(|lease| self.watch_entry(entry.id, *lease));
            }
        }
        for bench in &self.inner.benches {
            self.inner.queues.tasks.spawn(self.clone().serve_queue(bench.clone()));
        }
        Ok(())
    }

    /// Appends a run to the queue of its bench. A repeated request with the same key returns its first entry.
    pub async fn enqueue(&self, new: &NewRun, key: Option<&str>, by: &str) -> Answer<QueueEntry> {
        let key = key.map(|key| checked("Idempotency-Key", key, LONGEST_NAME)).transpose()?;
        let mut entry = self.checked_entry(new, ProceedIf::Completed, new.priority, by).await?;
        let _adding = self.inner.queues.adding.lock().await;
        if let Some(key) = key {
            if let Some(known) = self.inner.store.queue_entry_with_key(key).await? {
                return match known.new.request == entry.request {
                    true => queue_entry(known, None),
                    false => Err(LabError::Conflict(format!(
                        "Idempotency-Key {key} belongs to another request (queue entry {}): use a new key",
                        known.id
                    ))),
                };
            }
            entry.key = Some(key.to_owned());
        }
        let ids = self.append(&new.bench, vec![entry]).await?;
        if let Some(lease) = checked_lease(new.lease_s)? {
            self.watch_entry(ids[0], lease);
        }
        queue_entry(self.inner.store.queue_entry(ids[0]).await?, None)
    }

    /// Appends the runs of a plan, all or none.
    pub async fn enqueue_plan(&self, plan: &NewTestPlan, by: &str) -> Answer<Vec<QueueEntry>> {
        let bench = match plan.runs.as_slice() {
            [first, ..] if plan.runs.len() <= MOST_RUNS => first.bench.clone(),
            _ => return Err(LabError::Invalid(format!("a test plan has 1 to {MOST_RUNS} runs"))),
        };
        let mut entries = Vec::new();
        for (i, run) in plan.runs.iter().enumerate() {
            if run.bench != bench || run.unit != plan.runs[0].unit {
                return Err(LabError::Invalid(format!("run {}: a test plan has one bench and one unit", i + 1)));
            }
            if run.queue || run.priority != 0 || run.lease_s.is_some() {
                let why =
                    "queue, priority and lease_s are not for the runs of a test plan; priority belongs to the plan";
                return Err(LabError::Invalid(format!("run {}: {why}", i + 1)));
            }
            let entry = self.checked_entry(run, plan.proceed_if, plan.priority, by).await;
            entries.push(entry.map_err(|fault| in_run(i, fault))?);
        }
        let _adding = self.inner.queues.adding.lock().await;
        let ids = self.append(&bench, entries).await?;
        let mut made = Vec::new();
        for id in ids {
            made.push(queue_entry(self.inner.store.queue_entry(id).await?, None)?);
        }
        Ok(made)
    }

    async fn append(&self, bench: &str, entries: Vec<NewQueueEntry>) -> Answer<Vec<i64>> {
        self.check_room(bench, entries.len()).await?;
        let ids = self.inner.store.enqueue(&entries).await?;
        tracing::info!(bench, entries = ?ids, by = entries[0].who, "runs wait in the queue");
        self.queue_changed(bench);
        Ok(ids)
    }

    async fn check_room(&self, bench: &str, more: usize) -> Answer<()> {
        let waiting = self.inner.store.waiting(bench).await?.len();
        if waiting + more > MOST_WAITING {
            return Err(LabError::Conflict(format!(
                "the queue of bench {bench} holds {waiting} of at most {MOST_WAITING} runs: wait, or remove some"
            )));
        }
        Ok(())
    }

    /// Refuses now what would be refused at the start.
    async fn checked_entry(
        &self,
        new: &NewRun,
        proceed_if: ProceedIf,
        priority: i32,
        by: &str,
    ) -> Answer<NewQueueEntry> {
        TestedUnit::of(new)?;
        new.note.as_deref().map(|note| checked_text("note", note, LONGEST_NOTE)).transpose()?;
        checked_lease(new.lease_s)?;
        let (bench, plan) = self.plan(&new.bench, &new.procedure, &new.parameters).await?;
        check_plan(bench, &plan)?;
        Ok(NewQueueEntry {
            bench: new.bench.clone(),
            proceed_if,
            request: reread(&NewRun { queue: false, priority: 0, ..new.clone() })?,
            who: by.to_owned(),
            priority,
            // A mock bench without a pace takes no time.
            planned_s: bench.description().pace().map_or(0.0, |pace| plan.duration_s() / pace),
            key: None,
        })
    }

    pub async fn queues(&self) -> Answer<Vec<BenchQueue>> {
        let mut queues = Vec::new();
        for bench in &self.inner.benches {
            queues.push(self.queue(bench.name()).await?);
        }
        Ok(queues)
    }

    pub async fn queue(&self, bench: &str) -> Answer<BenchQueue> {
        let status = self.handle(bench)?.status();
        let pause = self.inner.store.queue_pause(bench).await?;
        let mut starts_in_s = status.progress.map_or(0.0, |progress| progress.remaining_s);
        let mut entries = Vec::new();
        for record in self.inner.store.waiting(bench).await? {
            let planned_s = record.new.planned_s;
            entries.push(queue_entry(record, pause.is_none().then_some(starts_in_s))?);
            starts_in_s += planned_s;
        }
        let left = self.inner.store.left_queue(bench, MOST_LEFT).await?;
        let left = left.into_iter().map(|record| queue_entry(record, None)).collect::<Answer<_>>()?;
        let paused = pause.map(|(reason, since)| QueuePause { reason, since });
        Ok(BenchQueue { bench: bench.to_owned(), paused, entries, left })
    }

    /// An entry, also after it has left the queue.
    pub async fn queue_entry(&self, id: i64) -> Answer<QueueEntry> {
        let entry = queue_entry(self.inner.store.queue_entry(id).await?, None)?;
        let queue = self.queue(&entry.request.bench).await;
        let waiting = queue.ok().and_then(|queue| queue.entries.into_iter().find(|waiting| waiting.id == id));
        Ok(waiting.unwrap_or(entry))
    }

    pub async fn prioritise(&self, id: i64, priority: i32) -> Answer<QueueEntry> {
        let entry = self.queue_entry(id).await?;
        if !self.inner.store.set_queue_priority(id, priority).await? {
            return Err(has_left(&entry));
        }
        self.queue_changed(&entry.request.bench);
        self.queue_entry(id).await
    }

    pub async fn remove_from_queue(&self, id: i64, by: &str) -> Answer<QueueEntry> {
        self.take_from_queue(id, &format!("requested by {by}")).await
    }

    pub(super) async fn take_from_queue(&self, id: i64, reason: &str) -> Answer<QueueEntry> {
        let entry = self.queue_entry(id).await?;
        if !self.inner.store.set_queue_state(id, QueueState::Waiting, QueueState::Removed, Some(reason)).await? {
            return Err(has_left(&self.queue_entry(id).await?));
        }
        tracing::info!(entry = id, bench = entry.request.bench, reason, "removed from the queue");
        self.queue_changed(&entry.request.bench);
        self.queue_entry(id).await
    }

    /// Undoes a removal: the entry waits again, in its former place.
    pub async fn restore_to_queue(&self, id: i64, by: &str) -> Answer<QueueEntry> {
        let entry = self.queue_entry(id).await?;
        let bench = &entry.request.bench;
        self.handle(bench)?;
        let _adding = self.inner.queues.adding.lock().await;
        self.check_room(bench, 1).await?;
        if !self.inner.store.set_queue_state(id, QueueState::Removed, QueueState::Waiting, None).await? {
            let state = word(self.queue_entry(id).await?.state);
            return Err(LabError::Over(format!("queue entry {id} is {state}: only a removed one can be restored")));
        }
        tracing::info!(entry = id, bench, by, "restored to the queue");
        if let Some(lease) = checked_lease(entry.request.lease_s)? {
            self.watch_entry(id, lease);
        }
        self.queue_changed(bench);
        self.queue_entry(id).await
    }

    /// No further entry starts; the active run continues.
    pub async fn pause_queue(&self, bench: &str, by: &str) -> Answer<BenchQueue> {
        self.handle(bench)?;
        self.hold_queue(bench, &format!("requested by {by}")).await?;
        self.queue(bench).await
    }

    pub async fn resume_queue(&self, bench: &str, by: &str) -> Answer<BenchQueue> {
        self.handle(bench)?.check_not_blocked()?;
        tracing::info!(bench, by, "queue resumed");
        self.inner.store.resume_queue(bench).await?;
        self.queue_changed(bench);
        self.queue(bench).await
    }

    pub(super) async fn hold_queue(&self, bench: &str, reason: &str) -> Answer<()> {
        tracing::info!(bench, reason, "queue paused");
        self.inner.store.pause_queue(bench, reason).await?;
        self.queue_changed(bench);
        Ok(())
    }

    pub(super) fn queue_changed(&self, bench: &str) {
        self.inner.queues.notify(bench);
        self.hub().publish(LiveMessage::Queue { bench: bench.to_owned() });
    }
}

fn in_run(i: usize, fault: LabError) -> LabError {
    match fault {
        LabError::Invalid(why) => LabError::Invalid(format!("run {} of the test plan: {why}", i + 1)),
        LabError::NotFound(what) => LabError::NotFound(format!("run {} of the test plan: {what}", i + 1)),
        other => other,
    }
}

fn has_left(entry: &QueueEntry) -> LabError {
    let run = entry.run.map(|run| format!(" as run {run}")).unwrap_or_default();
    LabError::Over(format!("queue entry {} no longer waits: it is {}{run}", entry.id, word(entry.state)))
}

fn queue_entry(record: QueueRecord, starts_in_s: Option<f64>) -> Answer<QueueEntry> {
    Ok(QueueEntry {
        id: record.id,
        plan: record.plan,
        proceed_if: record.new.proceed_if,
        request: reread(&record.new.request)?,
        by: record.new.who,
        priority: record.new.priority,
        state: record.state,
        planned_s: record.new.planned_s,
        starts_in_s,
        run: record.run,
        run_state: record.run_state,
        reason: record.reason,
        created_at: record.created_at,
        ended_at: record.ended_at,
    })
}
