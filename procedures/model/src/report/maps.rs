//! The residual over one or two quantities, for plots.

use crate::report::fit::ResidualKind;
use serde::{Deserialize, Serialize};

/// Every map of a fit on a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ResidualMaps {
    pub residual: ResidualKind,
    /// Unit of every mean and half width.
    pub unit: String,
    pub axes: Vec<AxisMap>,
    pub pairs: Vec<PairMap>,
    /// Regions with a significant residual, the worst first.
    pub regions: Vec<Region>,
}

impl ResidualMaps {
    /// The map of an axis by direction, if there is one.
    pub fn in_each_direction(&self, axis: &AxisMap) -> Option<&PairMap> {
        self.pairs.iter().find(|pair| pair.x == axis.axis && pair.y == "direction")
    }
}

/// Mean residual over one quantity.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct AxisMap {
    /// Column name of the run table, or `direction`, `time_since_reversal_s`, `motor_torque_nm`.
    pub axis: String,
    pub unit: String,
    pub bins: Vec<MapBin>,
    /// Cross-validated R²: share of the squared residual that a function of this quantity removes on data that was
    /// not used for it.
    pub removable_share: f64,
}

/// One bin: mean ± half_width contains the true mean in all bins of all maps simultaneously, with the chosen
/// probability.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct MapBin {
    pub from: f64,
    pub to: f64,
    pub centre: f64,
    pub mean: f64,
    /// `None` with fewer than three independent blocks: shown hatched, without a band.
    pub half_width: Option<f64>,
    pub rows: usize,
}

/// Mean residual over two quantities: a heat map without empty cells.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PairMap {
    pub x: String,
    pub x_unit: String,
    pub y: String,
    pub y_unit: String,
    pub x_bins: Vec<[f64; 2]>,
    pub y_bins: Vec<[f64; 2]>,
    pub cells: Vec<MapCell>,
    /// Cross-validated R²: share of the squared residual that a function of both quantities removes on data that was
    /// not used for it.
    pub removable_share: f64,
}

/// One cell, with its place in `x_bins` and `y_bins`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct MapCell {
    pub x: usize,
    pub y: usize,
    pub mean: f64,
    pub half_width: Option<f64>,
    pub rows: usize,
}

/// A range of an axis (and a direction or a second axis) with a significant residual.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Region {
    pub axis: String,
    pub from: f64,
    pub to: f64,
    pub mean_residual: f64,
    /// Simultaneous over all regions of all maps.
    pub ci95: [f64; 2],
    pub samples: usize,
    /// `positive` or `negative` motion, or both if empty.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub direction: Option<String>,
    /// The same in one sentence with figures.
    pub sentence: String,
}
