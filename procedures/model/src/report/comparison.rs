//! Comparison of two models.

use crate::report::fit::{Evaluation, Parameter};
use jointbench_instrument::Kind;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Result of `compare`: differences between two models of one kind.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Comparison {
    /// Kind of both models.
    #[schema(value_type = String)]
    pub kind: Kind,
    /// Effects of the second model that the first one lacks.
    pub added: Vec<String>,
    /// Effects of the first model that the second one lacks.
    pub removed: Vec<String>,
    /// Every parameter of either model: those of the first one in its order, then those only in the second one.
    pub parameters: Vec<ParameterPair>,
    /// Both on the same run.
    pub first: Evaluation,
    /// Evaluation of the second model on that run.
    pub second: Evaluation,
    /// Validation error of each model on its own run.
    pub first_validation_rms: f64,
    /// Validation error of the second model on the run that it was fitted to.
    pub second_validation_rms: f64,
}

/// A parameter in two models.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ParameterPair {
    /// Id of the effect that the parameter belongs to.
    pub effect: String,
    /// Name of the parameter within its effect.
    pub name: String,
    /// Unit of both values.
    pub unit: String,
    /// The parameter in the first model. Absent if that model lacks it.
    pub first: Option<Parameter>,
    /// The parameter in the second model. Absent if that model lacks it.
    pub second: Option<Parameter>,
    /// Whether the values differ by more than their intervals allow. Absent if one is missing or has no interval.
    pub differ: Option<bool>,
    /// Present if one interval is much wider than the other.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wider: Option<WiderInterval>,
}

/// Why a parameter is less certain in one of two models.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = Wider)]
pub struct WiderInterval {
    /// Whether the second model has the wider interval.
    pub second: bool,
    /// Ratio of the wider interval to the narrower one, above 1.
    pub times: f64,
    /// The reason in words: a trade-off, fewer rows, a larger residual or more parameters.
    pub why: String,
}
