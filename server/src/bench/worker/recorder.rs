//! Passes the data of a run to the outbox. It waits only if the bench clock is stepped.

use super::outbox::MOST_BYTES;
use super::worker_state::WorkerState;
use crate::bench::wire::Report;
use crate::store::RunCommit;
use jointbench_devices::MockBench;
use jointbench_instrument::LatencyCounter;
use jointbench_procedure::{Commit, Live, Recorder, RecorderFault, RunId};
use std::sync::Arc;

pub(super) struct OutboxRecorder<'a> {
    worker: &'a WorkerState,
    links: &'a [(String, Arc<LatencyCounter>)],
    /// Its simulated full disk applies to the store.
    mock: Option<&'a MockBench>,
    /// The bench clock is stepped: its time does not advance during a wait.
    stepped: bool,
    run: RunId,
    commits: u64,
    /// Rows that did not fit into the queue.
    dropped: usize,
}

impl<'a> OutboxRecorder<'a> {
    pub fn new(
        worker: &'a WorkerState,
        links: &'a [(String, Arc<LatencyCounter>)],
        mock: Option<&'a MockBench>,
        stepped: bool,
        run: RunId,
    ) -> Self {
        Self { worker, links, mock, stepped, run, commits: 0, dropped: 0 }
    }
}

impl Recorder for OutboxRecorder<'_> {
    fn blocked(&mut self) -> Result<Option<String>, RecorderFault> {
        Ok(self.worker.block().map(|block| block.reason))
    }

    fn commit(&mut self, commit: Commit<'_>) -> Result<(), RecorderFault> {
        let Commit { state, events, mut rows, .. } = commit;
        let outbox = &self.worker.outbox;
        self.worker.report_disk(self.mock);
        self.worker.report_latency(self.links);
        let backlog = outbox.backlog();
        let is_full = backlog.bytes >= MOST_BYTES;
        if is_full {
            // States and events are still stored: they are small.
            self.dropped += rows.take().len();
        }
        self.commits += 1;
        outbox.keep(RunCommit { run: self.run, number: self.commits, state, events: events.to_vec(), rows });
        if self.stepped {
            outbox.let_the_store_catch_up();
        }
        match outbox.fault() {
            Some(fault) => Err(RecorderFault(format!(
                "{fault}; {} rows are buffered in memory and stored as soon as possible",
                outbox.backlog().rows
            ))),
            None if is_full => Err(RecorderFault(format!(
                "the disk is too slow: {} rows buffered (maximum), {} rows lost",
                backlog.rows, self.dropped
            ))),
            None => Ok(()),
        }
    }

    fn live(&mut self, live: Live<'_>) {
        let Live { run, state, rows, progress } = live;
        self.worker.outbox.send(Report::Live { run, state, rows: rows.clone(), progress: progress.clone() });
    }
}
