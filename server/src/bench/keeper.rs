//! Stores the commits of a bench worker in order, and retries until the disk accepts them. Only this task waits for the
//! disk.

use super::item::Item;
use super::shared::{RETRY_INTERVAL, Shared};
use super::status::NewFault;
use super::wire::{Entry, Order};
use crate::store::{RunCommit, StoreError};
use crate::view::{LiveMessage, run_event};
use jointbench_procedure::{RunId, RunState, Safe};
use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};
use tokio::sync::mpsc::UnboundedReceiver;
use tokio::time::{sleep, timeout};

/// A disk that needs longer than this is reported as slow.
const SLOW: Duration = Duration::from_millis(500);
pub(super) const NEVER_BEGAN: &str = "the bench became unavailable before the run started";
/// Maximum number of commits in one transaction.
const MOST_TOGETHER: usize = 64;

/// Data of one transaction.
enum Work {
    Commits(Vec<Arc<Entry>>),
    Interruption { run: RunId, safe: Safe, reason: &'static str },
    Fault(NewFault),
}

pub(super) struct Keeper {
    shared: Arc<Shared>,
    /// Number of the last published event of each run.
    published_events: BTreeMap<RunId, u64>,
}

impl Keeper {
    pub fn new(shared: Arc<Shared>) -> Self {
        Self { shared, published_events: BTreeMap::new() }
    }

    pub async fn keep_all(mut self, mut items: UnboundedReceiver<Item>) {
        let mut next = None;
        while let Some(item) = match next.take() {
            Some(item) => Some(item),
            None => items.recv().await,
        } {
            match item {
                Item::Entry(first) => {
                    let mut entries = vec![first];
                    while entries.len() < MOST_TOGETHER {
                        match items.try_recv() {
                            Ok(Item::Entry(entry)) => entries.push(entry),
                            Ok(other) => {
                                next = Some(other);
                                break;
                            }
                            Err(_) => break,
                        }
                    }
                    self.keep_entries(entries).await;
                }
                Item::Interrupted { run, safe, reason } => self.keep_interrupted(run, safe, reason).await,
                Item::Fault(new) => drop(self.store_with_retries(&Work::Fault(new)).await),
                // The requester may no longer wait.
                Item::Flush(done) => drop(done.send(())),
            }
            if next.is_none() && items.is_empty() {
                self.set_trouble(None);
            }
        }
    }

    async fn keep_entries(&mut self, entries: Vec<Arc<Entry>>) {
        let kept = self.store_with_retries(&Work::Commits(entries.clone())).await;
        let Some(last) = entries.last() else { return };
        if self.shared.order(&Order::Stored { number: last.number }).is_err() {
            tracing::debug!(bench = self.shared.name(), "no worker hears what is stored");
        }
        let rows: usize = entries.iter().map(|entry| entry.commit.rows.len()).sum();
        self.shared.status.send_modify(|status| {
            status.unstored.rows = status.unstored.rows.saturating_sub(rows);
            status.unstored.since = (status.unstored.rows > 0).then(jiff::Timestamp::now);
        });
        for entry in entries {
            let commit = &entry.commit;
            if kept {
                self.publish_events(commit.run).await;
            }
            if commit.state.is_final() {
                self.publish_end(commit.run);
                self.shared.settle(commit.run, |run| run.stored = true);
            }
        }
    }

    async fn keep_interrupted(&mut self, run: RunId, safe: Safe, reason: &'static str) {
        self.store_with_retries(&Work::Interruption { run, safe, reason }).await;
        tracing::warn!(
            run.id = run,
            bench = self.shared.name(),
            "{reason}; complete the run with `jointbench run --continue {run}`, or start it again"
        );
        self.publish_events(run).await;
        self.publish_end(run);
        self.shared.settle(run, |run| (run.ended, run.stored) = (true, true));
    }

