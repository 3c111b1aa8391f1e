//! The thread that owns a bench. An ordinary loop: one command after the other, a run is one command.

use super::handle::{Slot, lock};
use super::health::expected;
use super::instruments::{Opened, open};
use super::recorder::StoreRecorder;
use super::status::{FAULTS, New, Status};
use crate::config::BenchDescription;
use crate::lab::{safe_view, state_view};
use crate::live::Hub;
use crate::store::{SafetyRecord, Store};
use crate::view::{BenchState, Blocked, InstrumentFault, LiveMessage};
use jointbench_instrument::roles::Instrument;
use jointbench_model::transfer::Alongside;
use jointbench_procedure::{Demand, Plan, RunEnd, RunId, RunState, Safe};
use std::io;
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender};
use std::thread::JoinHandle;
use std::time::Duration;
use tokio::runtime::Handle;
use tokio::sync::{oneshot, watch};

pub(super) enum Command {
    Run { run: RunId, plan: Box<Plan>, controls: Receiver<Demand> },
    Secure { taken: oneshot::Sender<()> },
    Open { done: oneshot::Sender<()> },
    Refresh { done: oneshot::Sender<()> },
    Quit,
}

pub(super) struct Start {
    pub description: BenchDescription,
    pub store: Store,
    pub hub: Hub,
    pub slot: Slot,
    /// Runs that another daemon left open on this bench.
    pub interrupted: Vec<RunId>,
}

impl Start {
    /// The last model that the bench has of such a run, where it can tell row by row.
    async fn alongside(&self, run: RunId, plan: &Plan) -> Option<Alongside> {
        let last = self.store.last_model(&self.description.name, &plan.kind.to_string(), run).await;
        let model = last.inspect_err(|fault| tracing::error!(run.id = run, %fault, "the last model cannot be read"));
        let fit = serde_json::from_value(model.ok()??.fit).ok()?;
        let constants = &self.description.constants;
        Alongside::new(fit, constants.torque_constant_nm_per_a, constants.gear_ratio)
    }
}

const INTERRUPTED: &str = "the daemon ended before the run did; all committed samples are kept";

/// So often it is tried again to keep how a run ended.
const KEEP_EVERY: Duration = Duration::from_secs(1);

type Spawned = (Sender<Command>, watch::Receiver<Status>, JoinHandle<()>);

/// Must be called inside the runtime, which the thread uses to wait for the store.
pub(super) fn spawn(start: Start) -> io::Result<Spawned> {
    let (commands, receiver) = mpsc::channel();
    let (status, watched) = watch::channel(Status::offline());
    let runtime = Handle::current();
    let name = format!("bench {}", start.description.name);
    let thread = std::thread::Builder::new().name(name).spawn(move || {
        Owner { start, status, runtime, opened: None, unkept: Vec::new() }.serve(&receiver);
    })?;
    Ok((commands, watched, thread))
}

struct Owner {
    start: Start,
    status: watch::Sender<Status>,
    runtime: Handle,
    opened: Option<Opened>,
    /// Runs of whose end the store does not know yet.
    unkept: Vec<(RunId, RunEnd)>,
}

impl Owner {
    fn serve(mut self, commands: &Receiver<Command>) {
        self.open();
        // Whoever was here before may have been killed: nothing is known of the bench until it is secured.
        let safe = self.secure();
        for run in std::mem::take(&mut self.start.interrupted) {
            tracing::warn!(run.id = run, bench = self.name(), %safe, "run was interrupted, the bench is secured now");
            let ended =
                self.runtime.block_on(self.start.store.end_run(run, RunState::Interrupted, safe, Some(INTERRUPTED)));
            if let Err(fault) = ended {
                tracing::error!(run.id = run, %fault, "how the run ended could not be kept");
            }
        }
        self.change(|status| status.settled = true);
        while let Some(command) = self.next(commands) {
            match command {
                Command::Run { run, plan, controls } => self.run(run, &plan, &controls),
                Command::Secure { taken } => {
                    self.change(|status| status.state = BenchState::Securing);
                    // Whoever asked may have left; the bench is secured all the same.
                    let _ = taken.send(());
                    self.secure();
                }
                Command::Open { done } => {
                    self.let_time_pass();
                    let came_back = if self.is_open() { self.recover() } else { self.open() };
                    if came_back {
                        self.secure();
                    } else {
                        self.rest();
                    }
                    let _ = done.send(());
                }
                Command::Refresh { done } => {
                    self.rest();
                    let _ = done.send(());
                }
                Command::Quit => break,
            }
        }
        tracing::debug!(bench = self.name(), "bench thread ends");
    }

