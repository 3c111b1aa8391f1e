//! Runs, their journal and their samples.

use super::{FittedParameter, Identified};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use utoipa::ToSchema;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum RunState {
    Queued,
    Arming,
    Running,
    Paused,
    Securing,
    Completed,
    Stopped,
    Aborted,
    Failed,
    /// The daemon ended before the run did.
    Interrupted,
}

/// What securing has reached.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Safe {
    /// Read back: drive off, brake current zero.
    SafeVerified,
    /// Commanded, but not read back.
    SafeCommanded,
    /// Not known. The bench is blocked until a person acknowledges.
    UnsafeUnknown,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct RunSummary {
    pub id: i64,
    /// The bench, or where the run was imported from.
    pub bench: String,
    /// The procedure's id; `import` for a run that came in as a file.
    pub procedure: String,
    pub kind: String,
    pub state: RunState,
    pub safe: Option<Safe>,
    /// Why the run ended as it did, where it did not complete.
    pub reason: Option<String>,
    #[schema(format = DateTime)]
    pub created_at: String,
    #[schema(format = DateTime)]
    pub finished_at: Option<String>,
    pub rows: u64,
    pub duration_s: Option<f64>,
    pub simulated: bool,
    /// Who started it or brought it in: name of the token, or `local`.
    pub by: Option<String>,
    pub tags: Vec<String>,
    /// The last note.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub note: Option<String>,
    /// What the procedure makes of it, as soon as that is worked out after its end.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub verdict: Option<Identified>,
    /// Whether the models of its kind describe it: a run for the zero of a sensor, a compensation or a warm-up has no model.
    pub is_modelled: bool,
    /// The last version of the run's model that is neither idle nor only tried.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub model: Option<LastModel>,
    /// Why the end of the run is not yet stored: the rest is as the bench has told. It is stored as soon as that can be.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub not_stored: Option<String>,
    /// What is wrong with its record, in a list: the other fields are what can be read, or empty.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub damaged: Option<String>,
}

/// What a model version comes to, in short.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct LastModel {
    pub id: i64,
    /// On data that took no part in the fit.
    pub validation_rms: f64,
    pub noise_floor_rms: Option<f64>,
    /// Of the RMS figures.
    pub unit: String,
    /// Coulomb friction, where the model has it.
    pub coulomb: Option<FittedParameter>,
}

/// What somebody said about a run; only ever appended to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Note {
    pub id: i64,
    /// The moment that it is about, as `time_s` of the samples; `null` for the whole run.
    pub at_s: Option<f64>,
    pub text: String,
    #[schema(format = DateTime)]
    pub created_at: String,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct NewNote {
    #[serde(default)]
    pub at_s: Option<f64>,
    /// At most 4000 characters.
    pub text: String,
}

/// The tags of a run, all of them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Tags {
    /// At most 20, each a word of at most 40 characters.
    pub tags: Vec<String>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct RunList {
    /// Runs that match, whatever the page.
    pub total: u64,
    pub runs: Vec<RunSummary>,
    /// Of a search that is still being typed: what is not understood, and left out.
    pub unclear: Option<String>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Run {
    #[serde(flatten)]
    pub summary: RunSummary,
    #[schema(value_type = Object)]
    pub parameters: Map<String, Value>,
    /// Bench description, software version, mock or hardware, seed: what is needed to trust and to repeat the run.
    #[schema(value_type = Object)]
    pub provenance: Map<String, Value>,
    /// Facts about the set-up, as in `meta.json`.
    #[schema(value_type = Object)]
    pub meta: Map<String, Value>,
    pub channels: Vec<ChannelInfo>,
    /// While the run is on.
    pub progress: Option<Progress>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ChannelInfo {
    pub name: String,
    pub unit: Option<String>,
    /// One count of the instrument, in the channel's unit.
    pub resolution: Option<f64>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Progress {
    /// Steps done.
    pub step: usize,
    pub steps: usize,
    /// What is done now.
    pub label: String,
    /// On the clock of the person who waits, like what remains.
    pub elapsed_s: f64,
    pub remaining_s: f64,
}

/// A run to be started. Parameters left out take the procedure's defaults.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct NewRun {
    pub bench: String,
    pub procedure: String,
    #[serde(default)]
    #[schema(value_type = Object)]
    pub parameters: Map<String, Value>,
}

/// One line of a run's journal, which is only ever appended to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct RunEvent {
    pub sequence: u64,
    /// On the bench's clock, as `time_s` of the samples.
    pub at_s: f64,
    /// `state`, `step_started`, `step_finished`, `fault`, `breach`, `safe`, `note`, …
    pub kind: String,
    /// One plain sentence.
    pub text: String,
    /// The event's own fields.
    #[schema(value_type = Object)]
    pub data: Map<String, Value>,
}

/// Samples of a window. Where there are more rows than pixels: smallest and largest value of each pixel, so that a spike
/// of one sample is still seen. Where not (`exact`), `min` equals `max`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Samples {
    pub time_s: Vec<f64>,
    pub channels: Vec<SampleColumn>,
    pub exact: bool,
    /// Rows in the window.
    pub rows: u64,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct SampleColumn {
    pub name: String,
    pub unit: Option<String>,
    pub min: Vec<Option<f64>>,
    pub max: Vec<Option<f64>>,
}

/// One channel over every row of a window, nothing left out but what was not measured.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ChannelStatistics {
    pub name: String,
    pub unit: Option<String>,
    /// Values that there are. The figures are `null` where there is none.
    pub n: u64,
    pub mean: Option<f64>,
    /// Standard deviation about the mean (n − 1); `null` for fewer than two values.
    pub deviation: Option<f64>,
    pub rms: Option<f64>,
    pub min: Option<f64>,
    pub max: Option<f64>,
}

impl From<&jointbench_instrument::Channel> for ChannelInfo {
    fn from(channel: &jointbench_instrument::Channel) -> Self {
        Self { name: channel.name.clone(), unit: channel.unit().map(str::to_owned), resolution: channel.resolution }
    }
}
