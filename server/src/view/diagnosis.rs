//! Where a model version fails and what it lacks.

use super::{Fit, FittedParameter, ResidualKind};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use utoipa::ToSchema;

/// Which model version to diagnose.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct NewDiagnosis {
    pub model: i64,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Nothing left that this data can show.
    Adequate,
    /// An effect of the library explains the rest.
    MissingEffect,
    /// There is structure, but no effect of the library explains it.
    UnexplainedStructure,
}

/// How sure it is that an effect is missing, and whether it matters.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Evidence {
    #[default]
    Strong,
    /// Sure, and less than 5 % of the held-out error.
    Small,
    /// It may be missing: chance would name one in more than 1 % of such runs, or its interval reaches to nothing.
    Weak,
}

/// A kept diagnosis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Diagnosis {
    pub id: i64,
    /// The model version that was diagnosed.
    pub model_id: i64,
    pub run: i64,
    #[schema(format = DateTime)]
    pub created_at: String,
    #[serde(flatten)]
    pub finding: Finding,
}

/// What `jointbench diagnose --json` prints.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Finding {
    pub kind: String,
    /// Effects of the model at hand.
    pub model: Vec<String>,
    pub fit: Fit,
    pub residual: ResidualKind,
    /// Of the same kind as the RMS figures; `null` without repeats.
    pub noise_floor_rms: Option<f64>,
    pub noise_floor: NoiseFloor,
    pub verdict: Verdict,
    /// One plain sentence.
    pub summary: String,
    /// Why the verdict is no assurance: the data could not have shown what is missing, or the columns contradict each other.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub undecided: Option<String>,
    /// Regions where the model is wrong, the worst first.
    #[serde(rename = "where")]
    pub regions: Vec<Region>,
    /// Whether structure remains even beside all suggestions: then no run is proposed for effects that nothing points to.
    #[serde(default)]
    pub structure_remains: bool,
    /// Ranked; empty unless the verdict is `missing_effect`.
    pub suggestions: Vec<Suggestion>,
    /// The run that would tell more.
    pub experiment: Option<Experiment>,
    /// Effects that were looked for and not found.
    pub silent: Vec<Silent>,
    /// Effects that this data cannot show.
    pub not_visible: Vec<Invisible>,
    /// Effects that were tried and left out.
    #[serde(default)]
    pub left_out: Vec<LeftOut>,
}

/// How well the measurement repeats itself.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct NoiseFloor {
    pub rms: Option<f64>,
    #[schema(value_type = Option<Vec<f64>>, min_items = 2, max_items = 2)]
    pub ci95: Option<[f64; 2]>,
    /// Where the figure comes from, in words.
    pub source: String,
    /// Share of the remaining squared error that is the same in every repeat.
    pub repeatable_share: Option<f64>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Region {
    pub axis: String,
    pub from: f64,
    pub to: f64,
    pub mean_residual: f64,
    /// Simultaneous over all regions of all maps.
    #[schema(value_type = Vec<f64>, min_items = 2, max_items = 2)]
    pub ci95: [f64; 2],
    pub samples: u64,
    /// `positive` or `negative` motion; absent for both.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub direction: Option<String>,
    /// The same in one sentence with figures.
    pub sentence: String,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Suggestion {
    pub effect: String,
    /// With the effect added.
    pub validation_rms: f64,
    /// Share of the validation error that goes away with this effect alone.
    pub error_reduction: f64,
    /// From the scatter over what was held out; absent for an effect that is judged elsewhere than where the RMS looks.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<Vec<f64>>, min_items = 2, max_items = 2)]
    pub error_reduction_ci95: Option<[f64; 2]>,
    /// Change of the Bayesian information criterion over independent pieces; below 0 it speaks for the effect.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bic_change: Option<f64>,
    /// Share of the validation error that it takes away beside all other suggestions.
    #[serde(default)]
    pub error_reduction_together: f64,
    /// Family-wise, from sign flips of whole blocks.
    pub p_value: f64,
    #[serde(default)]
    #[schema(required = true)]
    pub evidence: Evidence,
    /// No flip scored as high: the chance is `p_value` at most.
    #[serde(default)]
    pub p_at_most: bool,
    pub parameters: Vec<FittedParameter>,
    /// Effects that this data cannot tell from this one.
    pub confounded_with: Vec<String>,
    /// One plain sentence.
    pub why: String,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Experiment {
    pub procedure: String,
    #[schema(value_type = Object)]
    pub parameters: Map<String, Value>,
    pub why: String,
    /// Expected separation of the rivals in standard deviations.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub expected_z: Option<f64>,
    /// Longest duration on the bench.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub expected_duration_s: Option<f64>,
    /// Effects that it tells apart, or shows for the first time.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub separates: Vec<String>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Silent {
    pub effect: String,
    /// RMS of the smallest effect that would have been found with 80 % probability.
    pub minimum_detectable_rms: f64,
    /// Within what it was looked for, where that has ends: `1 to 60 waves a turn`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sought: Option<String>,
}

/// An effect that was tried and is not in the model, though it might be there.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct LeftOut {
    pub effect: String,
    pub why: String,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Invisible {
    pub effect: String,
    pub why: String,
}
