//! The way to a bench for everybody but its thread. Cheap to clone.

use super::status::Status;
use super::thread::{self, Command};
use crate::config::BenchDescription;
use crate::lab::LabError;
use crate::live::Hub;
use crate::store::Store;
use jointbench_procedure::{BenchFacts, Control, Demand, Plan, RunId};
use std::sync::mpsc::{self, Sender};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use tokio::sync::{oneshot, watch};

#[derive(Clone)]
pub struct BenchHandle {
    shared: Arc<Shared>,
}

struct Shared {
    description: BenchDescription,
    commands: Sender<Command>,
    status: watch::Receiver<Status>,
    slot: Slot,
    thread: Mutex<Option<JoinHandle<()>>>,
}

/// The way to the run that is on. Taken before a run begins, given back by the thread at its end.
pub(super) type Slot = Arc<Mutex<Option<Sender<Demand>>>>;

pub(super) fn lock(slot: &Slot) -> MutexGuard<'_, Option<Sender<Demand>>> {
    slot.lock().unwrap_or_else(PoisonError::into_inner)
}

impl BenchHandle {
    /// Starts the thread, which opens the instruments and secures them. `interrupted`: the runs that another daemon left
    /// open on this bench.
    pub fn start(
        description: BenchDescription,
        store: Store,
        hub: Hub,
        interrupted: Vec<RunId>,
    ) -> std::io::Result<Self> {
        let slot = Slot::default();
        let start = thread::Start { description: description.clone(), store, hub, slot: slot.clone(), interrupted };
        let (commands, status, thread) = thread::spawn(start)?;
        let thread = Mutex::new(Some(thread));
        Ok(Self { shared: Arc::new(Shared { description, commands, status, slot, thread }) })
    }

    pub fn name(&self) -> &str {
        &self.shared.description.name
    }

    pub fn description(&self) -> &BenchDescription {
        &self.shared.description
    }

    pub fn status(&self) -> Status {
        self.shared.status.borrow().clone()
    }

    /// To wait for a change.
    pub fn watch(&self) -> watch::Receiver<Status> {
        self.shared.status.clone()
    }

    /// What a procedure may know before anything moves, instruments open or not.
    pub fn facts(&self) -> BenchFacts {
        let description = &self.shared.description;
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
            brake_model: None,
            feeds_forward: has.feeds_forward,
        }
    }

    /// Reserves the bench for one run. [`LabError::Conflict`] where another is on.
    pub fn claim(&self) -> Result<Claim, LabError> {
        let mut slot = lock(&self.shared.slot);
        if slot.is_some() {
            let name = self.name();
            return Err(LabError::Conflict(format!(
                "bench {name} has a run on: stop it (`jointbench stop`, or in the dashboard), or wait for its end"
            )));
        }
        let (sender, controls) = mpsc::channel();
        *slot = Some(sender);
        drop(slot);
        Ok(Claim { bench: self.clone(), controls: Some(controls) })
    }

    /// A run is on, or about to be.
    pub fn is_busy(&self) -> bool {
        lock(&self.shared.slot).is_some()
    }

    /// Whether a run was there to hear it.
    pub fn control(&self, demand: Demand) -> bool {
        lock(&self.shared.slot).as_ref().is_some_and(|run| run.send(demand).is_ok())
    }

    /// Ends a run at once, or secures the bench where none is on. Returns when the thread has taken the command.
    pub async fn stop(&self, by: &str) -> Result<(), LabError> {
        if self.control(Demand { control: Control::EStop, by: Some(by.to_owned()) }) {
            return Ok(());
        }
        let (taken, wait) = oneshot::channel();
        self.send(Command::Secure { taken })?;
        wait.await.map_err(|_| self.gone())
    }

    /// As [`BenchHandle::refresh`], as soon as the run that is on has ended.
    pub fn refresh_later(&self) -> Result<(), LabError> {
        self.send(Command::Refresh { done: oneshot::channel().0 })
    }

    /// Tries the instruments again that did not answer.
    pub async fn reopen(&self) -> Result<(), LabError> {
        let (done, wait) = oneshot::channel();
        self.send(Command::Open { done })?;
        wait.await.map_err(|_| self.gone())
    }

    /// The block was lifted, or set, in the store.
    pub async fn refresh(&self) -> Result<(), LabError> {
        let (done, wait) = oneshot::channel();
        self.send(Command::Refresh { done })?;
        wait.await.map_err(|_| self.gone())
    }

    /// Ends a run that is on, secures the bench and ends the thread. Blocks until then.
    pub fn shut_down(&self) {
        self.control(Control::Quit.into());
        // An error says that the thread has ended already.
        let _ = self.shared.commands.send(Command::Quit);
        let thread = self.shared.thread.lock().unwrap_or_else(PoisonError::into_inner).take();
        if let Some(thread) = thread
            && thread.join().is_err()
        {
            tracing::error!(bench = self.name(), "the bench thread has panicked");
        }
    }

    fn send(&self, command: Command) -> Result<(), LabError> {
        self.shared.commands.send(command).map_err(|_| self.gone())
    }

    fn gone(&self) -> LabError {
        LabError::Bench(format!("the thread of bench {} has ended: start the daemon again", self.name()))
    }
}

/// A bench that is reserved for a run. Dropped without a start, it is free again.
pub struct Claim {
    bench: BenchHandle,
    controls: Option<mpsc::Receiver<Demand>>,
}

impl Claim {
    pub fn start(mut self, run: RunId, plan: Plan) -> Result<(), LabError> {
        match self.controls.take() {
            Some(controls) => self.bench.send(Command::Run { run, plan: Box::new(plan), controls }),
            None => Ok(()),
        }
    }
}

impl Drop for Claim {
    fn drop(&mut self) {
        if self.controls.is_some() {
            lock(&self.bench.shared.slot).take();
        }
    }
}
