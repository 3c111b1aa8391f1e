//! Statistics of one quantity over units.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Rules of the Western Electric handbook (1956) for points beyond chance. σ is the standard deviation between
/// successive units.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum ControlRule {
    /// The point is beyond 3 σ.
    BeyondThreeSigma,
    /// Of three successive points, the last of which is this one, two are beyond 2 σ on one side.
    TwoOfThreeBeyondTwoSigma,
    /// Of five successive points, four are beyond 1 σ on one side.
    FourOfFiveBeyondOneSigma,
    /// Eight successive points are on one side of the mean.
    EightOnOneSide,
}

/// A unit with the quantity of its newest complete run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ControlPoint {
    pub unit: String,
    pub batch: Option<String>,
    pub run: i64,
    #[schema(format = DateTime)]
    pub created_at: String,
    pub value: f64,
    /// 95 % interval of the value.
    #[schema(value_type = Option<Vec<f64>>, min_items = 2, max_items = 2)]
    pub ci95: Option<[f64; 2]>,
    /// Rules that this point violates.
    pub violates: Vec<ControlRule>,
}

/// Capability indices of the units. The scatter between units excludes the uncertainty of each value, and the intervals
/// include it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Capability {
    /// Limits of the newest run that has them, in the unit of the quantity.
    pub lower: Option<f64>,
    pub upper: Option<f64>,
    /// Standard deviation between units.
    pub deviation: f64,
    #[schema(value_type = Vec<f64>, min_items = 2, max_items = 2)]
    pub deviation_ci95: [f64; 2],
    /// `(upper − lower) / 6 σ`; absent with one limit, or if the units do not differ beyond their uncertainty.
    pub cp: Option<f64>,
    /// 95 % interval. A `null` as upper end means that the values do not bound it.
    pub cp_ci95: Option<(f64, Option<f64>)>,
    /// Distance of the mean to the nearer limit, divided by 3 σ.
    pub cpk: Option<f64>,
    pub cpk_ci95: Option<(f64, Option<f64>)>,
}

/// Why a chart has no points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum EmptyChart {
    /// No unit of the search, without reference units, has a result of this procedure.
    NoRun,
    /// These results have other quantities.
    NoQuantity,
}

/// A quantity of these runs, for a choice.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct QuantityTitle {
    pub name: String,
    /// Its title in the newest run.
    pub title: String,
}

/// Individuals chart of a quantity.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ControlChart {
    pub procedure: String,
    /// Name, symbol, title and unit of the quantity. Without points: the requested name, and no unit.
    pub quantity: String,
    pub symbol: String,
    pub title: String,
    pub unit: String,
    /// In the order of their runs, at most 500.
    pub points: Vec<ControlPoint>,
    /// Why there are no points; `null` with points.
    pub empty: Option<EmptyChart>,
    /// `null` without points.
    pub mean: Option<f64>,
    /// σ from the mean moving range of successive units; `null` for fewer than two.
    pub sigma: Option<f64>,
    /// Control limits, mean ± 3 σ.
    #[schema(value_type = Option<Vec<f64>>, min_items = 2, max_items = 2)]
    pub control_limits: Option<[f64; 2]>,
    /// Absent without limits, or with fewer than five values with an interval.
    pub capability: Option<Capability>,
    /// The quantities that these runs have, by name.
    pub quantities: Vec<QuantityTitle>,
    /// Runs whose results are not computed yet: repeat the request.
    pub pending: u64,
}
