//! What was applied to a bench.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// From here on the next runs of a bench use the result of this run.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct Calibration {
    pub id: i64,
    /// Whose results take each other's place: `brake_hysteresis`, `torque_sensor_zero` or `friction`.
    pub procedure: String,
    /// `null`: none in particular. For the brake the last complete one counts then, for the others none.
    pub run: Option<i64>,
    /// Name of the token, or `local`.
    pub by: String,
    #[schema(format = DateTime)]
    pub at: String,
    /// No later one has taken its place.
    pub holds: bool,
}

#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct NewCalibration {
    pub procedure: String,
    /// A complete run of the bench that has identified what it was made for; `null` takes back what was applied.
    pub run: Option<i64>,
}
