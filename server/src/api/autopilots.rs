//! Recommended runs and autopilots.

use super::extract::{Answer, Created, Json, Path, created};
use super::refusals::Refusals;
use crate::lab::{Caller, Lab};
use crate::view::{Autopilot, NewAutopilot, NewExperiment};
use axum::Extension;
use axum::extract::State;

/// Measures, diagnoses, adds missing effects or performs the recommended run, until no effect is missing or the budget
/// is used up
#[utoipa::path(post, path = "/autopilots", operation_id = "start_autopilot", tag = "autopilots", request_body = NewAutopilot,
    responses((status = 201, description = "The started autopilot", body = Autopilot), Refusals))]
pub async fn start(
    State(lab): State<Lab>,
    Extension(caller): Extension<Caller>,
    Json(new): Json<NewAutopilot>,
) -> Created<Autopilot> {
    created(lab.start_autopilot(&new, &caller.name).await?)
}

/// Performs the run that a diagnosis recommends and diagnoses the same model with all its runs
#[utoipa::path(post, path = "/diagnoses/{id}/experiment", operation_id = "start_experiment", tag = "autopilots",
    params(("id" = i64, Path, description = "Diagnosis")), request_body = NewExperiment,
    responses((status = 201, description = "An autopilot that performs this run", body = Autopilot), Refusals))]
pub async fn experiment(
    State(lab): State<Lab>,
    Extension(caller): Extension<Caller>,
    Path(id): Path<i64>,
    Json(new): Json<NewExperiment>,
) -> Created<Autopilot> {
    created(lab.start_experiment(id, &new, &caller.name).await?)
}

/// All autopilots, newest first
#[utoipa::path(get, path = "/autopilots", operation_id = "list_autopilots", tag = "autopilots",
    responses((status = 200, description = "The autopilots", body = Vec<Autopilot>), Refusals))]
pub async fn list(State(lab): State<Lab>) -> Answer<Vec<Autopilot>> {
    Ok(Json(lab.autopilots().await?))
}

/// One autopilot with all steps so far
#[utoipa::path(get, path = "/autopilots/{id}", operation_id = "get_autopilot", tag = "autopilots",
    params(("id" = i64, Path, description = "Autopilot")),
    responses((status = 200, description = "The autopilot", body = Autopilot), Refusals))]
pub async fn get(State(lab): State<Lab>, Path(id): Path<i64>) -> Answer<Autopilot> {
    Ok(Json(lab.autopilot(id).await?))
}

/// Ends an autopilot after the current step; an active run ends early and is kept
#[utoipa::path(post, path = "/autopilots/{id}/stop", operation_id = "stop_autopilot", tag = "autopilots",
    params(("id" = i64, Path, description = "Autopilot")),
    responses((status = 200, description = "Accepted; present state of the autopilot", body = Autopilot), Refusals))]
pub async fn stop(
    State(lab): State<Lab>,
    Extension(caller): Extension<Caller>,
    Path(id): Path<i64>,
) -> Answer<Autopilot> {
    Ok(Json(lab.stop_autopilot(id, &caller.name).await?))
}
