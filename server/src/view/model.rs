//! Effects, model versions, fits and residuals.

use super::own::EffectDefinition;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use utoipa::ToSchema;

/// One physical cause that a model can hold.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Effect {
    pub id: String,
    pub kind: String,
    pub title: String,
    /// One sentence a technician understands.
    pub sentence: String,
    pub formula: String,
    /// Document and equation, or paper.
    #[serde(default)]
    pub source: String,
    /// How the residual looks when the effect is missing.
    #[serde(default)]
    pub looks: String,
    pub parameters: Vec<EffectParameter>,
    /// Columns without which the effect cannot be computed.
    pub needs: Vec<String>,
    /// What a user wrote; `null` for an effect of the library.
    #[serde(default)]
    pub definition: Option<EffectDefinition>,
    /// Version of a user's definition, from 1.
    #[serde(default)]
    pub version: Option<i64>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct EffectParameter {
    pub name: String,
    pub unit: String,
    pub min: Option<f64>,
    pub max: Option<f64>,
}

/// A model to be fitted: a run and a set of effects.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct NewModel {
    pub run: i64,
    /// Further runs of the same kind and joint to look at together with the first, in the order in which they were made.
    #[serde(default)]
    pub more_runs: Vec<i64>,
    pub effects: Vec<String>,
    /// The version that this one grew from.
    #[serde(default)]
    pub parent: Option<i64>,
    /// Stretches that the fit must not look at; those of the parent where left out.
    #[serde(default)]
    pub exclude: Option<Vec<Exclusion>>,
    /// Only to see what it would do: the version is nobody's model until it is kept.
    #[serde(default)]
    pub tried: bool,
}

/// A stretch of a measurement that a model version was not fitted to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Exclusion {
    /// Since the first sample of the runs that are looked at together, both ends included.
    pub from_s: f64,
    pub to_s: f64,
    /// What a person knows of it.
    pub reason: String,
}

impl NewModel {
    /// Every run to look at, in order.
    pub fn runs(&self) -> Vec<i64> {
        std::iter::once(self.run).chain(self.more_runs.iter().copied()).collect()
    }
}

/// One version of a model: a node of a tree that only grows. Going back means going to the parent.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Model {
    pub id: i64,
    pub run: i64,
    /// Further runs that the fit looked at together with the first.
    pub more_runs: Vec<i64>,
    /// What the fit did not look at.
    pub excluded: Vec<Exclusion>,
    pub kind: String,
    pub parent: Option<i64>,
    /// Effects that the parent did not have; all of them where there is no parent.
    pub added: Vec<String>,
    pub removed: Vec<String>,
    pub effects: Vec<String>,
    pub fit: Fit,
    pub residual: ResidualKind,
    /// On data that took no part in the fit.
    pub validation_rms: f64,
    pub rms: f64,
    pub noise_floor_rms: Option<f64>,
    /// It has added effects to its parent and takes less than half a percent off the error held out, and nobody has kept it.
    pub idle: bool,
    /// It was made to see what it would do, and nobody has kept it.
    #[serde(default)]
    #[schema(required = true)]
    pub tried: bool,
    /// Who made it: name of the token, or `local`.
    pub by: Option<String>,
    #[schema(format = DateTime)]
    pub created_at: String,
    /// Filter and decimation settings of the fit.
    #[schema(value_type = Object)]
    pub options: Map<String, Value>,
}

/// What an effect of a version is worth now, whatever the order in which the effects came.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Worth {
    pub effect: String,
    /// The error outside the fit that is left when the others are fitted again without it; `null` where they cannot be.
    pub without_rms: Option<f64>,
    /// Why there is no figure.
    pub reason: Option<String>,
}

/// A model with the parameters that fit one run best.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Fit {
    pub kind: String,
    pub effects: Vec<String>,
    /// Users' effects as they were when the model was fitted.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub own: Vec<EffectDefinition>,
    /// On the data that was fitted.
    pub rms: f64,
    /// On data that took no part in the fit.
    pub validation_rms: f64,
    pub unit: String,
    pub residual: ResidualKind,
    /// ‖residual‖ / ‖measured‖.
    pub relative_error: f64,
    pub parameters: Vec<FittedParameter>,
    /// Pairs of parameters that trade off against each other.
    pub trade_offs: Vec<TradeOff>,
    /// Condition number of the scaled columns.
    pub condition: Option<f64>,
    /// What a user should know, in plain sentences.
    pub notes: Vec<String>,
    pub preparation: Preparation,
    /// The same parameters as the effects hold them, to compute the model again.
    pub terms: Vec<Term>,
}

/// What RMS figures and residuals are made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum ResidualKind {
    /// Filtered and decimated samples.
    Raw,
    /// Means over short chunks of settled motion.
    PlateauMean,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct FittedParameter {
    pub effect: String,
    pub name: String,
    pub value: f64,
    pub unit: String,
    /// 95 % confidence interval over segments or repeats; `null` where this data sets no bound.
    #[schema(value_type = Vec<Option<f64>>, min_items = 2, max_items = 2)]
    pub ci95: [Option<f64>; 2],
    pub state: ParameterState,
    /// The state in words, where it is not `ok`; in a diagnosis also what it would be with an effect that the run leaves open.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub note: Option<String>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum ParameterState {
    Ok,
    /// The best value lies at the edge of what is physically sensible.
    AtBound,
    /// The interval is as wide as the value.
    Unidentified,
}

/// Two parameters of which the data decides only a combination.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct TradeOff {
    /// `effect.parameter`.
    pub first: String,
    pub second: String,
    pub correlation: f64,
}

/// How the run was prepared for the fit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Preparation {
    pub residual: ResidualKind,
    pub sample_rate_hz: f64,
    pub cutoff_hz: Option<f64>,
    /// By how much the measured velocity came after its position, and was moved back.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub velocity_lag_s: Option<f64>,
    pub decimation: u64,
    pub chunk_s: Option<f64>,
    pub samples: u64,
    /// Rows of the fit: chunks or decimated samples.
    pub rows: u64,
    /// Independent pieces for validation, intervals and tests.
    pub blocks: u64,
    /// `column` or `found`.
    pub segments_from: String,
    /// `column`, `found` or `none`.
    pub repeats_from: String,
}

/// One effect of the model, as numbers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Term {
    pub effect: String,
    pub form: String,
    pub shape: Vec<f64>,
    pub linear: Vec<f64>,
    /// Names of the factors, then of the shape parameters.
    #[serde(default)]
    pub names: Vec<String>,
}

/// What is left of a run once a model version is taken away. All lists have the same length.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ResidualSet {
    pub residual: ResidualKind,
    pub unit: String,
    /// Coordinates of the points: velocity, position, load, temperature, time, direction, …
    pub axes: Vec<ResidualAxis>,
    pub measured: Vec<f64>,
    pub predicted: Vec<f64>,
    /// measured − predicted.
    pub error: Vec<f64>,
    /// Points that are not part of the fit (ramps, reversals): shown, not judged.
    pub held_out: Vec<bool>,
    /// Points that a person took out of the fit; empty where there are none.
    #[serde(default)]
    #[schema(required)]
    pub excluded: Vec<bool>,
    pub segment: Vec<i64>,
    pub repeat: Vec<i64>,
    /// Pieces of the run that may be called independent of each other, numbered in their order: what bands count.
    pub piece: Vec<usize>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ResidualAxis {
    /// Column of the run table, or `direction`, `run_order`.
    pub name: String,
    pub unit: String,
    pub values: Vec<f64>,
}
