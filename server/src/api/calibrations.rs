//! Results that the next runs of a bench use.

use super::extract::{Answer, Created, Json, Path, created};
use super::refusals::Refusals;
use crate::lab::{Caller, Lab};
use crate::view::{Calibration, NewCalibration};
use axum::Extension;
use axum::extract::State;

/// Results applied to the bench, newest first
#[utoipa::path(get, path = "/bench/{bench}/calibrations", operation_id = "list_calibrations", tag = "bench",
    params(("bench" = String, Path, description = "Name")),
    responses((status = 200, description = "All entries; the active ones are marked", body = Vec<Calibration>), Refusals))]
pub async fn list(State(lab): State<Lab>, Path(bench): Path<String>) -> Answer<Vec<Calibration>> {
    Ok(Json(lab.calibrations(&bench).await?))
}

/// Applies the result of a run to the bench for subsequent runs. To revert, apply an earlier one or none
#[utoipa::path(post, path = "/bench/{bench}/calibrations", operation_id = "apply_calibration", tag = "bench",
    params(("bench" = String, Path, description = "Name")), request_body = NewCalibration,
    responses((status = 201, description = "All entries, the new one first", body = Vec<Calibration>), Refusals))]
pub async fn apply(
    State(lab): State<Lab>,
    Extension(caller): Extension<Caller>,
    Path(bench): Path<String>,
    Json(new): Json<NewCalibration>,
) -> Created<Vec<Calibration>> {
    created(lab.calibrate(&bench, &new, &caller.name).await?)
}
