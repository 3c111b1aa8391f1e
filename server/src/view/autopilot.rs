//! Chains of measuring, diagnosing and adding that run by themselves.

use super::{Experiment, Verdict};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use utoipa::ToSchema;

/// Measure, diagnose, add missing effects or perform the recommended run, until no effect is missing or the budget is
/// used up.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct NewAutopilot {
    pub bench: String,
    /// Maximum number of runs, including the first.
    #[serde(default = "three")]
    #[schema(default = 3, minimum = 1, maximum = 50)]
    pub runs: u32,
    /// Maximum bench time; unlimited if omitted.
    #[serde(default)]
    pub bench_time_s: Option<f64>,
    /// Procedure of the first run.
    #[serde(default = "friction")]
    #[schema(default = "friction")]
    pub procedure: String,
    /// Of the first run. Omitted parameters take their defaults.
    #[serde(default)]
    #[schema(value_type = Object)]
    pub parameters: Map<String, Value>,
    /// The initial model; the baseline of the procedure if omitted.
    #[serde(default)]
    pub effects: Option<Vec<String>>,
    /// Maximum number of effects to add.
    #[serde(default = "six")]
    #[schema(default = 6, maximum = 20)]
    pub max_effects: u32,
    /// An existing run to start from, instead of a new one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from_run: Option<i64>,
}

fn three() -> u32 {
    3
}

fn six() -> u32 {
    6
}

fn friction() -> String {
    "friction".into()
}

/// The run that a diagnosis recommends, followed by a diagnosis of the same model with it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct NewExperiment {
    pub bench: String,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum AutopilotState {
    Running,
    /// Nothing is left to add and nothing to measure that would tell more.
    Finished,
    /// Something is still open, and the next run is more than the budget allows.
    BudgetSpent,
    /// A person has ended it.
    Stopped,
    Failed,
    /// The daemon ended before it did. It does not go on by itself.
    Interrupted,
}

impl AutopilotState {
    pub fn is_over(self) -> bool {
        self != AutopilotState::Running
    }
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Autopilot {
    pub id: i64,
    pub bench: String,
    pub state: AutopilotState,
    /// Reason of its end, in one sentence.
    pub reason: Option<String>,
    /// The request: body of the call, and the diagnosis if it performs the recommended run of one.
    #[schema(value_type = Object)]
    pub request: Map<String, Value>,
    /// Runs performed so far, in order.
    pub runs: Vec<i64>,
    pub bench_time_s: f64,
    /// The newest model version.
    pub model: Option<i64>,
    pub verdict: Option<Verdict>,
    pub steps: Vec<AutopilotStep>,
    #[schema(format = DateTime)]
    pub created_at: String,
    #[schema(format = DateTime)]
    pub finished_at: Option<String>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum AutopilotAction {
    /// A run was started.
    Measure,
    /// The run is over.
    Measured,
    /// A model was fitted to all runs so far and diagnosed.
    Fit,
    /// The same with one effect more.
    Add,
}

/// One step, with what was known before and after it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct AutopilotStep {
    /// From 1, without gaps.
    pub sequence: u64,
    #[schema(format = DateTime)]
    pub at: String,
    pub action: AutopilotAction,
    /// One sentence.
    pub text: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub run: Option<i64>,
    /// Bench time of the run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bench_time_s: Option<f64>,
    /// Purpose and expected benefit of the run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub experiment: Option<Experiment>,
    /// The created model version and its diagnosis.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub model: Option<i64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub diagnosis: Option<i64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub verdict: Option<Verdict>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub effect: Option<String>,
    /// Validation error of the previous model and of this one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub before_rms: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub after_rms: Option<f64>,
}

impl AutopilotStep {
    pub fn new(action: AutopilotAction, text: impl Into<String>) -> Self {
        Self {
            sequence: 0,
            at: String::new(),
            action,
            text: text.into(),
            run: None,
            bench_time_s: None,
            experiment: None,
            model: None,
            diagnosis: None,
            verdict: None,
            effect: None,
            before_rms: None,
            after_rms: None,
        }
    }
}
