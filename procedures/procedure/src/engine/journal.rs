//! Data that is not yet committed: rows and events since the last commit, in order.

use super::ending::Ending;
use crate::event::{Event, EventKind};
use crate::recorder::{Commit, Live, Progress, Recorder, RecorderFault, RunId};
use crate::state::{RunState, Transition};
use jointbench_instrument::Trace;

/// Longest bench time between two commits.
const COMMIT_EVERY_S: f64 = 2.0;
/// Period of live updates: 30 frames in a second.
const LIVE_EVERY_S: f64 = 1.0 / 30.0;

pub(super) struct Journal<'a> {
    pub run: RunId,
    /// Bench time of the run's zero.
    pub started_s: f64,
    pub kept_rows: u64,
    recorder: &'a mut dyn Recorder,
    state: RunState,
    events: Vec<Event>,
    rows: Trace,
    newest: Trace,
    committed_s: f64,
    shown_s: f64,
}

impl<'a> Journal<'a> {
    pub fn new(run: RunId, started_s: f64, recorder: &'a mut dyn Recorder) -> Self {
        Self {
            run,
            started_s,
            kept_rows: 0,
            recorder,
            state: RunState::Queued,
            events: Vec::new(),
            rows: Trace::default(),
            newest: Trace::default(),
            committed_s: started_s,
            shown_s: started_s,
        }
    }

    pub fn state(&self) -> RunState {
        self.state
    }

    pub fn blocked(&mut self) -> Result<Option<String>, RecorderFault> {
        self.recorder.blocked()
    }

    /// Sets the columns before the first row.
    pub fn set_columns(&mut self, empty: Trace) {
        self.newest = empty.clone();
        self.rows = empty;
    }

    pub fn log(&mut self, now_s: f64, kind: impl Into<Option<EventKind>>) {
        if let Some(kind) = kind.into() {
            self.events.push(Event { at_s: now_s - self.started_s, kind });
        }
    }

    /// The only function that changes the state of a run.
    pub fn enter(&mut self, now_s: f64, transition: Transition, reason: Option<String>) -> Result<(), Ending> {
        self.state = self.state.after(transition).map_err(Ending::Illegal)?;
        tracing::info!(run.id = self.run, state = %self.state, "run state");
        self.log(now_s, EventKind::State { state: self.state, reason });
        Ok(self.commit(now_s)?)
    }

    /// Rows that are kept or pending.
    pub fn rows(&self) -> u64 {
        self.kept_rows + self.rows.len() as u64
    }

    pub fn keep(&mut self, row: &[f64]) {
        self.rows.push_row(row);
    }

    pub fn show(&mut self, now_s: f64, row: &[f64], progress: impl FnOnce() -> Progress) {
        self.newest.push_row(row);
        if now_s - self.shown_s >= LIVE_EVERY_S {
            self.shown_s = now_s;
            let live = Live { run: self.run, state: self.state, rows: &self.newest, progress: &progress() };
            self.recorder.live(live);
            self.newest.take();
        }
    }

    pub fn commit_if_due(&mut self, now_s: f64) -> Result<(), RecorderFault> {
        let waiting = !self.rows.is_empty() || !self.events.is_empty();
        if waiting && now_s - self.committed_s >= COMMIT_EVERY_S { self.commit(now_s) } else { Ok(()) }
    }

    pub fn commit(&mut self, now_s: f64) -> Result<(), RecorderFault> {
        let rows = self.rows.take();
        let count = rows.len() as u64;
        self.committed_s = now_s;
        self.recorder.commit(Commit { run: self.run, state: self.state, events: &self.events, rows })?;
        self.kept_rows += count;
        self.events.clear();
        Ok(())
    }
}
