//! What goes into the store and comes out of it.

use super::Order;
use jointbench_instrument::Channel;
use jointbench_procedure::{RunId, RunState, Safe};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

/// A run about to begin.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct NewRun {
    pub bench: String,
    /// The procedure's id; `import` for a run that came as a file.
    pub procedure: String,
    pub kind: String,
    pub simulated: bool,
    pub parameters: Map<String, Value>,
    /// Bench description, calibration, software version, mock or hardware, seed.
    pub provenance: Map<String, Value>,
    /// Metadata of the test conditions, as in `meta.json`.
    pub meta: Map<String, Value>,
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
    /// Moments are RFC 3339 in UTC.
    pub created_at: String,
    pub started_at: Option<String>,
    pub finished_at: Option<String>,
    pub rows: u64,
    /// From the first sample to the last.
    pub duration_s: Option<f64>,
    pub parameters: Map<String, Value>,
    pub provenance: Map<String, Value>,
    pub meta: Map<String, Value>,
    /// Empty before the first row.
    pub channels: Vec<Channel>,
    pub tags: Vec<String>,
    /// The last one.
    pub note: Option<String>,
    /// What its procedure makes of it, where that was worked out.
    pub verdict: Option<String>,
    /// Figures of the last version, as the list tells them.
    pub model: Option<Value>,
    /// What is wrong with it, in a list: the other fields are what can be read.
    pub damaged: Option<String>,
}

impl RunRecord {
    /// Of a run that is known to be there, and nothing else.
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
            channels: Vec::new(),
            tags: Vec::new(),
            note: None,
            verdict: None,
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
    /// In the language of [`super::search`]; upper and lower case are one.
    pub search: Option<String>,
    pub order: Order,
}

/// What somebody said about a run.
#[derive(Debug, Clone, PartialEq)]
pub struct NoteRecord {
    pub id: i64,
    /// The moment that it is about, on the run's clock.
    pub at_s: Option<f64>,
    pub text: String,
    pub created_at: String,
}

/// One entry of a run's journal.
#[derive(Debug, Clone, PartialEq)]
pub struct EventRecord {
    /// From 1, without gaps.
    pub sequence: u64,
    pub at_s: f64,
    pub kind: String,
    /// Fields of the event.
    pub data: Map<String, Value>,
}

/// One version of an effect that a user wrote.
#[derive(Debug, Clone, PartialEq)]
pub struct OwnEffectRecord {
    pub kind: String,
    pub effect: String,
    /// From 1.
    pub version: i64,
    pub definition: Value,
    pub created_at: String,
}

/// A fit to be kept as a version.
#[derive(Debug, Clone, PartialEq)]
pub struct NewModel {
    pub run: RunId,
    /// Further runs of the same joint that the fit looks at, in order.
    pub more_runs: Vec<RunId>,
    /// Stretches that the fit does not look at.
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
    /// Made to see what it would do: nobody's model until a person keeps it.
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
    /// Effects that the parent does not have; all of them where there is none.
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

/// What was changed in a model version, and by whom.
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

/// A chain of runs and models that was asked for at once.
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

/// Why a bench must not move.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct SafetyRecord {
    pub blocked: bool,
    /// By the software stop.
    pub stopped: bool,
    pub reason: String,
    pub run: Option<RunId>,
    /// `None`: nobody, or nobody knows any more.
    pub by: Option<String>,
    pub at: String,
}

/// Whose result the next runs of a bench use.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CalibrationRecord {
    pub id: i64,
    pub procedure: String,
    pub run: Option<RunId>,
    pub by: String,
    pub at: String,
}

/// A token that opens the door; of its secret there is only the hash.
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

/// Samples of a window, drawn at a width.
#[derive(Debug, Clone, PartialEq)]
pub struct View {
    /// The first time of each point.
    pub time_s: Vec<f64>,
    pub columns: Vec<ViewColumn>,
    /// Every row is a point of its own.
    pub exact: bool,
    /// Rows in the window.
    pub rows: u64,
}

/// Smallest and largest value of each point. NaN only where all its rows are.
#[derive(Debug, Clone, PartialEq)]
pub struct ViewColumn {
    pub channel: Channel,
    pub min: Vec<f64>,
    pub max: Vec<f64>,
}

impl ModelRecord {
    /// Every run that the fit looked at, its own first.
    pub fn runs(&self) -> Vec<RunId> {
        std::iter::once(self.run).chain(self.more_runs.iter().copied()).collect()
    }
}
