//! Interface to the recorder of a run: rows and events to store, and the latest rows for display.

use crate::event::Event;
use crate::state::RunState;
use jointbench_instrument::Trace;
use serde::{Deserialize, Serialize};

/// Number of a run in the store.
pub type RunId = i64;

/// Rows, events and state that belong together.
pub struct Commit<'a> {
    /// The run to which the data belongs.
    pub run: RunId,
    /// State of the run after this commit.
    pub state: RunState,
    /// In chronological order.
    pub events: &'a [Event],
    /// May be empty. Every commit with rows has the same channels in the same order; before arming there are none.
    pub rows: Trace,
}

/// Best effort: live data may be lost.
pub struct Live<'a> {
    /// The run to which the data belongs.
    pub run: RunId,
    /// Present state of the run.
    pub state: RunState,
    /// The rows since the last call. Rows of a pause are shown here and not kept.
    pub rows: &'a Trace,
    /// Finished steps and estimated time.
    pub progress: &'a Progress,
}

/// Accepts the data of a run and makes it durable. It is called on the thread that owns the bench, between two
/// commands to a turning drive. It must not wait for a disk or another process.
pub trait Recorder {
    /// Why the bench must not move until a person has acknowledged it. Called once, before any command.
    fn blocked(&mut self) -> Result<Option<String>, RecorderFault>;

    /// Accepts state, events and rows. They become durable together, in one transaction, or not at all, after all
    /// earlier commits. A fault ends the run and states what is not stored.
    fn commit(&mut self, commit: Commit<'_>) -> Result<(), RecorderFault>;

    /// Shows rows and progress. Called often; must not wait.
    fn live(&mut self, live: Live<'_>);
}

/// Data that cannot be stored.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("the run cannot be recorded: {0}")]
pub struct RecorderFault(pub String);

/// Progress of a run.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Progress {
    /// Finished steps.
    pub step: usize,
    /// Number of steps of the plan.
    pub steps: usize,
    /// The present step.
    pub label: String,
    /// On the bench's clock, including pauses.
    pub elapsed_s: f64,
    /// From the plan, corrected by the actual durations of the finished steps.
    pub remaining_s: f64,
    /// The run warms the joint up until it is steady, in at most this time.
    #[serde(default)]
    pub at_most: bool,
}
