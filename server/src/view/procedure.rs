//! Procedures and what they would do.

use super::{Check, Extreme, PlannedStep, Setpoints};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use utoipa::ToSchema;

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Procedure {
    pub id: String,
    pub title: String,
    pub summary: String,
    /// The kind of the run table.
    pub kind: String,
    pub parameters: Vec<ProcedureParameter>,
    /// Why the requested bench cannot run it with its defaults; absent if it can, or without a bench.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub refused: Option<ProcedureRefusal>,
}

/// Why a bench cannot run a procedure.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct ProcedureRefusal {
    pub reason: RefusalReason,
    /// Cause and remedy.
    pub text: String,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum RefusalReason {
    /// The bench lacks an instrument.
    MissingInstrument,
    /// A default is out of its range.
    Parameter,
    /// The defaults and facts of the bench exclude each other.
    Contradiction,
    /// The dry run exceeds a limit of the bench.
    Limit,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ProcedureParameter {
    pub name: String,
    pub title: String,
    /// SI symbol; empty for a fraction or a count.
    pub unit: String,
    /// Without meaning for a curve, which is empty by default.
    pub default: f64,
    pub min: f64,
    pub max: f64,
    #[serde(rename = "type")]
    pub type_: ParameterType,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum ParameterType {
    Number,
    Integer,
    /// A number relative to a rated or to a whole value. The API takes the fraction, pages show percent.
    Fraction,
    /// A list of pairs of a time in s, from 0 and rising, and a value.
    Curve,
}

/// A procedure on a bench, to preview or to run. Omitted parameters take their defaults.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct PreviewRequest {
    pub bench: String,
    #[serde(default)]
    #[schema(value_type = Object)]
    pub parameters: Map<String, Value>,
}

/// A dry run without motion.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Preview {
    /// On the bench's clock.
    pub duration_s: f64,
    /// In wall-clock time; absent for a mock bench without pace.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wait_s: Option<f64>,
    pub steps: Vec<PlannedStep>,
    /// Maximum values of the plan against the limits of the bench.
    pub extremes: Vec<Extreme>,
    pub setpoints: Setpoints,
    /// A condition for the start; a failed one states its remedy.
    pub checks: Vec<Check>,
}
