//! The thread that owns a bench. It executes commands in sequence; a run is one command.

use super::Command;
use super::recorder::OutboxRecorder;
use super::worker_state::WorkerState;
use crate::bench::health::expected;
use crate::bench::instruments::{Opened, open, unreached};
use crate::bench::wire::{MemoryRead, Report};
use crate::config::BenchDescription;
use crate::view;
use jointbench_instrument::Fault;
use jointbench_instrument::roles::Instrument;
use jointbench_procedure::{Demand, Plan, RunId, Safe};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::Duration;

/// Step of a mock bench's clock between runs: a simulated fault may end.
const IDLE_EVERY: Duration = Duration::from_secs(1);

pub(super) struct Owner {
    description: BenchDescription,
    worker: Arc<WorkerState>,
    opened: Opened,
}

impl Owner {
    pub fn new(description: BenchDescription, worker: Arc<WorkerState>) -> Self {
        let opened = open(&description);
        Self { description, worker, opened }
    }

    pub fn serve(mut self, commands: &Receiver<Command>) {
        self.report_opened();
        // An earlier worker may have been killed: the state of the bench is unknown until it is secured.
        self.secure();
        loop {
            self.worker.report_latency(&self.opened.links);
            match commands.recv_timeout(IDLE_EVERY) {
                Ok(Command::Run { run, plan, controls }) => self.run(run, &plan, &controls),
                Ok(Command::Secure) => self.secure(),
                Ok(Command::Reopen { wanting, ticket }) => {
                    self.let_time_pass();
                    self.reopen(&wanting);
                    self.worker.outbox.send(Report::Done { ticket });
                }
                Ok(Command::ReadMemory { ranges, ticket }) => {
                    let read = self.read_memory(&ranges);
                    self.worker.outbox.send(Report::Memory { ticket, read });
                }
                Ok(Command::Quit) | Err(RecvTimeoutError::Disconnected) => break,
                Err(RecvTimeoutError::Timeout) if self.worker.outbox.fault().is_some() => self.let_time_pass(),
                Err(RecvTimeoutError::Timeout) => {}
            }
        }
    }

    /// Advances the clock of a mock bench between runs.
    fn let_time_pass(&self) {
        let Some(mock) = &self.opened.mock else { return };
        let clock = mock.clock();
        let pace = self.description.pace().unwrap_or(1.0).max(1.0);
        clock.sleep_until_s(clock.now_s() + pace * IDLE_EVERY.as_secs_f64());
        self.worker.report_disk(Some(mock));
    }

    fn report_opened(&self) {
        for instrument in &self.opened.instruments {
            let (bench, name, port) = (&self.description.name, &instrument.name, &instrument.port);
            match &instrument.fault {
                None => tracing::info!(bench, name, port, driver = instrument.driver, "instrument ready"),
                Some(fault) => tracing::warn!(bench, name, port, fault, "instrument not ready"),
            }
        }
        self.worker.outbox.send(Report::Opened {
            instruments: self.opened.instruments.clone(),
            channels: self.opened.bench.as_ref().map(expected).unwrap_or_default(),
            open: self.opened.bench.is_some(),
        });
    }

    fn reopen(&mut self, wanting: &[String]) {
        if self.opened.bench.is_some() {
            self.recover(wanting);
        } else {
            // The ports of a partly open bench must be closed before they are opened again.
            self.opened = Opened::default();
            self.opened = open(&self.description);
        }
        self.report_opened();
        self.secure();
    }

    /// Reconnects instruments that had a fault in a run.
    fn recover(&mut self, wanting: &[String]) {
        let Opened { bench: Some(bench), instruments, .. } = &mut self.opened else { return };
        for instrument in instruments.iter_mut().filter(|one| wanting.contains(&one.name)) {
            match bench.instrument(&instrument.name).map(Instrument::recover) {
                Some(Ok(identity)) => {
                    (instrument.ready, instrument.identity) = (true, Some(identity.into()));
                    (instrument.fault, instrument.since) = (None, None);
                }
                Some(Err(fault)) => (instrument.ready, instrument.fault) = (false, Some(fault.to_string())),
                None => {}
            }
        }
    }

    /// Reads the memory of the joint's servo. Sends no motion commands.
    fn read_memory(&mut self, ranges: &[(u8, u8)]) -> MemoryRead {
        let Some(bench) = &mut self.opened.bench else { return MemoryRead::Failed("the bench is not open".into()) };
        let Some(memory) = bench.joint.servo_memory() else { return MemoryRead::None };
        let bytes =
            |(first, bytes): &(u8, u8)| (*first..).take(usize::from(*bytes)).map(|at| memory.read_byte(at)).collect();
        let read: Result<Vec<Vec<u8>>, Fault> = ranges.iter().map(bytes).collect();
        read.map_or_else(|fault| MemoryRead::Failed(fault.to_string()), MemoryRead::Read)
    }

    fn run(&mut self, run: RunId, plan: &Plan, controls: &Receiver<Demand>) {
        let Opened { bench: Some(bench), links, mock, .. } = &mut self.opened else {
            // The lab opens a bench before a run. A bench that has disconnected since has no instruments to command.
            tracing::error!(run.id = run, "run started on a bench that is not open");
            return not_begun(&self.worker, run);
        };
        if self.worker.is_alone() {
            return not_begun(&self.worker, run);
        }
        let stepped = self.description.pace().is_none();
        let mut recorder = OutboxRecorder::new(&self.worker, links, mock.as_ref(), stepped, run);
        let end = jointbench_procedure::run(bench, plan, run, controls, &mut recorder);
        self.worker.run_is_over();
        self.worker.outbox.send(Report::Ended { run, end });
    }

    fn secure(&mut self) {
        let report = match &mut self.opened.bench {
            // A disconnected bench is secured when it is opened.
            None => Report::Secured { safe: Safe::UnsafeUnknown, notes: Vec::new() },
            Some(bench) => {
                let secured = jointbench_procedure::secure(bench);
                for note in &secured.notes {
                    tracing::warn!(bench = self.description.name, "{note}");
                }
                Report::Secured { safe: secured.safe, notes: secured.notes }
            }
        };
        self.worker.outbox.send(report);
    }
}

fn not_begun(worker: &WorkerState, run: RunId) {
    worker.run_is_over();
    worker.outbox.send(Report::NotBegun { run });
}

/// Answers for a bench that another worker owns.
pub(super) fn serve_nothing(
    description: &BenchDescription,
    worker: &WorkerState,
    commands: &Receiver<Command>,
    why: &str,
) {
    let say = || {
        let instruments: Vec<view::Instrument> = vec![unreached(description, why.to_owned())];
        worker.outbox.send(Report::Opened { instruments, channels: Vec::new(), open: false });
        worker.outbox.send(Report::Secured { safe: Safe::UnsafeUnknown, notes: Vec::new() });
    };
    say();
    while let Ok(command) = commands.recv() {
        match command {
            Command::Quit => return,
            Command::Reopen { ticket, .. } => {
                say();
                worker.outbox.send(Report::Done { ticket });
            }
            Command::ReadMemory { ticket, .. } => {
                worker.outbox.send(Report::Memory { ticket, read: MemoryRead::Failed(why.to_owned()) });
            }
            Command::Run { run, .. } => not_begun(worker, run),
            Command::Secure => say(),
        }
    }
}
