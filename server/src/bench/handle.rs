//! Handle of a bench for all clients. Cheap to clone.

use super::display::Display;
use super::error::BenchError;
use super::item::Item;
use super::keeper::{Keeper, NEVER_BEGAN};
use super::shared::{Shared, blocked, lock};
use super::status::Status;
use super::supervisor::Supervisor;
use super::wire::{MemoryRead, Order};
use crate::config::BenchDescription;
use crate::live::Hub;
use crate::store::{SafetyRecord, Store};
use jointbench_instrument::LinkLatency;
use jointbench_model::export::OnlinePrediction;
use jointbench_procedure::{BenchFacts, Demand, Plan, RunId, Safe};
use prometheus_client::metrics::counter::Counter;
use prometheus_client::metrics::histogram::Histogram;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::Duration;
use tokio::sync::{mpsc, watch};
use tokio::time::timeout;

/// A worker that does not answer within this time waits for an instrument.
const ANSWERS: Duration = Duration::from_secs(1);
/// Maximum time for the answer to a software stop, stored or not.
const STORES: Duration = Duration::from_millis(500);
const STOPPED: &str = "software stop pressed";

#[derive(Clone)]
pub struct BenchHandle {
    shared: Arc<Shared>,
    display: Arc<Mutex<Option<Display>>>,
    thread: Arc<Mutex<Option<JoinHandle<()>>>>,
}

/// Initial state of a bench.
pub struct InitialState {
    pub description: BenchDescription,
    /// An existing block of the bench.
    pub block: Option<SafetyRecord>,
    /// The runs that another daemon left open on this bench.
    pub interrupted: Vec<RunId>,
}

impl BenchHandle {
    /// Starts the worker, which opens and secures the instruments. Requires a runtime. `program`: path of the
    /// `jointbench` executable.
    pub fn start(
        beginning: InitialState,
        store: Store,
        hub: Hub,
        data: &Path,
        program: &Path,
    ) -> std::io::Result<Self> {
        let InitialState { description, block, interrupted } = beginning;
        let (to_keep, items) = mpsc::unbounded_channel();
        let paths = (std::path::absolute(data)?, program.to_owned());
        let shared = Arc::new(Shared::new(description, store, hub, paths, to_keep));
        shared.status.send_modify(|status| status.blocked = block.as_ref().map(|block| blocked(block, true)));
        tokio::spawn(Keeper::new(shared.clone()).keep_all(items));
        let display: Arc<Mutex<Option<Display>>> = Arc::default();
        let supervisor = Supervisor::new(shared.clone(), display.clone(), interrupted);
        let name = format!("bench {}", shared.name());
        let thread = std::thread::Builder::new().name(name).spawn(move || supervisor.supervise())?;
        Ok(Self { shared, display, thread: Arc::new(Mutex::new(Some(thread))) })
    }

    pub fn name(&self) -> &str {
        self.shared.name()
    }

    pub fn description(&self) -> &BenchDescription {
        &self.shared.description
    }

    pub fn status(&self) -> Status {
        self.shared.status.borrow().clone()
    }

    pub fn watch(&self) -> watch::Receiver<Status> {
        self.shared.status.subscribe()
    }

    /// [`BenchError::Busy`] if no run may start until a person resets the bench.
    pub fn check_not_blocked(&self) -> Result<(), BenchError> {
        let Some(block) = self.status().blocked else { return Ok(()) };
        let (name, word) = (self.name(), if block.stopped { "stopped" } else { "blocked" });
        Err(BenchError::Busy(format!(
            "bench {name} is {word}: {}. Inspect the bench, then reset it with a reason in the dashboard or with \
             `jointbench reset {name} --reason '…'`",
            block.reason
        )))
    }

    /// Data for planning, independent of whether the instruments are open.
    pub fn facts(&self) -> BenchFacts {
        facts(&self.shared.description)
    }

