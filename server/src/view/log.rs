//! The event log.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// One line of the log.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, ToSchema)]
pub struct LogEntry {
    /// Wall-clock time. A mock bench without a pace runs ahead of it; its events are dated at the end of the run at the
    /// latest.
    #[schema(format = DateTime)]
    pub at: String,
    /// `stopped`, `blocked`, `reset` or `calibration` of a bench; `started`, `imported`, `user_note` or `model` of a run;
    /// the kind of an entry of the run's journal; `token`.
    pub kind: String,
    /// One sentence; the text of a note, which may have several lines.
    pub text: String,
    /// Who did it: name of the token, or `local`.
    pub by: Option<String>,
    pub bench: Option<String>,
    pub run: Option<i64>,
    /// Of the run.
    pub procedure: Option<String>,
    /// The created version.
    pub model: Option<i64>,
    /// The note.
    pub note: Option<i64>,
    /// Number in the journal of the run.
    pub sequence: Option<u64>,
    /// Since the start of the run, on the bench's clock; of a note the moment that it is about, if it has one.
    pub at_s: Option<f64>,
    /// A stop, a fault or an exceeded limit.
    pub grave: bool,
}
