//! Server thread that starts a worker, processes its reports, and restarts it after a crash.

use super::display::Display;
use super::instruments::unreached;
use super::item::Item;
use super::keeper::NEVER_BEGAN;
use super::shared::{Shared, lock};
use super::status::{ActiveRun, FAULTS, NewFault, RunFault, Status};
use super::wire::{self, Entry, Order, Report, Setup};
use crate::store::SafetyRecord;
use crate::view::{self, BenchState, InstrumentFault, LiveMessage};
use jiff::Timestamp;
use jointbench_procedure::{Event, EventKind, RunEnd, RunId, RunState, Safe};
use std::io::{self, BufReader};
use std::process::{Child, ChildStdout, Stdio};
use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};
use tokio::sync::oneshot;

const DAEMON_ENDED: &str = "the daemon terminated during the run; its stored samples are kept";
const WORKER_ENDED: &str = "the bench worker terminated during the run; samples that were not stored yet are lost";
/// At its end, a daemon waits this long for the store to accept the remaining data.
const DRAINED: Duration = Duration::from_secs(5);
/// Waiting time for a worker that has secured its bench.
const GONE: Duration = Duration::from_secs(20);
const SOONEST: Duration = Duration::from_millis(200);
const LATEST: Duration = Duration::from_secs(10);
const POLL_INTERVAL: Duration = Duration::from_millis(20);
/// A worker with this lifetime did not fail at its start.
const LIVED: Duration = Duration::from_secs(60);

pub(super) struct Supervisor {
    shared: Arc<Shared>,
    display: Arc<Mutex<Option<Display>>>,
    /// Runs without a worker whose safe state is unknown.
    orphans: Vec<(RunId, &'static str)>,
}

impl Supervisor {
    /// `interrupted`: the runs that an earlier daemon left open on this bench.
    pub fn new(shared: Arc<Shared>, display: Arc<Mutex<Option<Display>>>, interrupted: Vec<RunId>) -> Self {
        shared.status.send_modify(|status| {
            status.runs = interrupted.iter().map(|run| (*run, ActiveRun::queued())).collect();
        });
        Self { shared, display, orphans: interrupted.into_iter().map(|run| (run, DAEMON_ENDED)).collect() }
    }

    /// Returns when the daemon ends.
    pub fn supervise(mut self) {
        let mut pause = SOONEST;
        loop {
            let started = Instant::now();
            match self.start() {
                Ok((mut child, reports)) => {
                    let finished = self.read_reports(reports);
                    if finished {
                        self.drain();
                    }
                    self.shared.set_worker(None);
                    let how = wait(&mut child);
                    self.worker_is_gone(finished, &how);
                }
                Err(fault) => self.report_unreachable(format!("the bench worker cannot be started: {fault}")),
            }
            pause = if started.elapsed() > LIVED { SOONEST } else { (2 * pause).min(LATEST) };
            if !self.wait(pause) {
                return;
            }
        }
    }

    /// Waits before a restart. Returns `false` if the daemon ends.
    fn wait(&self, pause: Duration) -> bool {
        let over = Instant::now() + pause;
        let is_ending = || self.shared.ending.load(Ordering::Acquire);
        while !is_ending() && Instant::now() < over {
            std::thread::sleep(POLL_INTERVAL.min(pause));
        }
        !is_ending()
    }

    fn start(&self) -> io::Result<(Child, ChildStdout)> {
        let shared = &self.shared;
        let mut command = crate::program::part(&shared.program, "worker");
        command.stdin(Stdio::piped()).stdout(Stdio::piped());
        #[cfg(unix)]
        {
            // Ctrl-C in a terminal is only for the server, which ends its workers in order.
            use std::os::unix::process::CommandExt;
            command.process_group(0);
        }
        let mut child = command.spawn()?;
        let (orders, reports) = child.stdin.take().zip(child.stdout.take()).ok_or(io::ErrorKind::BrokenPipe)?;
        shared.set_worker(Some(orders));
        let block = shared.status.borrow().blocked.as_ref().map(record);
        let setup = Setup { description: shared.description.clone(), data: shared.data.clone(), block };
        let opened = shared.order(&Order::Open(Box::new(setup)));
        opened.map_err(|_| io::Error::other("it ends at once"))?;
        // A worker that starts during the end of the daemon may have missed the order to quit.
        if shared.ending.load(Ordering::Acquire) {
            shared.order(&Order::Quit).map_err(|_| io::Error::other("it ends at once"))?;
        }
        tracing::info!(bench = shared.name(), process = child.id(), "bench worker started");
        Ok((child, reports))
    }

