//! Shared state of a bench in the server: its status, the connection to its worker, and its block.

use super::item::Item;
use super::status::{ActiveRun, Status};
use super::view::bench_view;
use super::wire::{self, MemoryRead, Order};
use crate::config::BenchDescription;
use crate::live::Hub;
use crate::store::{SafetyRecord, Store};
use crate::view::{BenchState, Blocked, LiveMessage};
use jiff::Timestamp;
use jointbench_instrument::LinkLatency;
use jointbench_procedure::RunId;
use prometheus_client::metrics::counter::Counter;
use prometheus_client::metrics::histogram::{Histogram, exponential_buckets};
use std::collections::{BTreeMap, HashMap};
use std::path::PathBuf;
use std::process::ChildStdin;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;
use tokio::runtime::Handle;
use tokio::sync::mpsc::UnboundedSender;
use tokio::sync::{Notify, oneshot, watch};
use tokio::time::sleep;

/// Retry interval of storing.
pub(super) const RETRY_INTERVAL: Duration = Duration::from_millis(500);

pub(super) struct Shared {
    pub description: BenchDescription,
    pub store: Store,
    pub hub: Hub,
    pub data: PathBuf,
    pub program: PathBuf,
    /// For threads outside of the runtime.
    pub runtime: Handle,
    pub status: watch::Sender<Status>,
    /// Queue of the data to store, in order.
    pub to_keep: UnboundedSender<Item>,
    /// The bench is reserved for a run without a number.
    pub claimed: AtomicBool,
    /// The daemon ends: the worker is not restarted.
    pub ending: AtomicBool,
    /// Whether the mock bench simulates a full disk, and a notification of changes.
    pub disk_is_full: AtomicBool,
    pub disk_changed: Notify,
    /// Duration of each attempt to store [s].
    pub commit_times: Histogram,
    /// Late set-points of all finished steps since the start of the daemon.
    pub late_ticks: Counter,
    /// Exchanges with each instrument since the start of the daemon, by its name.
    pub link_latency: Mutex<BTreeMap<String, LinkLatency>>,
    orders: Mutex<Option<ChildStdin>>,
    tickets: Mutex<HashMap<u64, oneshot::Sender<Option<MemoryRead>>>>,
    last_ticket: AtomicU64,
}

/// The bench has no worker that could receive the order.
#[derive(Debug)]
pub(super) struct NoWorker;

impl Shared {
    /// Requires a runtime.
    pub fn new(
        description: BenchDescription,
        store: Store,
        hub: Hub,
        (data, program): (PathBuf, PathBuf),
        to_keep: UnboundedSender<Item>,
    ) -> Self {
        Self {
            description,
            store,
            hub,
            data,
            program,
            runtime: Handle::current(),
            status: watch::Sender::new(Status::offline()),
            to_keep,
            claimed: AtomicBool::new(false),
            ending: AtomicBool::new(false),
            disk_is_full: AtomicBool::new(false),
            disk_changed: Notify::new(),
            commit_times: Histogram::new(exponential_buckets(0.001, 4.0, 8)),
            late_ticks: Counter::default(),
            link_latency: Mutex::default(),
            orders: Mutex::default(),
            tickets: Mutex::default(),
            last_ticket: AtomicU64::new(0),
        }
    }

    pub fn name(&self) -> &str {
        &self.description.name
    }

    /// Sets or removes the connection to the worker.
    pub fn set_worker(&self, orders: Option<ChildStdin>) {
        *lock(&self.orders) = orders;
        if lock(&self.orders).is_none() {
            // The worker sends no more answers: end the waiting requests.
            lock(&self.tickets).clear();
        }
    }

    pub fn order(&self, order: &Order) -> Result<(), NoWorker> {
        let mut orders = lock(&self.orders);
        wire::send(orders.as_mut().ok_or(NoWorker)?, order).map_err(|_| NoWorker)
    }

    /// Sends an order and returns a receiver for its completion, with the data that was read.
    pub fn order_with_reply(
        &self,
        order: impl FnOnce(u64) -> Order,
    ) -> Result<oneshot::Receiver<Option<MemoryRead>>, NoWorker> {
        let ticket = self.last_ticket.fetch_add(1, Ordering::Relaxed) + 1;
        let (done, wait) = oneshot::channel();
        lock(&self.tickets).insert(ticket, done);
        self.order(&order(ticket))?;
        Ok(wait)
    }

