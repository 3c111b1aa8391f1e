//! The residual over one or two quantities, for plots.

use crate::report::fit::ResidualKind;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Every map of a fit on a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ResidualMaps {
    /// Data of the residual.
    pub residual: ResidualKind,
    /// Unit of every mean and half width.
    pub unit: String,
    /// One map for each axis whose quantity changes in the run.
    pub axes: Vec<AxisMap>,
    /// Maps of each axis by direction, and of selected pairs of axes.
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
    /// Unit of the axis, `1` if dimensionless.
    pub unit: String,
    /// Bins with rows, in ascending order; their ranges may have gaps.
    pub bins: Vec<MapBin>,
    /// Cross-validated R²: fraction of the squared residual that a function of this quantity removes on data that was
    /// not used for it.
    pub removable_share: f64,
}

/// One bin: mean ± half_width contains the true mean in all bins of all maps simultaneously, with the chosen
/// probability.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct MapBin {
    /// Smallest value of the quantity in the bin.
    pub from: f64,
    /// Largest value of the quantity in the bin.
    pub to: f64,
    /// Mean value of the quantity in the bin.
    pub centre: f64,
    /// Mean residual (measured − predicted) of the rows in the bin.
    pub mean: f64,
    /// Absent with fewer than three independent blocks: shown hatched, without a band.
    pub half_width: Option<f64>,
    /// Number of rows in the bin.
    pub rows: usize,
}

/// Mean residual over two quantities: a heat map without empty cells.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct PairMap {
    /// Name of the horizontal axis, as in the map of one axis.
    pub x: String,
    /// Unit of the horizontal axis.
    pub x_unit: String,
    /// Name of the vertical axis.
    pub y: String,
    /// Unit of the vertical axis.
    pub y_unit: String,
    /// Smallest and largest value in each bin of the horizontal axis.
    #[schema(value_type = Vec<Vec<f64>>)]
    pub x_bins: Vec<[f64; 2]>,
    /// Smallest and largest value in each bin of the vertical axis.
    #[schema(value_type = Vec<Vec<f64>>)]
    pub y_bins: Vec<[f64; 2]>,
    /// Cells with rows, in the order of x, then y.
    pub cells: Vec<MapCell>,
    /// Cross-validated R²: fraction of the squared residual that a function of both quantities removes on data that was
    /// not used for it.
    pub removable_share: f64,
}

/// One cell, with its place in `x_bins` and `y_bins`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct MapCell {
    /// Index of the bin in `x_bins`.
    pub x: usize,
    /// Index of the bin in `y_bins`.
    pub y: usize,
    /// Mean residual (measured − predicted) of the rows in the cell.
    pub mean: f64,
    /// Half width of the simultaneous band. Absent with fewer than three independent blocks.
    pub half_width: Option<f64>,
    /// Number of rows in the cell.
    pub rows: usize,
}

/// A range of an axis (and a direction or a second axis) with a significant residual.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Region {
    /// Column name of the run table, or `direction`, `time_since_reversal_s`, `motor_torque_nm`.
    pub axis: String,
    /// Smallest value of the axis in the region.
    pub from: f64,
    /// Largest value of the axis in the region.
    pub to: f64,
    /// Mean of measured − predicted: positive where the model is too low.
    pub mean_residual: f64,
    /// Simultaneous over all regions of all maps.
    #[schema(value_type = Vec<f64>, min_items = 2, max_items = 2)]
    pub ci95: [f64; 2],
    /// Number of rows in the region.
    pub samples: usize,
    /// `positive` or `negative` motion, or both if empty.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub direction: Option<String>,
    /// The same in one sentence with figures.
    pub sentence: String,
}
