//! Input and output types of the store.

use super::{Order, Unit};
use jointbench_instrument::Channel;
use jointbench_procedure::{RunId, RunState, Safe};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use utoipa::ToSchema;

/// A new run.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct NewRun {
    pub bench: String,
    /// The procedure's id; `import` for an imported file.
    pub procedure: String,
    pub kind: String,
    pub simulated: bool,
    pub parameters: Map<String, Value>,
    /// Bench description, calibration, software version, mock or hardware, seed.
    pub provenance: Map<String, Value>,
    /// Metadata of the test conditions, as in `meta.json`.
    pub meta: Map<String, Value>,
    pub unit: Option<Unit>,
    /// The person who started the run, as entered.
    pub operator: Option<String>,
}

#[derive(Debug, Clone, PartialEq)]
pub struct RunRecord {
    pub id: RunId,
    pub bench: String,
    pub procedure: String,
    pub kind: String,
    pub simulated: bool,
    pub state: RunState,
    pub safe: Option<Safe>,
    pub reason: Option<String>,
    /// Times are RFC 3339 in UTC.
    pub created_at: String,
    pub started_at: Option<String>,
    pub finished_at: Option<String>,
    pub rows: u64,
    /// From the first sample to the last.
    pub duration_s: Option<f64>,
    pub parameters: Map<String, Value>,
    pub provenance: Map<String, Value>,
    pub meta: Map<String, Value>,
    pub unit: Option<Unit>,
    pub operator: Option<String>,
    /// Empty before the first commit with rows.
    pub channels: Vec<Channel>,
    pub tags: Vec<String>,
    /// The last note.
    pub note: Option<String>,
    /// Verdict of the procedure, if it was computed.
    pub verdict: Option<String>,
    /// Outcome of its limits, computed with the verdict.
    pub limits: Option<String>,
    /// Values of the last model version, as in the list of runs.
    pub model: Option<Value>,
    /// Damage of the record, in a list. The other fields hold the readable data.
    pub damaged: Option<String>,
}

impl RunRecord {
    /// For a run of which only the id is readable.
    pub(super) fn unreadable(id: RunId, damaged: String) -> Self {
        RunRecord {
            id,
            bench: String::new(),
            procedure: String::new(),
            kind: String::new(),
            simulated: false,
            state: RunState::Interrupted,
            safe: None,
            reason: None,
            created_at: String::new(),
            started_at: None,
            finished_at: None,
            rows: 0,
            duration_s: None,
            parameters: Map::new(),
            provenance: Map::new(),
            meta: Map::new(),
            unit: None,
            operator: None,
            channels: Vec::new(),
            tags: Vec::new(),
            note: None,
            verdict: None,
            limits: None,
            model: None,
            damaged: Some(damaged),
        }
    }
}

/// Which runs to list.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct RunFilter {
    pub limit: u32,
    pub offset: u32,
    /// Query in the language of [`super::search`]; not case-sensitive.
    pub search: Option<String>,
    pub order: Order,
}

/// A run of a unit, for the list of units.
#[derive(Debug, Clone, PartialEq)]
pub struct UnitRunRecord {
    pub run: RunId,
    pub unit: Unit,
    pub procedure: String,
    pub state: RunState,
    pub created_at: String,
    pub verdict: Option<String>,
    /// Outcome of its limits.
    pub limits: Option<String>,
    /// The unit is a reference, which statistics exclude.
    pub is_reference: bool,
}

/// A note on a run.
#[derive(Debug, Clone, PartialEq)]
pub struct NoteRecord {
    pub id: i64,
    /// Time on the run's clock.
    pub at_s: Option<f64>,
    pub text: String,
    pub created_at: String,
}

/// One entry of a run's journal.
#[derive(Debug, Clone, PartialEq)]
pub struct EventRecord {
    /// Starts at 1, without gaps.
    pub sequence: u64,
    pub at_s: f64,
    pub kind: String,
    pub data: Map<String, Value>,
}

/// One version of an effect that a user wrote.
#[derive(Debug, Clone, PartialEq)]
pub struct UserEffectRecord {
    pub kind: String,
    pub effect: String,
    /// Starts at 1.
    pub version: i64,
    pub definition: Value,
    pub created_at: String,
}

/// A user's effect that the diagnosis of a run may suggest.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct EffectUse {
    pub run: RunId,
    pub kind: String,
    pub effect: String,
}

/// A fit to be stored as a version.
#[derive(Debug, Clone, PartialEq)]
pub struct NewModel {
    pub run: RunId,
    /// Further runs of the same joint in the fit, in order.
    pub more_runs: Vec<RunId>,
    /// Sections that are excluded from the fit.
    pub excluded: Value,
    pub parent: Option<i64>,
    pub kind: String,
    pub effects: Vec<String>,
    pub fit: Value,
    /// `raw` or `plateau_mean`.
    pub residual: String,
    pub rms: f64,
    pub validation_rms: f64,
    pub noise_floor_rms: Option<f64>,
    pub options: Map<String, Value>,
    /// A trial: it is no version of the run until a person keeps it.
    pub tried: bool,
    pub by: String,
}

