//! Comparison of two models.

use crate::report::fit::{Evaluation, Parameter};
use jointbench_instrument::Kind;
use serde::{Deserialize, Serialize};

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Comparison {
    pub kind: Kind,
    /// Effects of the second model that the first one lacks.
    pub added: Vec<String>,
    pub removed: Vec<String>,
    pub parameters: Vec<ParameterPair>,
    /// Both on the same run.
    pub first: Evaluation,
    pub second: Evaluation,
    /// Validation error of each model on its own run.
    pub first_validation_rms: f64,
    pub second_validation_rms: f64,
}

/// A parameter in two models.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ParameterPair {
    pub effect: String,
    pub name: String,
    pub unit: String,
    pub first: Option<Parameter>,
    pub second: Option<Parameter>,
    /// Whether the values differ by more than their intervals allow. `None` if one is missing or has no interval.
    pub differ: Option<bool>,
    /// Present if one interval is much wider than the other.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wider: Option<Wider>,
}

/// Why a parameter is less certain in one of two models.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Wider {
    /// Whether the second model has the wider interval.
    pub second: bool,
    pub times: f64,
    pub why: String,
}