    /// Reserves the bench for one run. [`BenchError::Busy`] if another run is active or not yet stored.
    pub fn claim(&self) -> Result<Claim, BenchError> {
        let name = self.name();
        let taken = self.shared.claimed.compare_exchange(false, true, Ordering::AcqRel, Ordering::Acquire).is_err();
        let status = self.shared.status.borrow().clone();
        let on = taken || status.runs.values().any(|run| !run.ended);
        if on || !status.runs.is_empty() {
            if !taken {
                self.shared.claimed.store(false, Ordering::Release);
            }
            return Err(BenchError::Busy(match status.unstored.fault {
                Some(fault) if !on => format!("bench {name}: its last run has ended, but is not yet stored: {fault}"),
                _ => format!(
                    "a run is in progress on bench {name}: stop it (`jointbench stop`, or in the dashboard), or wait \
                     until it finishes"
                ),
            }));
        }
        Ok(Claim { bench: self.clone() })
    }

    /// Whether a run is active, starting, or not yet stored.
    pub fn is_busy(&self) -> bool {
        self.shared.is_busy(&self.shared.status.borrow())
    }

    /// Waits until no run is active, starting, or not yet stored; also returns when the daemon ends.
    pub async fn until_free(&self) {
        drop(self.watch().wait_for(|status| !self.shared.is_busy(status)).await);
    }

    /// Waits until a run is active, starting, or not yet stored; also returns when the daemon ends.
    pub async fn until_busy(&self) {
        drop(self.watch().wait_for(|status| self.shared.is_busy(status)).await);
    }

    /// How long storing took [s].
    pub fn commit_times(&self) -> Histogram {
        self.shared.commit_times.clone()
    }

    /// Late set-points of all finished steps since the start of the daemon.
    pub fn late_ticks(&self) -> Counter {
        self.shared.late_ticks.clone()
    }

    /// Exchanges with each instrument since the start of the daemon, by its name.
    pub fn link_latency(&self) -> BTreeMap<String, LinkLatency> {
        lock(&self.shared.link_latency).clone()
    }

    /// `false` if the run was not active.
    pub fn control(&self, run: RunId, demand: Demand) -> bool {
        let is_on = self.shared.status.borrow().runs.get(&run).is_some_and(|run| !run.ended && !run.state.is_final());
        is_on && self.shared.order(&Order::Control(demand)).is_ok()
    }

    /// Software stop: blocks new runs, ends the active run and secures the bench. Returns when the worker has received
    /// it and, if that is fast, when it is stored.
    pub async fn stop(&self, by: &str) {
        let run = self.shared.status.borrow().run;
        let block = self.shared.new_block(true, STOPPED, run, Some(by));
        let known = self.shared.order_with_reply(|ticket| Order::Stop { block: block.clone(), ticket });
        let at = block.at.clone();
        self.shared.enter(block);
        match known {
            Ok(known) => drop(timeout(ANSWERS, known).await),
            Err(_) => tracing::warn!(bench = self.name(), "the bench worker is away: the next one begins stopped"),
        }
        let stored = |status: &Status| status.blocked.as_ref().is_none_or(|block| block.stored || block.since != at);
        // If storing takes longer, the bench reports that the stop is not yet stored.
        drop(timeout(STORES, self.watch().wait_for(stored)).await);
    }

    /// Releases the block that began at `since`; the store already contains the release.
    pub fn lift(&self, since: &str) -> bool {
        self.shared.lift(since)
    }

    /// Reconnects the instruments that did not answer, and secures the bench.
    pub async fn reopen(&self) -> Result<(), BenchError> {
        let wanting: Vec<String> = {
            let status = self.shared.status.borrow();
            status.instruments.iter().filter(|one| !one.ready).map(|one| one.name.clone()).collect()
        };
        let done = self.shared.order_with_reply(|ticket| Order::Reopen { wanting, ticket }).map_err(|_| self.gone())?;
        done.await.map(drop).map_err(|_| self.gone())
    }

