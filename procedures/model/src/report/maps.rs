//! The residual over one quantity or two, ready to be drawn.

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
    /// Where the residual is not noise, the worst first.
    pub regions: Vec<Region>,
}

impl ResidualMaps {
    /// The map of an axis in each direction, where it has one.
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
    /// Share of the squared residual that a function of this quantity alone takes off data that it was not made from.
    pub removable_share: f64,
}

/// One bin: mean ± half_width holds the true mean in all bins of all maps at once with the chosen certainty.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct MapBin {
    pub from: f64,
    pub to: f64,
    pub centre: f64,
    pub mean: f64,
    /// `None` where fewer than three independent pieces of the run pass: to be hatched, not judged.
    pub half_width: Option<f64>,
    pub rows: usize,
}

/// Mean residual over two quantities: a heat map. Cells without rows are left out.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PairMap {
    pub x: String,
    pub x_unit: String,
    pub y: String,
    pub y_unit: String,
    pub x_bins: Vec<[f64; 2]>,
    pub y_bins: Vec<[f64; 2]>,
    pub cells: Vec<MapCell>,
    /// Share of the squared residual that a function of the two takes off data that it was not made from.
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

/// A stretch of an axis (and a direction or a second axis) in which the residual is not noise.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Region {
    pub axis: String,
    pub from: f64,
    pub to: f64,
    pub mean_residual: f64,
    /// Simultaneous over all regions of all maps.
    pub ci95: [f64; 2],
    pub samples: usize,
    /// `positive` or `negative` motion, or both where empty.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub direction: Option<String>,
    /// The same in one sentence with figures.
    pub sentence: String,
}
