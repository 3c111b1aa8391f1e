//! Users' effects, and models beside each other and on their way out and in.

use super::model::{Effect, FittedParameter, Model, ResidualKind};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use utoipa::ToSchema;

/// An effect that a user writes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct EffectDefinition {
    /// Lower case letters, digits and underscores; not an id of the library.
    pub id: String,
    pub kind: String,
    /// `tau = …` for friction and brake, `error = …` for encoder, `torsion = …` for stiffness; what stands right of it is enough.
    pub formula: String,
    pub parameters: Vec<DefinedParameter>,
    #[serde(default)]
    pub title: String,
    /// One sentence that a technician understands.
    #[serde(default)]
    pub sentence: String,
}

/// A parameter that enters linearly is solved for; the others are searched for in their range.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct DefinedParameter {
    pub name: String,
    /// `1` where left out.
    #[serde(default = "one")]
    pub unit: String,
    #[serde(default)]
    pub min: Option<f64>,
    #[serde(default)]
    pub max: Option<f64>,
    /// Where the search begins, inside the bounds.
    #[serde(default)]
    #[schema(value_type = Option<Vec<f64>>, min_items = 2, max_items = 2)]
    pub start: Option<[f64; 2]>,
    /// A whole number: every one of the range is tried.
    #[serde(default)]
    pub whole: bool,
}

fn one() -> String {
    "1".to_owned()
}

/// A definition to be checked, and the run to try it on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct EffectTrial {
    pub effect: EffectDefinition,
    /// The formula must be finite on this run; the effect is fitted beside `effects`.
    #[serde(default)]
    pub run: Option<i64>,
    /// Effects of the model that it is tried in; else the run's baseline.
    #[serde(default)]
    pub effects: Option<Vec<String>>,
    /// The run whose columns the formula may name; nothing is fitted to it.
    #[serde(default)]
    pub columns_of: Option<i64>,
    /// Further runs of the same joint, looked at together with the first.
    #[serde(default)]
    pub more_runs: Vec<i64>,
    /// The formula is still being typed: a mistake in it is told in the answer, instead of refused.
    #[serde(default)]
    pub typing: bool,
}

/// A mistake in a text that a user wrote.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Place {
    /// `formula`, `parameters` or `id`.
    pub field: String,
    pub text: String,
    /// Characters before the mistake.
    pub position: u64,
    /// Characters of the mistake; 0 where something is missing.
    pub length: u64,
    /// What is wrong there, without the rest of the sentence.
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

/// What a formula means.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct EffectCheck {
    /// `null` where there is a mistake.
    pub effect: Option<Effect>,
    /// Of a formula that is still being typed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mistake: Option<Place>,
    /// Units that contradict each other, or a formula of the very thing that is modelled: neither changes a figure.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub doubt: Option<String>,
    /// Parameters that enter linearly.
    pub linear: Vec<String>,
    /// Parameters that are searched for.
    pub shape: Vec<String>,
    /// Signals that the formula names.
    pub signals: Vec<String>,
    /// The effect's parameters on the run; empty where none was named.
    pub parameters: Vec<FittedParameter>,
    /// Effects beside which it was tried and from which the run cannot tell it: of the two it decides only a combination.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub like: Vec<String>,
}

/// A signal that a formula may name.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct FormulaSignal {
    pub name: String,
    pub unit: String,
    pub meaning: String,
}

/// What formulas of a kind are made of.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct FormulaLanguage {
    pub kind: String,
    /// What stands before the equals sign.
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

/// A model on a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Evaluation {
    pub rms: f64,
    pub unit: String,
    pub residual: ResidualKind,
    /// ‖residual‖ / ‖measured‖.
    pub relative_error: f64,
    pub rows: u64,
    pub samples: u64,
    /// Share of the samples that is settled motion, where only that is judged.
    pub settled_share: Option<f64>,
    /// What the error does not say by itself, in plain sentences: columns that are missing, facts that differ from those
    /// of the fit, signals that leave its ranges.
    pub notes: Vec<String>,
}

/// Two model versions side by side.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Comparison {
    pub kind: String,
    /// Effects of the second that the first has not.
    pub added: Vec<String>,
    pub removed: Vec<String>,
    pub parameters: Vec<ParameterPair>,
    /// Both on the same run.
    pub first: Evaluation,
    pub second: Evaluation,
    /// Each on what was held out of its own run.
    pub first_validation_rms: f64,
    pub second_validation_rms: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ParameterPair {
    pub effect: String,
    pub name: String,
    pub unit: String,
    pub first: Option<FittedParameter>,
    pub second: Option<FittedParameter>,
    /// The values are further apart than their intervals allow; `null` where one is missing or has no interval.
    pub differ: Option<bool>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wider: Option<Wider>,
}

/// Why a parameter's interval is much wider in one of two versions.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Wider {
    /// In the second, or in the first.
    pub second: bool,
    pub times: f64,
    pub why: String,
}

/// A version that came in, and what its errors on the run do not say by themselves.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ImportedModel {
    #[serde(flatten)]
    pub model: Model,
    /// As an evaluation tells it: columns that are missing, facts that differ from those of the fit, signals that leave its
    /// ranges.
    pub notes: Vec<String>,
}

/// An exported model that comes in as a version of a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct ModelImport {
    /// The run that the model is held against; its errors become those of the version.
    pub run: i64,
    /// What `GET /models/{id}/export?format=json` gave.
    #[schema(value_type = Object)]
    pub model: Map<String, Value>,
}