    pub fn done(&self, ticket: u64, read: Option<MemoryRead>) {
        if let Some(done) = lock(&self.tickets).remove(&ticket) {
            // The requester may no longer wait.
            let _ = done.send(read);
        }
    }

    /// `status` is an argument because a waiting task already holds its lock.
    pub fn is_busy(&self, status: &Status) -> bool {
        self.claimed.load(Ordering::Acquire) || !status.runs.is_empty()
    }

    pub fn change<T: Default>(&self, change: impl FnOnce(&mut Status) -> T) -> T {
        let mut result = T::default();
        self.status.send_modify(|status| result = change(status));
        self.publish_bench();
        result
    }

    pub fn publish_bench(&self) {
        let bench = bench_view(&self.description, &self.status.borrow());
        self.hub.publish(LiveMessage::Bench { bench: Box::new(bench) });
    }

    /// A block from now on. It keeps an earlier software stop and its reason.
    pub fn new_block(&self, stopped: bool, reason: &str, run: Option<RunId>, by: Option<&str>) -> SafetyRecord {
        let before = self.status.borrow().blocked.clone();
        let reason = match &before {
            Some(before) if before.stopped != stopped => format!("{reason}; previously: {}", before.reason),
            Some(before) if stopped => before.reason.clone(),
            _ => reason.to_owned(),
        };
        let stopped = stopped || before.is_some_and(|before| before.stopped);
        let at = format!("{:.6}", Timestamp::now());
        SafetyRecord { blocked: true, stopped, reason, run, by: by.map(str::to_owned), at }
    }

    /// Blocks all motion until a person releases the block: shown immediately, stored as soon as possible.
    pub fn enter(self: &Arc<Self>, block: SafetyRecord) {
        self.change(|status| {
            status.blocked = Some(blocked(&block, false));
            match status.run {
                Some(_) if block.stopped => status.state = BenchState::Securing,
                Some(_) => {}
                None => status.set_idle(),
            }
        });
        keep_block(self.clone(), block);
    }

    /// Releases the block that began at `since`, no later block. Returns whether the bench is free.
    pub fn lift(&self, since: &str) -> bool {
        let is_free = self.change(|status| {
            status.blocked.take_if(|blocked| blocked.since == since);
            if status.run.is_none() {
                status.set_idle();
            }
            status.blocked.is_none()
        });
        if self.order(&Order::Release { until: since.to_owned() }).is_err() {
            tracing::debug!(bench = self.name(), "no worker hears that the block is lifted");
        }
        is_free
    }

    pub fn block_is_stored(&self, at: &str) {
        self.change(|status| {
            if let Some(blocked) = status.blocked.as_mut().filter(|blocked| blocked.since == at) {
                blocked.stored = true;
            }
        });
        let stored = Order::BlockStored { at: at.to_owned() };
        if self.order(&stored).is_err() {
            tracing::debug!(bench = self.name(), "no worker hears that the block is stored");
        }
    }

    /// Removes a run when its worker has finished and its end is stored.
    pub fn settle(&self, run: RunId, change: impl FnOnce(&mut ActiveRun)) {
        self.change(|status| {
            let Some(active) = status.runs.get_mut(&run) else { return };
            change(active);
            if active.ended && active.stored {
                status.runs.remove(&run);
            }
        });
    }
}

/// Stores a block as soon as possible, before other waiting data.
fn keep_block(shared: Arc<Shared>, block: SafetyRecord) {
    shared.runtime.clone().spawn(async move {
        while let Err(fault) = shared.store.keep_block(shared.name(), &block).await {
            tracing::error!(bench = shared.name(), %fault, "the block of the bench is not yet stored");
            sleep(RETRY_INTERVAL).await;
        }
        shared.block_is_stored(&block.at);
    });
}

pub(super) fn blocked(block: &SafetyRecord, stored: bool) -> Blocked {
    let SafetyRecord { stopped, reason, by, at, .. } = block.clone();
    Blocked { stopped, reason, by, since: at, stored }
}

pub(super) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
