//! What the engine hands over: rows and events to keep, the newest rows to look at.

use crate::event::Event;
use crate::state::RunState;
use jointbench_instrument::Trace;
use serde::{Deserialize, Serialize};

pub type RunId = i64;

/// Rows, events and state that belong together.
pub struct Commit<'a> {
    pub run: RunId,
    pub state: RunState,
    /// In the order of their happening.
    pub events: &'a [Event],
    /// May be empty. Every commit with rows has the same channels in the same order; before arming there are none.
    pub rows: Trace,
}

/// Best effort: nothing of this has to arrive.
pub struct Live<'a> {
    pub run: RunId,
    pub state: RunState,
    /// The rows since the last call. Rows of a pause are shown here and not kept.
    pub rows: &'a Trace,
    pub progress: &'a Progress,
}

/// Takes what a run brings, and sees to it that it becomes durable. Called on the thread that owns the bench, between two
/// commands to a drive that turns: nothing here may wait for a disk or for another process.
pub trait Recorder {
    /// Why the bench must not move until a person has acknowledged it. Asked once, before anything is commanded.
    fn blocked(&mut self) -> Result<Option<String>, RecorderFault>;

    /// Takes state, events and rows over: they become durable together, in one transaction, or not at all, behind all that
    /// was taken before. A fault ends the run; it says what is not kept.
    fn commit(&mut self, commit: Commit<'_>) -> Result<(), RecorderFault>;

    fn live(&mut self, live: Live<'_>);
}

/// What is handed over cannot be kept.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("the run cannot be recorded: {0}")]
pub struct RecorderFault(pub String);

/// Where a run is.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Progress {
    /// Steps done.
    pub step: usize,
    pub steps: usize,
    /// What is done now.
    pub label: String,
    /// On the bench's clock, pauses included.
    pub elapsed_s: f64,
    /// From the plan, corrected by how long the steps so far really took.
    pub remaining_s: f64,
    /// The run warms the joint up until it is steady, and takes no longer than this.
    #[serde(default)]
    pub at_most: bool,
}
