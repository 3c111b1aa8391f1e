//! The archive of ended runs, and the removal of archived samples from the store.

use super::extract::{Answer, Json, Path, Query};
use super::refusals::Refusals;
use crate::lab::{Caller, Lab};
use crate::view::{ArchiveState, ArchivedTable};
use axum::Extension;
use axum::extract::State;
use serde::Deserialize;
use utoipa::IntoParams;

/// The archive, with the number of tables that wait
#[utoipa::path(get, path = "/archive", operation_id = "get_archive", tag = "daemon",
    responses((status = 200, description = "The state of the archive", body = ArchiveState), Refusals))]
pub async fn get(State(lab): State<Lab>) -> Answer<ArchiveState> {
    Ok(Json(lab.archive().await?))
}

/// Tries all tables that wait or have failed again, now
#[utoipa::path(post, path = "/archive/retry", operation_id = "retry_archive", tag = "daemon",
    responses((status = 200, description = "The state before the attempts", body = ArchiveState), Refusals))]
pub async fn retry(State(lab): State<Lab>) -> Answer<ArchiveState> {
    Ok(Json(lab.retry_archive().await?))
}

#[derive(Debug, Clone, Copy, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(deny_unknown_fields)]
pub struct SamplesQuery {
    /// Only runs that ended at least this time ago.
    pub older_than_s: f64,
}

/// Archived samples that are still in the store; the oldest run first
#[utoipa::path(get, path = "/archive/samples", operation_id = "list_archived_samples", tag = "daemon",
    params(SamplesQuery),
    responses((status = 200, description = "One table for each run", body = Vec<ArchivedTable>), Refusals))]
pub async fn samples(State(lab): State<Lab>, Query(query): Query<SamplesQuery>) -> Answer<Vec<ArchivedTable>> {
    Ok(Json(lab.droppable_samples(query.older_than_s).await?))
}

/// Removes the samples of a run from the store, after its file in the archive is compared once more; results are kept
#[utoipa::path(delete, path = "/runs/{id}/samples", operation_id = "drop_run_samples", tag = "runs",
    params(("id" = i64, Path, description = "Run")),
    responses((status = 200, description = "The file of the samples", body = ArchivedTable), Refusals))]
pub async fn drop_samples(
    State(lab): State<Lab>,
    Extension(caller): Extension<Caller>,
    Path(id): Path<i64>,
) -> Answer<ArchivedTable> {
    Ok(Json(lab.drop_samples(id, &caller.name).await?))
}
