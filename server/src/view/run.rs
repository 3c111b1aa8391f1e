//! Runs, their journal and their samples.

use super::{ArchivedTable, FittedParameter, Identified, LimitOutcome, RunState, Safe, Unit, word};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use utoipa::ToSchema;

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct RunSummary {
    pub id: i64,
    /// The bench, or the source of an imported run.
    pub bench: String,
    /// Id of the procedure; `import` for an imported run.
    pub procedure: String,
    pub kind: String,
    pub state: RunState,
    pub safe: Option<Safe>,
    /// Reason of the end, if the run did not complete.
    pub reason: Option<String>,
    #[schema(format = DateTime)]
    pub created_at: String,
    #[schema(format = DateTime)]
    pub finished_at: Option<String>,
    pub rows: u64,
    pub duration_s: Option<f64>,
    pub simulated: bool,
    /// User who started or imported it: name of the token, or `local`.
    pub by: Option<String>,
    /// The unit under test.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unit: Option<Unit>,
    /// Person who started it, as entered.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub operator: Option<String>,
    pub tags: Vec<String>,
    /// The last note.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub note: Option<String>,
    /// Verdict of the procedure, available shortly after the end of the run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub verdict: Option<Identified>,
    /// Whether its result meets its limits; absent without limits.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub limits: Option<LimitOutcome>,
    /// Whether the models of its kind describe it: a run for the zero of a sensor, a compensation or a warm-up has no model.
    pub is_modelled: bool,
    /// The latest active model version of the run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub model: Option<LastModel>,
    /// Why the end of the run is not yet stored; the other fields are reported by the bench. It is stored as soon as
    /// possible.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub not_stored: Option<String>,
    /// Damage of its record, in a list; the other fields contain the readable data.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub damaged: Option<String>,
}

/// Summary of a model version.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct LastModel {
    pub id: i64,
    /// Validation error (cross-validated RMS).
    pub validation_rms: f64,
    pub noise_floor_rms: Option<f64>,
    /// Of the RMS figures.
    pub unit: String,
    /// Coulomb friction, if in the model.
    pub coulomb: Option<FittedParameter>,
}

/// A note about a run; notes are never changed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Note {
    pub id: i64,
    /// The moment of the note, as `time_s` of the samples; `null` for the whole run.
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
    /// Total number of matching runs.
    pub total: u64,
    pub runs: Vec<RunSummary>,
    /// Ignored terms of an incomplete search.
    pub unclear: Option<String>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Run {
    #[serde(flatten)]
    pub summary: RunSummary,
    #[schema(value_type = Object)]
    pub parameters: Map<String, Value>,
    /// Bench description, software version, mock or hardware, seed: data needed to repeat the run.
    #[schema(value_type = Object)]
    pub provenance: Map<String, Value>,
    /// Metadata of the test conditions, as in `meta.json`.
    #[schema(value_type = Object)]
    pub meta: Map<String, Value>,
    pub channels: Vec<ChannelInfo>,
    /// While the run is active.
    pub progress: Option<Progress>,
    /// Its tables in the archive; absent without an archive.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub archive: Vec<ArchivedTable>,
}

impl RunSummary {
    /// The procedure as people read it.
    pub fn procedure_title(&self) -> &'static str {
        jointbench_procedure::procedure(&self.procedure).map_or("imported data", |procedure| procedure.title())
    }
}

impl Run {
    /// How the run ended, in a sentence.
    pub fn ending(&self) -> String {
        let summary = &self.summary;
        let mut text = format!("run {} {}: {} rows", summary.id, word(summary.state), summary.rows);
        if let Some(duration_s) = summary.duration_s {
            text += &format!(" in {duration_s:.1} s of bench time");
        }
        if let Some(safe) = summary.safe {
            text += &format!(", bench {}", word(safe));
        }
        if let Some(reason) = &summary.reason {
            text += &format!(": {reason}");
        }
        if let Some(why) = &summary.not_stored {
            text += &format!("; not yet stored: {why}");
        }
        let can_go_on = jointbench_procedure::procedure(&summary.procedure).is_some_and(|one| one.can_resume().is_ok());
        if can_go_on && summary.state.is_final() && summary.state != RunState::Completed && summary.rows > 0 {
            text += &format!("; complete it with `jointbench run --continue {}`", summary.id);
        }
        text
    }
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ChannelInfo {
    pub name: String,
    pub unit: Option<String>,
    /// Resolution (LSB) of the instrument, in the unit of the channel.
    pub resolution: Option<f64>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Progress {
    /// Steps done.
    pub step: usize,
    pub steps: usize,
    /// Current step.
    pub label: String,
    /// In wall-clock time, like the remaining time.
    pub elapsed_s: f64,
    pub remaining_s: f64,
    /// Completed fraction of the expected duration, 0 to 1.
    #[serde(default)]
    pub fraction: f64,
    /// The run warms the joint up until it is steady: it takes no longer than the remaining time, and may end before.
    #[serde(default)]
    pub at_most: bool,
}

/// A run to start. Omitted parameters take the defaults of the procedure.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(example = json!({"bench": "joint-a-mock", "procedure": "friction", "parameters": {"repeats": 3}}))]
pub struct NewRun {
    pub bench: String,
    pub procedure: String,
    #[serde(default)]
    #[schema(value_type = Object)]
    pub parameters: Map<String, Value>,
    /// The unit under test; it needs a serial number.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unit: Option<Unit>,
    /// Person who starts the run; at most 80 characters.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub operator: Option<String>,
    /// Text of a limits file (TOML, at most 64 kB). The entries for the part, revision and procedure of the run apply; it
    /// is kept with the run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub limits: Option<String>,
    /// A note about the run; at most 4000 characters.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub note: Option<String>,
    /// The run ends in order if its lease is not renewed within this time; a waiting run is removed from the queue. 1 s to one day.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(minimum = 1, maximum = 86_400)]
    pub lease_s: Option<f64>,
    /// Waits in the queue of the bench; the answer is the entry of the queue.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub queue: bool,
    /// In the queue: the largest priority starts first.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub priority: i32,
}

fn is_zero(priority: &i32) -> bool {
    *priority == 0
}

/// One entry of the journal of a run, which is append-only.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct RunEvent {
    pub sequence: u64,
    /// On the bench's clock, as `time_s` of the samples.
    pub at_s: f64,
    /// `state`, `step_started`, `step_finished`, `fault`, `breach`, `safe`, `note`, …
    pub kind: String,
    /// Identifies the event in comparable runs: its kind and subject, such as `step_started/hold 3/0`.
    #[serde(default)]
    #[schema(required = true)]
    pub key: String,
    /// One sentence.
    pub text: String,
    /// Fields of the event.
    #[schema(value_type = Object)]
    pub data: Map<String, Value>,
}

/// Samples of a window. With more rows than pixels: minimum and maximum of each pixel, so that single-sample spikes
/// remain visible. Otherwise (`exact`) `min` equals `max`.
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

/// One channel over all rows of a window, without missing values.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ChannelStatistics {
    pub name: String,
    pub unit: Option<String>,
    /// Number of values. The figures are `null` without values.
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