    /// `None`: nobody is left to command.
    fn next(&mut self, commands: &Receiver<Command>) -> Option<Command> {
        while !self.unkept.is_empty() {
            match commands.recv_timeout(KEEP_EVERY) {
                Ok(command) => return Some(command),
                Err(RecvTimeoutError::Disconnected) => return None,
                Err(RecvTimeoutError::Timeout) => {
                    self.let_time_pass();
                    self.keep_ends();
                }
            }
        }
        commands.recv().ok()
    }

    /// Moves the clock of a mock bench by a second of the wall's, which nobody else does between runs: the bad day that it
    /// has may be over.
    fn let_time_pass(&self) {
        let Some(mock) = self.opened.as_ref().and_then(|opened| opened.mock.as_ref()) else { return };
        let clock = mock.clock();
        let pace = self.start.description.pace().unwrap_or(1.0).max(1.0);
        clock.sleep_until_s(clock.now_s() + pace * KEEP_EVERY.as_secs_f64());
        if let Err(fault) = self.runtime.block_on(self.start.store.fill_disk(mock.disk_is_full())) {
            tracing::error!(bench = self.name(), %fault, "the mock bench's full disk is not what it should be");
        }
    }

    /// Says of runs that are over how they ended: on a full disk as soon as there is room for it.
    fn keep_ends(&mut self) {
        for (run, end) in std::mem::take(&mut self.unkept) {
            let RunEnd { state, safe, reason, .. } = &end;
            let kept = self.runtime.block_on(self.start.store.end_run(run, *state, *safe, reason.as_deref()));
            let message = LiveMessage::State {
                bench: self.name().to_owned(),
                run,
                state: state_view(*state),
                safe: Some(safe_view(*safe)),
                reason: reason.clone(),
            };
            self.start.hub.tell(message);
            if let Err(fault) = kept {
                tracing::error!(run.id = run, %fault, "how the run ended could not be kept, and will be tried again");
                self.unkept.push((run, end));
            }
        }
    }

    fn name(&self) -> &str {
        &self.start.description.name
    }

    fn is_open(&self) -> bool {
        self.opened.as_ref().is_some_and(|opened| opened.bench.is_some())
    }

    /// Whether all instruments answer.
    fn open(&mut self) -> bool {
        // The ports of a half-open bench are let go first.
        self.opened = None;
        let opened = open(&self.start.description);
        for instrument in &opened.instruments {
            let (name, port) = (&instrument.name, &instrument.port);
            match &instrument.fault {
                None => tracing::info!(bench = self.name(), name, port, driver = instrument.driver, "instrument ready"),
                Some(fault) => tracing::warn!(bench = self.name(), name, port, fault, "instrument not ready"),
            }
        }
        let mut instruments = opened.instruments.clone();
        for instrument in &mut instruments {
            instrument.faults = self.known_faults(&instrument.name);
        }
        let channels = opened.bench.as_ref().map(expected).unwrap_or_default();
        self.opened = Some(opened);
        let new = self.change(|status| {
            if status.channels.is_empty() {
                status.channels = channels;
            }
            status.found(instruments)
        });
        self.keep_faults(new);
        self.is_open()
    }

    /// Tries again what a run has found wanting. Whether all of it answers.
    fn recover(&mut self) -> bool {
        let Some(bench) = self.opened.as_mut().and_then(|opened| opened.bench.as_mut()) else { return false };
        let mut instruments = self.status.borrow().instruments.clone();
        for wanting in instruments.iter_mut().filter(|instrument| !instrument.ready) {
            match bench.instrument(&wanting.name).map(Instrument::recover) {
                Some(Ok(identity)) => {
                    (wanting.ready, wanting.identity) = (true, Some(identity.into()));
                    (wanting.fault, wanting.since) = (None, None);
                }
                Some(Err(fault)) => wanting.fault = Some(fault.to_string()),
                None => {}
            }
        }
        let all = instruments.iter().all(|instrument| instrument.ready);
        let new = self.change(|status| status.found(instruments));
        self.keep_faults(new);
        all
    }

    /// What was wrong with an instrument before the daemon was started.
    fn known_faults(&self, instrument: &str) -> Vec<InstrumentFault> {
        let known = self.runtime.block_on(self.start.store.faults(self.name(), instrument, FAULTS as u32));
        let known = known.inspect_err(|fault| tracing::error!(instrument, %fault, "earlier faults cannot be read"));
        known.unwrap_or_default().into_iter().map(|(at, text)| InstrumentFault { at, text }).collect()
    }