    /// Reads ranges (first address, number of bytes) of the servo's memory. No run can start meanwhile.
    pub async fn read_memory(&self, ranges: Vec<(u8, u8)>) -> Result<Vec<Vec<u8>>, BenchError> {
        let _claim = self.claim()?;
        let done =
            self.shared.order_with_reply(|ticket| Order::ReadMemory { ranges, ticket }).map_err(|_| self.gone())?;
        match done.await.map_err(|_| self.gone())? {
            Some(MemoryRead::Read(bytes)) => Ok(bytes),
            Some(MemoryRead::Failed(why)) => Err(BenchError::Instrument(format!("bench {}: {why}", self.name()))),
            Some(MemoryRead::None) | None => Err(BenchError::NoServo(format!(
                "the joint of bench {} has no servo whose memory can be read: select a bench with a Puma-type servo",
                self.name()
            ))),
        }
    }

    /// Ends an active run, secures the bench and ends the worker. Blocks until then.
    pub fn shut_down(&self) {
        self.shared.ending.store(true, Ordering::Release);
        if self.shared.order(&Order::Quit).is_err() {
            tracing::debug!(bench = self.name(), "no worker to end");
        }
        if let Some(thread) = lock(&self.thread).take()
            && thread.join().is_err()
        {
            tracing::error!(bench = self.name(), "the thread of the bench has panicked");
        }
    }

    /// The last model of the bench for such a run, if it supports row-by-row evaluation.
    async fn alongside(&self, run: RunId, plan: &Plan) -> Option<OnlinePrediction> {
        let last = self.shared.store.last_model(self.name(), &plan.kind.to_string(), run).await;
        let model = last.inspect_err(|fault| tracing::error!(run.id = run, %fault, "the last model cannot be read"));
        let fit = serde_json::from_value(model.ok()??.fit).ok()?;
        let constants = &self.shared.description.constants;
        OnlinePrediction::new(fit, constants.torque_constant_nm_per_a, constants.gear_ratio)
    }

    fn gone(&self) -> BenchError {
        BenchError::Instrument(format!(
            "the worker of bench {} terminated and is being restarted: try again in a moment",
            self.name()
        ))
    }
}

/// Data of a described bench for planning.
pub fn facts(description: &BenchDescription) -> BenchFacts {
    let has = description.has();
    BenchFacts {
        name: description.name.clone(),
        simulated: description.is_simulated(),
        limits: description.limits,
        constants: description.constants,
        has_torque_sensor: has.torque_sensor,
        has_two_ranges: has.two_ranges,
        has_brake: has.brake,
        encoder_counts: has.encoder_counts,
        has_stage: has.stage,
        amperes_per_volt: has.amperes_per_volt,
        setpoint_interval: has.setpoint_interval,
        brake_model: None,
        compared_brake: None,
        feeds_forward: has.feeds_forward,
    }
}

/// Reservation of a bench for a run. Dropping it without a start releases the bench.
pub struct Claim {
    bench: BenchHandle,
}

impl Claim {
    /// Passes a stored run to the worker. Without a worker, the run is interrupted before its start.
    pub async fn start(self, run: RunId, plan: Plan) -> Result<(), BenchError> {
        let bench = &self.bench;
        let display = Display::new(bench.alongside(run, &plan).await, plan.rate_hz);
        *lock(&bench.display) = Some(display);
        bench.shared.change(|status| status.begin(run));
        bench.shared.order(&Order::Run { run, plan: Box::new(plan) }).map_err(|_| {
            bench.shared.change(Status::set_idle);
            let item = Item::Interrupted { run, safe: Safe::SafeCommanded, reason: NEVER_BEGAN };
            if bench.shared.to_keep.send(item).is_err() {
                tracing::error!(run.id = run, "the storage thread has ended");
            }
            bench.gone()
        })
    }
}

impl Drop for Claim {
    fn drop(&mut self) {
        self.bench.shared.claimed.store(false, Ordering::Release);
        // Wakes tasks that wait for a free bench.
        self.bench.shared.status.send_modify(|_| {});
    }
}
