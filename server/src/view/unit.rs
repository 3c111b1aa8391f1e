//! Units under test.

use super::{Identified, LimitOutcome};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use utoipa::ToSchema;

/// A unit with its results. Part, revision and batch are those of the newest run that names them.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct UnitSummary {
    pub serial: String,
    pub part: Option<String>,
    pub revision: Option<String>,
    pub batch: Option<String>,
    /// A reference unit, which yields and control charts exclude.
    pub reference: bool,
    /// Number of runs, in any state.
    pub runs: u64,
    /// Verdict of the first complete run.
    pub first_verdict: Option<Identified>,
    /// Verdict of the newest complete run.
    pub newest_verdict: Option<Identified>,
    /// Whether that run meets its limits; `null` without limits.
    pub newest_limits: Option<LimitOutcome>,
    pub newest_run: i64,
    /// Start of the newest run.
    #[schema(format = DateTime)]
    pub newest_at: String,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum YieldGroup {
    /// All units of a part.
    Part,
    /// All units of a revision of a part.
    Revision,
    /// All units of a batch of a revision of a part.
    Batch,
}

/// Whether a unit is a reference.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct UnitReference {
    /// Yields and control charts exclude reference units.
    pub reference: bool,
}

/// First-pass yield: the fraction of units whose first complete run of a procedure was identified, with or without a
/// warning, and meets all its limits. A unit counts with the part, revision and batch of that run. Stopped and failed runs do not count.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct FirstPassYield {
    pub group: YieldGroup,
    pub part: Option<String>,
    /// `null` for a group by part.
    pub revision: Option<String>,
    /// `null` for a group by part or by revision.
    pub batch: Option<String>,
    pub procedure: String,
    /// Number of units with such a run.
    pub units: u64,
    /// Number of units that passed.
    pub passed: u64,
    /// `passed / units`.
    pub fraction: f64,
    /// Wilson interval of the fraction.
    pub ci95: [f64; 2],
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct UnitList {
    /// Number of units that match the search.
    pub total: u64,
    /// The units with the newest runs first, at most 1000.
    pub units: Vec<UnitSummary>,
    /// Of all units that match the search, without reference units.
    pub yields: Vec<FirstPassYield>,
    /// Ignored terms of an incomplete search.
    pub unclear: Option<String>,
}

/// What changed since the previous complete run of the same unit and procedure.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct UnitChanges {
    pub unit: String,
    pub previous_run: i64,
    /// Earlier runs with the same settings, which the prediction intervals are from.
    pub comparable_runs: usize,
    /// Parameters that differ from the previous run.
    pub settings: Vec<SettingChange>,
    /// Mean temperature of the previous run.
    pub previous_temperature_c: Option<f64>,
    /// Mean temperature of this run.
    pub temperature_c: Option<f64>,
    pub quantities: Vec<QuantityChange>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct SettingChange {
    pub parameter: String,
    pub previous: Value,
    pub present: Value,
}

/// The change of one quantity, in its unit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct QuantityChange {
    pub name: String,
    pub symbol: String,
    pub title: String,
    /// SI symbol; empty for a fraction or a count.
    pub unit: String,
    pub previous: f64,
    pub present: f64,
    /// 95 % interval of the change, from the intervals of both results.
    #[schema(value_type = Option<Vec<f64>>, min_items = 2, max_items = 2)]
    pub change_ci95: Option<[f64; 2]>,
    /// 95 % prediction interval of this run from the earlier runs of the unit, at its temperature. `null` with fewer than
    /// three comparable runs.
    #[schema(value_type = Option<Vec<f64>>, min_items = 2, max_items = 2)]
    pub prediction95: Option<[f64; 2]>,
    /// Whether the prediction interval follows the temperature.
    pub follows_temperature: bool,
}
