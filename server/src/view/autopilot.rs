//! Chains of measuring, diagnosing and adding that run by themselves.

use super::{Experiment, Verdict};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use utoipa::ToSchema;

/// Measure, diagnose, add what is missing or make the run that would tell, again, until nothing is missing or the budget
/// is spent.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct NewAutopilot {
    pub bench: String,
    /// At most so many runs, one that it makes first included.
    #[serde(default = "three")]
    #[schema(default = 3, minimum = 1, maximum = 50)]
    pub runs: u32,
    /// At most so much time of the bench; no bound where left out.
    #[serde(default)]
    pub bench_time_s: Option<f64>,
    /// The first run, where it makes that.
    #[serde(default = "friction")]
    #[schema(default = "friction")]
    pub procedure: String,
    /// Of the first run. Parameters left out take their defaults.
    #[serde(default)]
    #[schema(value_type = Object)]
    pub parameters: Map<String, Value>,
    /// The model to start from; the baseline of the procedure where left out.
    #[serde(default)]
    pub effects: Option<Vec<String>>,
    /// At most so many effects are added.
    #[serde(default = "six")]
    #[schema(default = 6, maximum = 20)]
    pub max_effects: u32,
    /// A run that is there: it begins with this one, and makes none before it has looked at it.
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

/// The run that a diagnosis asks for, and the same model diagnosed again with it.
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
    /// Why it ended as it did, in one sentence.
    pub reason: Option<String>,
    /// What was asked for: the body of the call, and the diagnosis where it makes an experiment of one.
    #[schema(value_type = Object)]
    pub request: Map<String, Value>,
    /// Runs made so far, in order.
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
    /// One plain sentence.
    pub text: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub run: Option<i64>,
    /// Time of the bench that the run took.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bench_time_s: Option<f64>,
    /// Why the run was made, and what was expected of it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub experiment: Option<Experiment>,
    /// The model version that was made, and its diagnosis.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub model: Option<i64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub diagnosis: Option<i64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub verdict: Option<Verdict>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub effect: Option<String>,
    /// Error on data that took no part in the fit, of the model before and of this one.
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
