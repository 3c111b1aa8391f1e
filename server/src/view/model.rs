//! Model versions and their residuals.

use super::{Fit, ParameterSetting, ResidualKind};
use jointbench_files::{Dimension, dimension_of};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use utoipa::ToSchema;

/// A model to fit: a run and a set of effects.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(example = json!({"run": 1, "effects": ["inertia", "coulomb", "viscous"]}))]
pub struct NewModel {
    pub run: i64,
    /// Further runs of the same kind and joint for a combined fit, in chronological order.
    #[serde(default)]
    pub more_runs: Vec<i64>,
    pub effects: Vec<String>,
    /// Parent version.
    #[serde(default)]
    pub parent: Option<i64>,
    /// Intervals to exclude from the fit; those of the parent if omitted.
    #[serde(default)]
    pub exclude: Option<Vec<Exclusion>>,
    /// Fixed values, bounds and start values of parameters; those of the parent for the same effects if omitted.
    #[serde(default)]
    pub parameters: Option<Vec<ParameterSetting>>,
    /// Trial: the version is not listed as a model until it is kept.
    #[serde(default)]
    pub tried: bool,
}

/// An interval of a measurement that is excluded from the fit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Exclusion {
    /// Time since the first sample of the combined runs, both ends included.
    pub from_s: f64,
    pub to_s: f64,
    /// Reason given by the user.
    pub reason: String,
}

impl NewModel {
    /// A regular version with all parameters free; the first run is that of the version.
    pub fn free(runs: &[i64], effects: &[String], parent: Option<i64>) -> Self {
        Self {
            run: runs.first().copied().unwrap_or_default(),
            more_runs: runs.iter().skip(1).copied().collect(),
            effects: effects.to_vec(),
            parent,
            exclude: None,
            parameters: Some(Vec::new()),
            tried: false,
        }
    }

    /// Every run to look at, in order.
    pub fn runs(&self) -> Vec<i64> {
        std::iter::once(self.run).chain(self.more_runs.iter().copied()).collect()
    }
}

/// One version of a model: a node of a tree that only grows. Going back means going to the parent.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Model {
    pub id: i64,
    pub run: i64,
    /// Further runs of the fit.
    pub more_runs: Vec<i64>,
    /// Intervals excluded from the fit.
    pub excluded: Vec<Exclusion>,
    pub kind: String,
    pub parent: Option<i64>,
    /// Effects that the parent does not have; all of them without a parent.
    pub added: Vec<String>,
    pub removed: Vec<String>,
    pub effects: Vec<String>,
    pub fit: Fit,
    pub residual: ResidualKind,
    /// Validation error (cross-validated RMS).
    pub validation_rms: f64,
    pub rms: f64,
    pub noise_floor_rms: Option<f64>,
    /// Not significant: reduces the validation error of its parent by less than 0.5 % and was not kept by a user.
    pub idle: bool,
    /// Trial version that was not kept.
    #[serde(default)]
    #[schema(required = true)]
    pub tried: bool,
    /// Who made it: name of the token, or `local`.
    pub by: Option<String>,
    #[schema(format = DateTime)]
    pub created_at: String,
    /// Filter and decimation settings of the fit.
    #[schema(value_type = Object)]
    pub options: Map<String, Value>,
}

/// Contribution of an effect to a version, independent of the order of the effects.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Worth {
    pub effect: String,
    /// Validation error without the effect, the others refitted; `null` if they cannot be fitted.
    pub without_rms: Option<f64>,
    /// Why there is no figure.
    pub reason: Option<String>,
}

/// Residuals of a run for a model version. All lists have the same length.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ResidualSet {
    pub residual: ResidualKind,
    pub unit: String,
    /// Coordinates of the points: velocity, position, load, temperature, time, direction, …
    pub axes: Vec<ResidualAxis>,
    pub measured: Vec<f64>,
    pub predicted: Vec<f64>,
    /// measured − predicted.
    pub error: Vec<f64>,
    /// Points outside the fit (ramps, reversals): shown, not evaluated.
    pub held_out: Vec<bool>,
    /// Points that a user excluded from the fit; empty without exclusions.
    #[serde(default)]
    #[schema(required)]
    pub excluded: Vec<bool>,
    pub segment: Vec<i64>,
    pub repeat: Vec<i64>,
    /// Number of the independent block of each point, used for the bands.
    pub piece: Vec<usize>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ResidualAxis {
    /// Column of the run table, or `direction`, `run_order`.
    pub name: String,
    pub kind: AxisKind,
    pub unit: String,
    pub values: Vec<f64>,
}

/// The quantity of an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum AxisKind {
    Time,
    /// A count: the order of runs, or a repeat.
    Order,
    /// The sign of the motion.
    Direction,
    Position,
    Velocity,
    Temperature,
    Current,
    /// Torque or force, except the predicted one.
    Load,
    /// The torque that the model predicts.
    Response,
    Other,
}

impl AxisKind {
    /// The kind of a column of the run table, from its name and the unit in its name.
    pub fn of(column: &str) -> Self {
        match column {
            "direction" => return Self::Direction,
            "run_order" | "repeat" | "segment" => return Self::Order,
            "motor_torque_nm" => return Self::Response,
            _ => {}
        }
        match dimension_of(column) {
            Some(Dimension::Time) => Self::Time,
            Some(Dimension::Angle | Dimension::Length) => Self::Position,
            Some(Dimension::AngularVelocity | Dimension::Velocity) => Self::Velocity,
            Some(Dimension::Torque | Dimension::Force) => Self::Load,
            Some(Dimension::Current) => Self::Current,
            Some(Dimension::Temperature) => Self::Temperature,
            Some(Dimension::Other) | None => Self::Other,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_axis_has_the_kind_of_its_column() {
        let kinds = [
            ("time_s", AxisKind::Time),
            ("run_order", AxisKind::Order),
            ("direction", AxisKind::Direction),
            ("link_position_rad", AxisKind::Position),
            ("motor_velocity_rad_s", AxisKind::Velocity),
            ("temperature_c", AxisKind::Temperature),
            ("housing_temperature_c", AxisKind::Temperature),
            ("brake_current_a", AxisKind::Current),
            ("link_torque_nm", AxisKind::Load),
            ("motor_torque_nm", AxisKind::Response),
            ("oil_pressure_pa", AxisKind::Other),
            ("acceleration_rad_s2", AxisKind::Other),
        ];
        for (column, kind) in kinds {
            assert_eq!(AxisKind::of(column), kind, "{column}");
        }
    }
}