    /// Processes all reports. Returns whether the worker ended in order.
    fn read_reports(&mut self, reports: ChildStdout) -> bool {
        let mut reports = BufReader::new(reports);
        loop {
            match wire::receive(&mut reports) {
                Ok(Some(Report::Finished)) => return true,
                Ok(Some(report)) => self.handle(report),
                Ok(None) => return false,
                Err(fault) => {
                    tracing::error!(bench = self.shared.name(), %fault, "a report of the worker cannot be read");
                    return false;
                }
            }
        }
    }

    fn handle(&mut self, report: Report) {
        let shared = &self.shared;
        match report {
            Report::Opened { instruments, channels, open } => self.opened(instruments, channels, open),
            Report::Secured { safe, notes } => self.secured(safe, &notes),
            Report::Done { ticket } => shared.done(ticket, None),
            Report::Memory { ticket, read } => shared.done(ticket, Some(read)),
            Report::Entry(entry) => self.entry(entry),
            Report::Live { run, rows, progress, .. } => {
                if let Some(display) = lock(&self.display).as_mut() {
                    display.show(shared, run, rows, &progress);
                }
            }
            Report::Ended { run, end } => self.ended(run, &end),
            Report::NotBegun { run } => {
                shared.change(Status::set_idle);
                self.enqueue(Item::Interrupted { run, safe: Safe::SafeCommanded, reason: NEVER_BEGAN });
            }
            Report::DiskFull(full) => {
                shared.disk_is_full.store(full, Ordering::Release);
                shared.disk_changed.notify_one();
            }
            Report::LinkLatency(latencies) => {
                let mut totals = lock(&shared.link_latency);
                latencies.into_iter().for_each(|(name, more)| *totals.entry(name).or_default() += more);
            }
            Report::Finished => {}
        }
    }

    fn opened(&self, mut instruments: Vec<view::Instrument>, channels: Vec<super::health::ChannelInput>, open: bool) {
        for instrument in &mut instruments {
            instrument.faults = self.known_faults(&instrument.name);
        }
        let new = self.shared.change(|status| {
            if status.channels.is_empty() {
                status.channels = channels;
            }
            status.open = open;
            status.found(instruments)
        });
        self.keep_faults(new);
    }

    fn secured(&mut self, safe: Safe, notes: &[String]) {
        let open = self.shared.status.borrow().open;
        if open && safe == Safe::UnsafeUnknown {
            self.block_as_unsafe(&notes.join("; "), None);
        } else if !open && !self.orphans.is_empty() {
            self.block_as_unsafe("a run was interrupted and the instruments do not answer", None);
        }
        for (run, reason) in std::mem::take(&mut self.orphans) {
            tracing::warn!(run.id = run, bench = self.shared.name(), %safe, "run was interrupted, the bench is now in its safe state");
            self.enqueue(Item::Interrupted { run, safe, reason });
        }
        self.shared.change(|status| {
            status.settled = true;
            if status.run.is_none() {
                status.set_idle();
            }
        });
    }

    fn entry(&self, entry: Arc<Entry>) {
        let shared = &self.shared;
        let commit = &entry.commit;
        let new: Vec<NewFault> = shared.change(|status| {
            let active = status.runs.entry(commit.run).or_insert_with(ActiveRun::queued);
            let before = active.state;
            active.apply(commit);
            status.unstored.rows += commit.rows.len();
            status.unstored.since.get_or_insert_with(Timestamp::now);
            if before != commit.state && !commit.state.is_final() {
                status.run = Some(commit.run);
                status.state = bench_state(commit.state);
            }
            let faults = commit.events.iter().filter_map(|event| run_fault(&event.kind));
            faults.filter_map(|fault| status.record_fault(&fault)).collect()
        });
        self.keep_faults(new);
        shared.late_ticks.inc_by(late_ticks(&commit.events));
        if !commit.state.is_final() && commit.events.iter().any(|event| matches!(event.kind, EventKind::State { .. })) {
            // The keeper publishes the end with its reason when it is stored.
            shared.hub.publish(LiveMessage::State {
                bench: shared.name().to_owned(),
                run: commit.run,
                state: commit.state,
                safe: None,
                reason: None,
            });
        }
        self.enqueue(Item::Entry(entry));
    }

    fn ended(&self, run: RunId, end: &RunEnd) {
        if end.safe == Safe::UnsafeUnknown {
            self.block_as_unsafe(end.reason.as_deref().unwrap_or_default(), Some(run));
        }
        lock(&self.display).take();
        self.shared.change(|status| status.set_idle());
        self.shared.settle(run, |active| active.ended = true);
    }

