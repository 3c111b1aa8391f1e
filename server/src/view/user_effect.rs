//! Trials of user-defined effects, evaluation and import of models.

use super::{Effect, EffectDefinition, Exclusion, FittedParameter, Model};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use utoipa::ToSchema;

/// A definition to check, and optionally the run to fit it on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct EffectTrial {
    pub effect: EffectDefinition,
    /// The formula must be finite on this run; the effect is fitted together with `effects`.
    #[serde(default)]
    pub run: Option<i64>,
    /// Effects of the model for the trial; the baseline of the run if omitted.
    #[serde(default)]
    pub effects: Option<Vec<String>>,
    /// The run whose columns the formula may use, without a fit.
    #[serde(default)]
    pub columns_of: Option<i64>,
    /// Further runs of the same joint, analysed together with the first.
    #[serde(default)]
    pub more_runs: Vec<i64>,
    /// Intervals to exclude from the fit.
    #[serde(default)]
    pub exclude: Vec<Exclusion>,
    /// The formula is incomplete: errors are part of the response instead of a rejection.
    #[serde(default)]
    pub typing: bool,
}

/// An error in a formula.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Place {
    /// `formula`, `parameters` or `id`.
    pub field: String,
    pub text: String,
    /// Number of characters before the error.
    pub position: u64,
    /// Number of wrong characters; 0 if something is missing.
    pub length: u64,
    /// Short description of the error.
    pub message: String,
}

impl From<jointbench_model::FormulaFault> for Place {
    fn from(fault: jointbench_model::FormulaFault) -> Self {
        Self {
            field: fault.field.to_owned(),
            text: fault.text,
            position: fault.position as u64,
            length: fault.length as u64,
            message: fault.message,
        }
    }
}

/// A parsed formula.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct EffectCheck {
    /// `null` if the formula is invalid.
    pub effect: Option<Effect>,
    /// Error in an incomplete formula.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mistake: Option<Place>,
    /// Warnings: inconsistent units, or a formula that uses the modelled signal. They do not change results.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub doubt: Option<String>,
    /// Linear parameters (coefficients).
    pub linear: Vec<String>,
    /// Nonlinear parameters.
    pub shape: Vec<String>,
    /// Signals used by the formula.
    pub signals: Vec<String>,
    /// Fitted parameters on the run; empty without a run.
    pub parameters: Vec<FittedParameter>,
    /// Effects that are confounded with it on this run.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub like: Vec<String>,
    /// What the effect does to the error; absent without a run, and if the run cannot distinguish it from another effect.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error: Option<TrialError>,
}

/// Validation error (cross-validated RMS) without and with an effect under trial, on the same samples.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct TrialError {
    /// Absent without other effects.
    pub before_rms: Option<f64>,
    pub after_rms: f64,
    pub unit: String,
}

/// A signal that a formula may use.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct FormulaSignal {
    pub name: String,
    pub unit: String,
    pub meaning: String,
}

/// Elements of the formulas of a kind.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct FormulaLanguage {
    pub kind: String,
    /// Left-hand side of the formula.
    pub left_hand_side: String,
    pub signals: Vec<FormulaSignal>,
    pub functions: Vec<String>,
    pub operators: Vec<String>,
}

/// On which run to evaluate a model version.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct NewEvaluation {
    pub run: i64,
}

/// An imported version, with the limitations of its evaluation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ImportedModel {
    #[serde(flatten)]
    pub model: Model,
    /// Limitations, as in an evaluation: missing columns, metadata that differ from the fit, signals outside the range
    /// of the fit.
    pub notes: Vec<String>,
}

/// An exported model to import as a version of a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct ModelImport {
    /// The run to evaluate the model on; its errors become those of the version.
    pub run: i64,
    /// Response of `GET /models/{id}/export?format=json`.
    #[schema(value_type = Object)]
    pub model: Map<String, Value>,
}
