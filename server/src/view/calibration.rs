//! Calibrations of a bench.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Subsequent runs of a bench use the result of this run.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct Calibration {
    pub id: i64,
    /// Procedure whose result is applied: `brake_hysteresis`, `torque_sensor_zero` or `friction`.
    pub procedure: String,
    /// `null`: no specific run. The brake then uses the latest complete one, the others none.
    pub run: Option<i64>,
    /// Name of the token, or `local`.
    pub by: String,
    #[schema(format = DateTime)]
    pub at: String,
    /// Still active, not replaced by a later one.
    pub holds: bool,
}

#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct NewCalibration {
    pub procedure: String,
    /// A complete run of the bench with an identified result; `null` reverts to no applied result.
    pub run: Option<i64>,
}