    fn keep_faults(&self, new: Vec<New>) {
        for New { instrument, fault: InstrumentFault { at, text } } in new {
            let kept = self.runtime.block_on(self.start.store.keep_fault(self.name(), &instrument, &at, &text));
            if let Err(fault) = kept {
                tracing::error!(instrument, text, %fault, "what was wrong with an instrument could not be kept");
            }
        }
    }

    fn run(&mut self, run: RunId, plan: &Plan, controls: &Receiver<Demand>) {
        let Some(Opened { bench: Some(bench), mock, .. }) = self.opened.as_mut() else {
            // The lab opens a bench before it starts a run; a bench that went away in between has no instruments to move.
            tracing::error!(run.id = run, "run started on a bench that is not open");
            lock(&self.start.slot).take();
            return;
        };
        let model = self.runtime.block_on(self.start.alongside(run, plan));
        let mut recorder =
            StoreRecorder::new(&self.start, &self.status, &self.runtime, mock.as_ref(), run, model, plan.rate_hz);
        let end = jointbench_procedure::run(bench, plan, run, controls, &mut recorder);
        let faults = recorder.into_faults();
        self.unkept.push((run, end.clone()));
        self.keep_ends();
        self.block_unless_safe(end.safe, end.reason.as_deref(), Some(run));
        let new = self.change(|status| faults.iter().filter_map(|met| status.met(met)).collect());
        self.keep_faults(new);
        // Free before it is told: whoever hears of the end may start the next run.
        lock(&self.start.slot).take();
        self.rest();
    }

    fn secure(&mut self) -> Safe {
        let Some(bench) = self.opened.as_mut().and_then(|opened| opened.bench.as_mut()) else {
            // A bench that is merely not plugged in needs no acknowledgement; it is secured when it is opened.
            if !self.start.interrupted.is_empty() {
                let reason = "a run was interrupted and the instruments do not answer";
                self.block_unless_safe(Safe::UnsafeUnknown, Some(reason), None);
            }
            self.rest();
            return Safe::UnsafeUnknown;
        };
        let secured = jointbench_procedure::secure(bench);
        for note in &secured.notes {
            tracing::warn!(bench = self.start.description.name, "{note}");
        }
        let reason = (!secured.notes.is_empty()).then(|| secured.notes.join("; "));
        self.block_unless_safe(secured.safe, reason.as_deref(), None);
        self.rest();
        secured.safe
    }

    fn block_unless_safe(&self, safe: Safe, reason: Option<&str>, run: Option<RunId>) {
        if safe == Safe::UnsafeUnknown {
            let reason = format!("the bench is not known to be safe: {}", reason.unwrap_or("no cause is known"));
            let blocked = self.runtime.block_on(self.start.store.block_bench(self.name(), run, &reason));
            if let Err(fault) = blocked {
                tracing::error!(bench = self.name(), %fault, "the block of the bench could not be kept");
            }
        }
    }

    /// The state of a bench on which nothing is on: what the store says of it, and its instruments.
    fn rest(&self) {
        let blocked = match self.runtime.block_on(self.start.store.bench_block(self.name())) {
            Ok(block) => {
                block.map(|SafetyRecord { stopped, reason, by, at, .. }| Blocked { stopped, reason, by, since: at })
            }
            Err(fault) => {
                tracing::error!(bench = self.name(), %fault, "the state of the bench cannot be read");
                self.status.borrow().blocked.clone()
            }
        };
        let open = self.is_open();
        self.change(|status| {
            status.state = match &blocked {
                Some(blocked) if blocked.stopped => BenchState::Stopped,
                Some(_) => BenchState::Fault,
                None if !open => BenchState::Offline,
                None if status.faults().is_some() => BenchState::Fault,
                None => BenchState::Idle,
            };
            status.blocked = blocked;
            status.run = None;
            status.progress = None;
            status.readings.clear();
        });
    }

    fn change<T: Default>(&self, change: impl FnOnce(&mut Status) -> T) -> T {
        let mut told = T::default();
        self.status.send_modify(|status| told = change(status));
        let bench = crate::lab::bench_view(&self.start.description, &self.status.borrow());
        self.start.hub.tell(LiveMessage::Bench { bench: Box::new(bench) });
        told
    }
}
