//! Runs that wait for their bench.

use super::{NewRun, ProceedIf, QueueState, RunState};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// A run that waits or waited for its bench.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct QueueEntry {
    pub id: i64,
    /// Id of the first entry of the test plan; only for the entries of one.
    pub plan: Option<i64>,
    pub proceed_if: ProceedIf,
    pub request: NewRun,
    pub by: String,
    /// The entry with the largest priority starts first; among equals the oldest.
    pub priority: i32,
    pub state: QueueState,
    /// Expected duration by the clock.
    pub planned_s: f64,
    /// Expected time until the start, by the clock; only for a waiting entry of a queue that is not paused.
    pub starts_in_s: Option<f64>,
    pub run: Option<i64>,
    /// State of the run.
    #[serde(default)]
    pub run_state: Option<RunState>,
    pub reason: Option<String>,
    #[schema(format = DateTime)]
    pub created_at: String,
    /// When the entry left the queue.
    #[schema(format = DateTime)]
    pub ended_at: Option<String>,
}

#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct QueuePause {
    pub reason: String,
    #[schema(format = DateTime)]
    pub since: String,
}

/// The queue of a bench.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct BenchQueue {
    pub bench: String,
    /// No entry starts until a person or a script resumes the queue; an active run is not affected.
    pub paused: Option<QueuePause>,
    /// The waiting entries, in the order in which they start.
    pub entries: Vec<QueueEntry>,
    /// The entries that left the queue last, at most 50, the newest first.
    #[serde(default)]
    #[schema(required)]
    pub left: Vec<QueueEntry>,
}

/// A test plan: runs of one unit, in order. The next run starts if the result of the run before allows it; otherwise the rest of
/// it is removed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(example = json!({"proceed_if": "identified", "runs": [
    {"bench": "joint-a-mock", "procedure": "warm_up"},
    {"bench": "joint-a-mock", "procedure": "friction", "parameters": {"repeats": 3}, "unit": {"serial": "SN123"}}]}))]
pub struct NewTestPlan {
    #[serde(default)]
    pub proceed_if: ProceedIf,
    /// 1 to 100 runs of one bench.
    pub runs: Vec<NewRun>,
    #[serde(default)]
    pub priority: i32,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct QueuePriority {
    pub priority: i32,
}

/// Keeps a run with a lease going.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Lease {
    /// Time until the run ends unless the lease is renewed.
    pub expires_in_s: f64,
}
