//! Benches and their instruments.

use super::extract::{Answer, Json, Path};
use super::problem::Refusals;
use crate::lab::Lab;
use crate::view::{Acknowledgement, Bench, Instrument};
use axum::extract::State;

/// All benches of this daemon
#[utoipa::path(get, path = "/bench", operation_id = "list_benches", tag = "bench",
    responses((status = 200, description = "The benches", body = Vec<Bench>), Refusals))]
pub async fn list(State(lab): State<Lab>) -> Answer<Vec<Bench>> {
    Ok(Json(lab.benches()))
}

/// One bench
#[utoipa::path(get, path = "/bench/{bench}", operation_id = "get_bench", tag = "bench", params(("bench" = String, Path, description = "Name")),
    responses((status = 200, description = "The bench", body = Bench), Refusals))]
pub async fn get(State(lab): State<Lab>, Path(bench): Path<String>) -> Answer<Bench> {
    Ok(Json(lab.bench(&bench)?))
}

/// Software stop: ends the run at once and secures the bench
///
/// Answers when the bench thread has taken the command. It is no replacement for a hardware stop.
#[utoipa::path(post, path = "/bench/{bench}/stop", operation_id = "stop_bench", tag = "bench",
    params(("bench" = String, Path, description = "Name")),
    responses((status = 200, description = "Taken; the bench as it is now", body = Bench), Refusals))]
pub async fn stop(State(lab): State<Lab>, Path(bench): Path<String>) -> Answer<Bench> {
    Ok(Json(lab.emergency_stop(&bench).await?))
}

/// Lifts the block after an end that could not be verified as safe
#[utoipa::path(post, path = "/bench/{bench}/acknowledge", tag = "bench",
    params(("bench" = String, Path, description = "Name")), request_body = Acknowledgement,
    responses((status = 200, description = "The bench, ready again", body = Bench), Refusals))]
pub async fn acknowledge(
    State(lab): State<Lab>,
    Path(bench): Path<String>,
    Json(word): Json<Acknowledgement>,
) -> Answer<Bench> {
    Ok(Json(lab.acknowledge(&bench, &word.reason).await?))
}

/// The instruments of all benches
#[utoipa::path(get, path = "/instruments", tag = "bench",
    responses((status = 200, description = "The instruments", body = Vec<Instrument>), Refusals))]
pub async fn instruments(State(lab): State<Lab>) -> Answer<Vec<Instrument>> {
    Ok(Json(lab.benches().into_iter().flat_map(|bench| bench.instruments).collect()))
}