    /// Retries until the data is stored (`true`), or until the store refuses it permanently (`false`).
    async fn store_with_retries(&self, work: &Work) -> bool {
        loop {
            match self.attempt(work).await {
                Ok(()) => return true,
                Err(fault) if fault.may_pass() => {
                    // A run continues while another program locks the database; other faults end the run.
                    self.set_trouble(Some((fault.to_string(), !matches!(fault, StoreError::Held))));
                    tokio::select! {
                        () = sleep(RETRY_INTERVAL) => {}
                        () = self.shared.disk_changed.notified() => {}
                    }
                }
                Err(fault) => {
                    tracing::error!(bench = self.shared.name(), %fault, "this cannot be stored and is lost");
                    return false;
                }
            }
        }
    }

    /// One attempt. Reports a slow disk during the wait.
    async fn attempt(&self, work: &Work) -> Result<(), StoreError> {
        self.shared.store.fill_disk(self.shared.disk_is_full.load(Ordering::Acquire)).await?;
        let began = Instant::now();
        let mut attempt = std::pin::pin!(async {
            let done = self.store(work).await;
            self.shared.commit_times.observe(began.elapsed().as_secs_f64());
            done
        });
        if let Ok(done) = timeout(SLOW, &mut attempt).await {
            return done;
        }
        if self.shared.status.borrow().unstored.fault.is_none() {
            self.set_trouble(Some(("the disk is slow, or another program holds the database".into(), false)));
        }
        attempt.await
    }

    async fn store(&self, work: &Work) -> Result<(), StoreError> {
        let Shared { store, .. } = &*self.shared;
        match work {
            Work::Commits(entries) => {
                let commits: Vec<&RunCommit> = entries.iter().map(|entry| &entry.commit).collect();
                store.commit_all(&commits).await
            }
            Work::Interruption { run, safe, reason } => {
                store.end_run(*run, RunState::Interrupted, *safe, Some(reason)).await
            }
            Work::Fault(NewFault { instrument, fault }) => {
                store.keep_fault(self.shared.name(), instrument, &fault.at, &fault.text).await
            }
        }
    }

    /// Sets the storage fault and whether it ends the active run.
    fn set_trouble(&self, trouble: Option<(String, bool)>) {
        let shared = &self.shared;
        let (fault, ends_run) = trouble.unzip();
        if shared.status.borrow().unstored.fault == fault {
            return;
        }
        match &fault {
            Some(fault) => tracing::error!(bench = shared.name(), fault, "not yet stored"),
            None => tracing::info!(bench = shared.name(), "everything is stored again"),
        }
        shared.change(|status| status.unstored.fault = fault.clone());
        let fault = fault.filter(|_| ends_run == Some(true));
        if shared.order(&Order::Storage { fault }).is_err() {
            tracing::debug!(bench = shared.name(), "no worker hears how the store is");
        }
        self.publish_unstored_ends();
    }

    /// Publishes the ends of runs before they are stored.
    fn publish_unstored_ends(&self) {
        let over: Vec<RunId> = {
            let status = self.shared.status.borrow();
            status.runs.iter().filter(|(_, run)| run.state.is_final()).map(|(id, _)| *id).collect()
        };
        over.into_iter().for_each(|run| self.publish_end(run));
    }

    /// Publishes the new events with the numbers from the store.
    async fn publish_events(&mut self, run: RunId) {
        let published = self.published_events.entry(run).or_default();
        for event in self.shared.store.events(run, *published).await.unwrap_or_default() {
            *published = event.sequence;
            let (bench, event) = (self.shared.name().to_owned(), run_event(event));
            self.shared.hub.publish(LiveMessage::Event { bench, run, event });
        }
    }

    fn publish_end(&self, run: RunId) {
        let Some(active) = self.shared.status.borrow().runs.get(&run).cloned() else { return };
        self.shared.hub.publish(LiveMessage::State {
            bench: self.shared.name().to_owned(),
            run,
            state: active.state,
            safe: active.safe,
            reason: active.reason,
        });
    }
}
