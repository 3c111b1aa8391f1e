//! The residual with all quantities that it may depend on, for plots of the workbench.

use crate::report::fit::ResidualKind;
use serde::{Deserialize, Serialize};

/// A quantity that the residual may depend on, one value for each point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Axis {
    /// Column name of the run table, or `direction`, `run_order`.
    pub name: String,
    pub unit: String,
    pub values: Vec<f64>,
}

/// Measured and predicted values at the points of the fit. All lists have the same length.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ResidualSet {
    pub residual: ResidualKind,
    pub unit: String,
    pub axes: Vec<Axis>,
    pub measured: Vec<f64>,
    pub predicted: Vec<f64>,
    /// measured − predicted.
    pub error: Vec<f64>,
    /// Points that are not part of the fit (ramps, reversals): shown, but not judged.
    pub held_out: Vec<bool>,
    pub segment: Vec<i64>,
    pub repeat: Vec<i64>,
    /// Independent blocks of the run, numbered in their order; the bands are based on them.
    pub piece: Vec<usize>,
}
