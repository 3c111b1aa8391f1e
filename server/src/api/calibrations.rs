//! Results that the next runs of a bench use.

use super::extract::{Answer, Created, Json, Path, created};
use super::problem::Refusals;
use crate::lab::{Caller, Lab};
use crate::view::{Calibration, NewCalibration};
use axum::Extension;
use axum::extract::State;

/// What was applied to the bench, newest first
#[utoipa::path(get, path = "/bench/{bench}/calibrations", operation_id = "list_calibrations", tag = "bench",
    params(("bench" = String, Path, description = "Name")),
    responses((status = 200, description = "Every entry; those that hold say so", body = Vec<Calibration>), Refusals))]
pub async fn list(State(lab): State<Lab>, Path(bench): Path<String>) -> Answer<Vec<Calibration>> {
    Ok(Json(lab.calibrations(&bench).await?))
}

/// Applies the result of a run to the bench: the next runs use it. An earlier one again, or none, is the way back
#[utoipa::path(post, path = "/bench/{bench}/calibrations", operation_id = "calibrate", tag = "bench",
    params(("bench" = String, Path, description = "Name")), request_body = NewCalibration,
    responses((status = 201, description = "Every entry, the new one first", body = Vec<Calibration>), Refusals))]
pub async fn apply(
    State(lab): State<Lab>,
    Extension(caller): Extension<Caller>,
    Path(bench): Path<String>,
    Json(new): Json<NewCalibration>,
) -> Created<Vec<Calibration>> {
    created(lab.calibrate(&bench, &new, &caller.name).await?)
}
