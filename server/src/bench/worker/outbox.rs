//! Bounded queue between control and storage: reports to send, and entries that are not yet durable. The thread that
//! owns the bench only adds to it.

use crate::bench::wire::{self, Entry, Report};
use crate::store::RunCommit;
use std::collections::VecDeque;
use std::io::Write;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;

/// Limit of unstored data: eight minutes of 17 channels at 1 kHz.
pub const MOST_BYTES: usize = 64 << 20;
/// Limit of waiting live data: old live data is useless.
const MOST_LIVE: usize = 64;

pub struct Outbox {
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Default)]
struct State {
    /// Unsent reports in order.
    unsent: VecDeque<Report>,
    /// Entries that are not durable, sent or not.
    unstored: VecDeque<Arc<Entry>>,
    unstored_bytes: usize,
    last_number: u64,
    /// The storage fault.
    fault: Option<String>,
    /// The active run shall end: do not wait for the store.
    hurry: bool,
    closed: bool,
}

/// Data of a run that is not yet stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Backlog {
    pub rows: usize,
    pub bytes: usize,
}

impl Outbox {
    /// Starts the thread that sends the reports.
    pub fn start(to: impl Write + Send + 'static) -> std::io::Result<(Arc<Self>, JoinHandle<()>)> {
        let outbox = Arc::new(Self { state: Mutex::default(), changed: Condvar::new() });
        let sender = outbox.clone();
        let thread = std::thread::Builder::new().name("reports".into()).spawn(move || sender.send_all(to))?;
        Ok((outbox, thread))
    }

    pub fn send(&self, report: Report) {
        let mut state = self.lock();
        if matches!(report, Report::Live { .. })
            && state.unsent.iter().filter(|waiting| matches!(waiting, Report::Live { .. })).count() >= MOST_LIVE
        {
            return;
        }
        state.unsent.push_back(report);
        self.changed.notify_all();
    }

    /// Adds a commit to store. Never blocks.
    pub fn keep(&self, commit: RunCommit) {
        let mut inner = self.lock();
        inner.last_number += 1;
        let entry = Arc::new(Entry { number: inner.last_number, commit });
        inner.unstored_bytes += bytes(&entry);
        inner.unstored.push_back(entry.clone());
        inner.unsent.push_back(Report::Entry(entry));
        self.changed.notify_all();
    }

    pub fn backlog(&self) -> Backlog {
        let state = self.lock();
        Backlog { rows: state.unstored.iter().map(|entry| entry.commit.rows.len()).sum(), bytes: state.unstored_bytes }
    }

    /// Removes the entries up to this number, which are durable.
    pub fn stored(&self, number: u64) {
        let mut state = self.lock();
        while state.unstored.front().is_some_and(|entry| entry.number <= number) {
            let entry = state.unstored.pop_front();
            state.unstored_bytes -= entry.map_or(0, |entry| bytes(&entry));
        }
        self.changed.notify_all();
    }

    pub fn set_fault(&self, fault: Option<String>) {
        self.lock().fault = fault;
        self.changed.notify_all();
    }

    pub fn fault(&self) -> Option<String> {
        self.lock().fault.clone()
    }

    /// Sets whether the active run shall end; if so, no thread waits for the store.
    pub fn set_hurry(&self, hurry: bool) {
        self.lock().hurry = hurry;
        self.changed.notify_all();
    }

    /// For a stepped bench clock: returns when all entries are stored, or when the run shall end.
    pub fn let_the_store_catch_up(&self) {
        let far_ahead =
            |state: &mut State| !state.unstored.is_empty() && !state.hurry && state.fault.is_none() && !state.closed;
        drop(self.changed.wait_while(self.lock(), far_ahead).unwrap_or_else(PoisonError::into_inner));
    }

    /// Sends the waiting reports, then ends.
    pub fn close(&self) {
        self.lock().closed = true;
        self.changed.notify_all();
    }

    /// Entries that are not stored.
    pub fn unstored(&self) -> Vec<Arc<Entry>> {
        self.lock().unstored.iter().cloned().collect()
    }

    fn send_all(&self, mut to: impl Write) {
        loop {
            let idle = |state: &mut State| state.unsent.is_empty() && !state.closed;
            let mut state = self.changed.wait_while(self.lock(), idle).unwrap_or_else(PoisonError::into_inner);
            let Some(report) = state.unsent.pop_front() else { return };
            drop(state);
            if let Err(fault) = wire::send(&mut to, &report) {
                tracing::error!(%fault, "the server process of the daemon does not respond");
                return;
            }
        }
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Size in memory, and approximate size of the message.
fn bytes(entry: &Entry) -> usize {
    let rows = &entry.commit.rows;
    rows.len() * rows.channels().len() * size_of::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;
    use jointbench_instrument::{Channel, Trace};
    use jointbench_procedure::RunState;
    use std::sync::mpsc;
    use std::time::Duration;

    fn commit(number: u64, rows: usize) -> RunCommit {
        let rows = Trace::from_columns(vec![Channel::new("time_s")], vec![vec![0.0; rows]]);
        RunCommit { run: 1, number, state: RunState::Running, events: Vec::new(), rows }
    }

    #[test]
    fn what_is_stored_leaves_and_the_rest_is_known() {
        let (outbox, reports) = Outbox::start(std::io::sink()).unwrap();
        (1..=3).for_each(|number| outbox.keep(commit(number, 100)));
        assert_eq!(outbox.backlog(), Backlog { rows: 300, bytes: 2400 });
        outbox.stored(2);
        assert_eq!(outbox.backlog(), Backlog { rows: 100, bytes: 800 });
        assert_eq!(outbox.unstored().iter().map(|entry| entry.commit.number).collect::<Vec<_>>(), [3]);
        outbox.close();
        reports.join().unwrap();
    }

    #[test]
    fn an_ending_run_does_not_wait_for_the_store() {
        let (outbox, reports) = Outbox::start(std::io::sink()).unwrap();
        outbox.keep(commit(1, 100));
        let (done, waits) = mpsc::channel();
        let waiting = outbox.clone();
        let thread = std::thread::spawn(move || {
            for _ in 0..3 {
                waiting.let_the_store_catch_up();
            }
            done.send(()).unwrap();
        });
        assert!(waits.recv_timeout(Duration::from_millis(50)).is_err(), "the store has nothing yet");
        outbox.set_hurry(true);
        waits.recv_timeout(Duration::from_secs(10)).unwrap();
        outbox.close();
        thread.join().unwrap();
        reports.join().unwrap();
    }
}