#[derive(Debug, Clone, PartialEq)]
pub struct ModelRecord {
    pub id: i64,
    pub run: RunId,
    pub more_runs: Vec<RunId>,
    pub excluded: Value,
    pub parent: Option<i64>,
    pub kind: String,
    pub effects: Vec<String>,
    /// Effects that the parent does not have; all effects without a parent.
    pub added: Vec<String>,
    pub removed: Vec<String>,
    pub fit: Value,
    pub residual: String,
    pub rms: f64,
    pub validation_rms: f64,
    pub noise_floor_rms: Option<f64>,
    pub idle: bool,
    pub tried: bool,
    pub options: Map<String, Value>,
    pub by: Option<String>,
    pub created_at: String,
}

/// The change in a model version and its author.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct VersionRecord {
    pub id: i64,
    pub parent: Option<i64>,
    pub added: Vec<String>,
    pub removed: Vec<String>,
    pub by: Option<String>,
    pub created_at: String,
}

#[derive(Debug, Clone, PartialEq)]
pub struct DiagnosisRecord {
    pub id: i64,
    pub model: i64,
    pub diagnosis: Value,
    pub created_at: String,
}

/// A chain of runs and models from one request.
#[derive(Debug, Clone, PartialEq)]
pub struct AutopilotRecord {
    pub id: i64,
    pub bench: String,
    pub request: Map<String, Value>,
    pub state: String,
    pub reason: Option<String>,
    pub steps: Vec<Value>,
    pub created_at: String,
    pub finished_at: Option<String>,
}

/// State of an entry of a queue.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum QueueState {
    Waiting,
    /// `run` is the run, as soon as it exists.
    Started,
    /// The run could not be started; `reason` is the cause.
    Failed,
    /// By a person, or because its test plan did not proceed.
    Removed,
}

/// What a run of a test plan needs before the next one starts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum ProceedIf {
    /// The run is complete.
    #[default]
    Completed,
    /// Its result is identified, with or without a warning.
    Identified,
    /// Its result is identified, and all limits are met.
    Pass,
}

/// A run that waits for its bench, before it has an id.
#[derive(Debug, Clone, PartialEq)]
pub struct NewQueueEntry {
    pub bench: String,
    pub proceed_if: ProceedIf,
    pub request: Value,
    pub who: String,
    pub priority: i32,
    pub planned_s: f64,
    pub key: Option<String>,
}

/// A run that waits or waited for its bench.
#[derive(Debug, Clone, PartialEq)]
pub struct QueueRecord {
    pub id: i64,
    pub plan: Option<i64>,
    pub new: NewQueueEntry,
    pub state: QueueState,
    pub run: Option<i64>,
    pub run_state: Option<RunState>,
    pub reason: Option<String>,
    pub created_at: String,
    pub ended_at: Option<String>,
}

/// A message of the outbox.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NotificationRecord {
    pub id: i64,
    /// Name of the message for its target, unique among all stores.
    pub key: String,
    pub event: String,
    pub bench: String,
    pub run: Option<RunId>,
    pub reason: Option<String>,
    pub created_at: String,
    /// The text, after the first attempt.
    pub body: Option<String>,
    pub attempts: u32,
}

/// The messages of a target.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NotifyCounts {
    pub pending: u64,
    pub failed: u64,
    pub last_delivery: Option<String>,
    pub last_error: Option<String>,
}

/// Entry of the safety record of a bench.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct SafetyRecord {
    pub blocked: bool,
    /// Whether the software stop caused it.
    pub stopped: bool,
    pub reason: String,
    pub run: Option<RunId>,
    /// `None`: no person, or unknown.
    pub by: Option<String>,
    pub at: String,
}

/// Entry of the calibration record of a bench.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CalibrationRecord {
    pub id: i64,
    pub procedure: String,
    pub run: Option<RunId>,
    pub by: String,
    pub at: String,
}

/// An access token; only the hash of its secret is stored.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TokenRecord {
    pub id: i64,
    pub name: String,
    /// `full` or `read`.
    pub access: String,
    pub hash: Vec<u8>,
    pub made_at: String,
    pub made_by: String,
    pub used_at: Option<String>,
}

/// Samples of a window, reduced to a plot width.
#[derive(Debug, Clone, PartialEq)]
pub struct Window {
    /// Time of the first row of each point.
    pub time_s: Vec<f64>,
    pub columns: Vec<WindowColumn>,
    /// Whether every row is one point.
    pub exact: bool,
    /// Rows in the window.
    pub rows: u64,
}

/// Smallest and largest value of each point. NaN only if all its rows are NaN.
#[derive(Debug, Clone, PartialEq)]
pub struct WindowColumn {
    pub channel: Channel,
    pub min: Vec<f64>,
    pub max: Vec<f64>,
}

impl ModelRecord {
    /// All runs of the fit, its own run first.
    pub fn runs(&self) -> Vec<RunId> {
        std::iter::once(self.run).chain(self.more_runs.iter().copied()).collect()
    }
}
