//! The residual with all quantities that it may depend on, for plots of the workbench.

use crate::report::fit::ResidualKind;
use serde::{Deserialize, Serialize};

/// A quantity that the residual may depend on, one value for each point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Axis {
    /// Column name of the run table, or `direction`, `run_order`.
    pub name: String,
    /// Unit of the values, `1` if dimensionless.
    pub unit: String,
    /// Value at each point, in the order of [`ResidualSet::measured`].
    pub values: Vec<f64>,
}

/// Measured and predicted values at the points of the fit. All lists have the same length.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ResidualSet {
    /// Data of the residual: steady-state means or filtered samples.
    pub residual: ResidualKind,
    /// Unit of `measured`, `predicted` and `error`.
    pub unit: String,
    /// Quantities of the run, the most important first.
    pub axes: Vec<Axis>,
    /// Measured response.
    pub measured: Vec<f64>,
    /// Predicted response, with nuisance terms if the fit has them.
    pub predicted: Vec<f64>,
    /// measured − predicted.
    pub error: Vec<f64>,
    /// Points that are not part of the fit (ramps, reversals): shown, but not judged.
    pub held_out: Vec<bool>,
    /// Number of the segment of each point.
    pub segment: Vec<i64>,
    /// Number of the repeat of each point.
    pub repeat: Vec<i64>,
    /// Independent blocks of the run, numbered in their order; the bands are based on them.
    pub piece: Vec<usize>,
}
