//! Shared state of the threads of a worker: block, control of the active run, outbox.

use super::outbox::Outbox;
use crate::bench::wire::Report;
use crate::store::SafetyRecord;
use jointbench_devices::MockBench;
use jointbench_instrument::LatencyCounter;
use jointbench_procedure::{Control, Demand, RunId};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, Receiver, Sender};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

pub(super) struct WorkerState {
    pub outbox: Arc<Outbox>,
    state: Mutex<State>,
    disk_is_full: AtomicBool,
}

struct State {
    block: Option<SafetyRecord>,
    block_is_stored: bool,
    run: Option<(RunId, Sender<Demand>)>,
    server_is_gone: bool,
}

impl WorkerState {
    pub fn new(outbox: Arc<Outbox>, block: Option<SafetyRecord>) -> Self {
        let state = Mutex::new(State { block, block_is_stored: true, run: None, server_is_gone: false });
        Self { outbox, state, disk_is_full: AtomicBool::new(false) }
    }

    pub fn block(&self) -> Option<SafetyRecord> {
        self.lock().block.clone()
    }

    pub fn set_block(&self, block: SafetyRecord) {
        let mut state = self.lock();
        (state.block, state.block_is_stored) = (Some(block), false);
    }

    pub fn block_is_stored(&self, at: &str) {
        let mut state = self.lock();
        if state.block.as_ref().is_some_and(|block| block.at == at) {
            state.block_is_stored = true;
        }
    }

    /// The block, if the server has not confirmed its storage.
    pub fn unstored_block(&self) -> Option<SafetyRecord> {
        let state = self.lock();
        state.block.clone().filter(|_| !state.block_is_stored)
    }

    /// A later stop, which the person has not seen, remains.
    pub fn release(&self, until: &str) {
        self.lock().block.take_if(|block| block.at.as_str() <= until);
    }

    /// Software stop: first blocks new runs, then ends the active run. Returns whether a run was active.
    pub fn stop(&self, block: SafetyRecord) -> bool {
        let by = block.by.clone();
        self.set_block(block);
        self.control(Demand { control: Control::EStop, by })
    }

    /// Creates the control channel of a run, also before its start.
    pub fn expect(&self, run: RunId) -> Receiver<Demand> {
        let (sender, receiver) = mpsc::channel();
        self.outbox.set_hurry(false);
        self.lock().run = Some((run, sender));
        receiver
    }

    pub fn run_is_over(&self) {
        self.lock().run = None;
    }

    /// Returns whether a run received the demand.
    pub fn control(&self, demand: Demand) -> bool {
        if !matches!(demand.control, Control::Pause | Control::Resume) {
            self.outbox.set_hurry(true);
        }
        self.lock().run.as_ref().is_some_and(|(_, run)| run.send(demand).is_ok())
    }

    /// Storage is lost: ends the active run, and no other run starts.
    pub fn server_is_gone(&self) {
        self.lock().server_is_gone = true;
        self.control(Control::StorageLost.into());
    }

    pub fn is_alone(&self) -> bool {
        self.lock().server_is_gone
    }

    /// Reports a change of the mock bench's simulated full disk.
    pub fn report_disk(&self, mock: Option<&MockBench>) {
        let full = mock.is_some_and(MockBench::disk_is_full);
        if self.disk_is_full.swap(full, Ordering::AcqRel) != full {
            self.outbox.send(Report::DiskFull(full));
        }
    }

    /// Reports the exchanges since the last call.
    pub fn report_latency(&self, links: &[(String, Arc<LatencyCounter>)]) {
        let taken = links.iter().map(|(instrument, counter)| (instrument, counter.take()));
        let used = taken.filter(|(_, latency)| latency.count() > 0);
        let used: Vec<_> = used.map(|(instrument, latency)| (instrument.clone(), latency)).collect();
        if !used.is_empty() {
            self.outbox.send(Report::LinkLatency(used));
        }
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
