//! Benches and their instruments.

use super::extract::{Answer, Json, Path, Query};
use super::problem::Problem;
use super::refusals::Refusals;
use crate::lab::{Caller, Lab, names};
use crate::view::{Acknowledgement, Bench, Instrument, SafetyEntry, ServoMemory};
use axum::Extension;
use axum::extract::State;
use serde::Deserialize;
use utoipa::IntoParams;

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

/// Software stop: ends the run immediately and secures the bench, which stays `stopped` until it is reset
///
/// Responds when the bench worker has accepted the command and the stop is stored. It does not replace a hardware stop.
#[utoipa::path(post, path = "/bench/{bench}/stop", operation_id = "stop_bench", tag = "bench",
    params(("bench" = String, Path, description = "Name")),
    responses((status = 200, description = "Accepted; present state of the bench", body = Bench), Refusals))]
pub async fn stop(
    State(lab): State<Lab>,
    Extension(caller): Extension<Caller>,
    Path(bench): Path<String>,
) -> Answer<Bench> {
    Ok(Json(lab.emergency_stop(&bench, &caller.name).await?))
}

/// Resets the bench after a software stop or after a run whose safe state is not confirmed
#[utoipa::path(post, path = "/bench/{bench}/acknowledge", operation_id = "acknowledge_bench", tag = "bench",
    params(("bench" = String, Path, description = "Name")), request_body = Acknowledgement,
    responses((status = 200, description = "The released bench", body = Bench), Refusals))]
pub async fn acknowledge(
    State(lab): State<Lab>,
    Extension(caller): Extension<Caller>,
    Path(bench): Path<String>,
    Json(word): Json<Acknowledgement>,
) -> Answer<Bench> {
    let reason = names::checked_text("reason", &word.reason, names::LONGEST_SENTENCE)?;
    Ok(Json(lab.acknowledge(&bench, reason, &caller.name).await?))
}

/// Reconnects the instruments that are not ready
#[utoipa::path(post, path = "/bench/{bench}/retry", operation_id = "retry_instruments", tag = "bench",
    params(("bench" = String, Path, description = "Name")),
    responses((status = 200, description = "Present state of the bench", body = Bench), Refusals))]
pub async fn retry(State(lab): State<Lab>, Path(bench): Path<String>) -> Answer<Bench> {
    Ok(Json(lab.retry(&bench).await?))
}

/// The text of the bench description (TOML) that the daemon was started with
#[utoipa::path(get, path = "/bench/{bench}/description", operation_id = "get_bench_description", tag = "bench",
    params(("bench" = String, Path, description = "Name")),
    responses((status = 200, description = "The description", body = String), Refusals))]
pub async fn description(State(lab): State<Lab>, Path(bench): Path<String>) -> Result<String, Problem> {
    Ok(lab.handle(&bench)?.description().text.clone())
}

/// Stops, blocks and resets of the bench with user and reason, newest first
#[utoipa::path(get, path = "/bench/{bench}/safety", operation_id = "get_bench_safety", tag = "bench",
    params(("bench" = String, Path, description = "Name")),
    responses((status = 200, description = "The newest entries", body = Vec<SafetyEntry>), Refusals))]
pub async fn safety(State(lab): State<Lab>, Path(bench): Path<String>) -> Answer<Vec<SafetyEntry>> {
    Ok(Json(lab.safety(&bench).await?))
}

/// The instruments of all benches
#[utoipa::path(get, path = "/instruments", operation_id = "list_instruments", tag = "bench",
    responses((status = 200, description = "The instruments", body = Vec<Instrument>), Refusals))]
pub async fn instruments(State(lab): State<Lab>) -> Answer<Vec<Instrument>> {
    Ok(Json(lab.benches().into_iter().flat_map(|bench| bench.instruments).collect()))
}

#[derive(Debug, Clone, Default, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(default, deny_unknown_fields)]
pub struct MemoryQuery {
    /// Only the variable at this address; all if omitted.
    #[param(maximum = 127)]
    pub address: Option<u8>,
}

/// The memory of the joint's servo (DIAGREAD), for a Puma-type servo; only between runs, and without motion
#[utoipa::path(get, path = "/bench/{bench}/servo-memory", operation_id = "read_servo_memory", tag = "bench",
    params(("bench" = String, Path, description = "Name"), MemoryQuery),
    responses((status = 200, description = "The variables of the memory", body = ServoMemory),
        (status = 409, description = "A run is in progress: wait until it ends, or stop it", body = Problem,
            content_type = "application/problem+json"),
        Refusals))]
pub async fn servo_memory(
    State(lab): State<Lab>,
    Path(bench): Path<String>,
    Query(query): Query<MemoryQuery>,
) -> Answer<ServoMemory> {
    Ok(Json(lab.servo_memory(&bench, query.address).await?))
}