    fn block_as_unsafe(&self, reason: &str, run: Option<RunId>) {
        let reason = if reason.is_empty() { "cause unknown" } else { reason };
        let reason = format!("safe state not confirmed: {reason}");
        self.shared.enter(self.shared.new_block(false, &reason, run, None));
    }

    /// Faults of an instrument before the start of the daemon.
    fn known_faults(&self, instrument: &str) -> Vec<InstrumentFault> {
        let shared = &self.shared;
        let known = shared.runtime.block_on(shared.store.faults(shared.name(), instrument, FAULTS as u32));
        let known = known.inspect_err(|fault| tracing::error!(instrument, %fault, "earlier faults cannot be read"));
        known.unwrap_or_default().into_iter().map(|(at, text)| InstrumentFault { at, text }).collect()
    }

    fn keep_faults(&self, new: Vec<NewFault>) {
        new.into_iter().for_each(|new| self.enqueue(Item::Fault(new)));
    }

    fn enqueue(&self, item: Item) {
        if self.shared.to_keep.send(item).is_err() {
            tracing::error!(bench = self.shared.name(), "the storage thread has ended");
        }
    }

    /// Waits until the store has the data of the worker. On a timeout the worker writes the rest to the data folder.
    fn drain(&self) {
        let (done, stored) = oneshot::channel();
        self.enqueue(Item::Flush(done));
        let stored = self.shared.runtime.block_on(async { tokio::time::timeout(DRAINED, stored).await });
        if stored.is_err() {
            tracing::warn!(
                bench = self.shared.name(),
                "the store does not accept the remaining records: the worker \
                                                        writes them to the data folder"
            );
        }
    }

    /// Marks the bench as unreachable: its state is unknown until another worker has secured it.
    fn worker_is_gone(&mut self, finished: bool, how: &str) {
        let ending = self.shared.ending.load(Ordering::Acquire);
        if finished && ending {
            return;
        }
        tracing::error!(bench = self.shared.name(), how, "the bench worker has terminated");
        let open: Vec<RunId> = {
            let status = self.shared.status.borrow();
            let lost = status.runs.iter().filter(|(_, run)| !run.ended);
            lost.map(|(run, _)| *run).collect()
        };
        for run in open {
            let is_over = self.shared.status.borrow().runs.get(&run).is_some_and(|run| run.state.is_final());
            if is_over {
                // The last commit of the run has arrived.
                self.shared.settle(run, |run| run.ended = true);
            } else {
                self.orphans.push((run, WORKER_ENDED));
            }
        }
        self.report_unreachable(format!("the bench worker terminated ({how}); it is restarted and secures the bench"));
    }

    fn report_unreachable(&self, why: String) {
        let instruments = vec![unreached(&self.shared.description, why)];
        let new = self.shared.change(|status| {
            status.open = false;
            let new = status.found(instruments);
            status.set_idle();
            new
        });
        self.keep_faults(new);
    }
}

fn bench_state(run: RunState) -> BenchState {
    match run {
        RunState::Paused => BenchState::Paused,
        RunState::Securing => BenchState::Securing,
        _ => BenchState::Running,
    }
}

fn run_fault(event: &EventKind) -> Option<RunFault> {
    match event {
        EventKind::Fault { fault, recovered } => {
            Some(RunFault { at: Timestamp::now(), fault: fault.clone(), recovered: *recovered })
        }
        _ => None,
    }
}

fn record(blocked: &view::Blocked) -> SafetyRecord {
    let view::Blocked { stopped, reason, by, since, .. } = blocked.clone();
    SafetyRecord { blocked: true, stopped, reason, run: None, by, at: since }
}

/// Waits for the end of a worker and kills it after a timeout.
fn wait(child: &mut Child) -> String {
    let give_up = Instant::now() + GONE;
    loop {
        match child.try_wait() {
            Ok(Some(status)) => return status.to_string(),
            Ok(None) if Instant::now() < give_up => {}
            Ok(None) => {
                tracing::error!(process = child.id(), "the bench worker does not end and is killed");
                // An error means that it has already ended.
                let _ = child.kill();
            }
            Err(fault) => return fault.to_string(),
        }
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// Late ticks of the steps that finished.
fn late_ticks(events: &[Event]) -> u64 {
    let late = |event: &Event| match event.kind {
        EventKind::StepFinished { late_ticks, .. } => late_ticks,
        _ => 0,
    };
    events.iter().map(late).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn late_ticks_of_all_finished_steps_count() {
        let finished = |late_ticks| EventKind::StepFinished { step: 0, segment: 0, rows: 9, late_ticks };
        let note = EventKind::Note { text: String::new() };
        let events = [finished(2), note, finished(3)].map(|kind| Event { at_s: 0.0, kind });
        assert_eq!(late_ticks(&events), 5);
    }
}
