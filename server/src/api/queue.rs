//! Queues: runs that wait for their bench. A single run enters with `POST /runs`.

use super::extract::{Answer, Created, Json, Path, created};
use super::problem::Problem;
use super::refusals::Refusals;
use super::runs::IDEMPOTENCY_KEY;
use crate::lab::{Caller, Lab};
use crate::view::{BenchQueue, Lease, NewTestPlan, QueueEntry, QueuePriority};
use axum::Extension;
use axum::extract::State;
use axum::http::HeaderMap;

/// The queues of all benches with their waiting entries, and those that left last
#[utoipa::path(get, path = "/queue", operation_id = "list_queues", tag = "queue",
    responses((status = 200, description = "One queue for each bench", body = Vec<BenchQueue>), Refusals))]
pub async fn list(State(lab): State<Lab>) -> Answer<Vec<BenchQueue>> {
    Ok(Json(lab.queues().await?))
}

/// Appends the runs of a test plan to the queue of their bench, all or none
#[utoipa::path(post, path = "/queue", operation_id = "queue_plan", tag = "queue", request_body = NewTestPlan,
    responses((status = 201, description = "The entries, in order", body = Vec<QueueEntry>), Refusals))]
pub async fn add_plan(
    State(lab): State<Lab>,
    Extension(caller): Extension<Caller>,
    headers: HeaderMap,
    Json(plan): Json<NewTestPlan>,
) -> Created<Vec<QueueEntry>> {
    if headers.contains_key(IDEMPOTENCY_KEY) {
        return Err(Problem::malformed(
            "Idempotency-Key is for single runs (POST /runs): GET /queue shows whether the plan waits",
        ));
    }
    created(lab.enqueue_plan(&plan, &caller.name).await?)
}

/// An entry, also after it has left the queue
#[utoipa::path(get, path = "/queue/{id}", operation_id = "get_queue_entry", tag = "queue",
    params(("id" = i64, Path, description = "Entry")),
    responses((status = 200, description = "The entry", body = QueueEntry), Refusals))]
pub async fn get(State(lab): State<Lab>, Path(id): Path<i64>) -> Answer<QueueEntry> {
    Ok(Json(lab.queue_entry(id).await?))
}

/// Removes a waiting entry
#[utoipa::path(delete, path = "/queue/{id}", operation_id = "remove_queue_entry", tag = "queue",
    params(("id" = i64, Path, description = "Entry")),
    responses((status = 200, description = "The removed entry", body = QueueEntry), Refusals))]
pub async fn remove(
    State(lab): State<Lab>,
    Extension(caller): Extension<Caller>,
    Path(id): Path<i64>,
) -> Answer<QueueEntry> {
    Ok(Json(lab.remove_from_queue(id, &caller.name).await?))
}

/// Undoes the removal of an entry: it waits again, in its former place
#[utoipa::path(post, path = "/queue/{id}/restore", operation_id = "restore_queue_entry", tag = "queue",
    params(("id" = i64, Path, description = "Entry")),
    responses((status = 200, description = "The waiting entry", body = QueueEntry), Refusals))]
pub async fn restore(
    State(lab): State<Lab>,
    Extension(caller): Extension<Caller>,
    Path(id): Path<i64>,
) -> Answer<QueueEntry> {
    Ok(Json(lab.restore_to_queue(id, &caller.name).await?))
}

/// Renews the lease of a waiting entry
#[utoipa::path(post, path = "/queue/{id}/lease", operation_id = "renew_queue_lease", tag = "queue",
    params(("id" = i64, Path, description = "Entry")),
    responses((status = 200, description = "The renewed lease", body = Lease), Refusals))]
pub async fn renew_lease(State(lab): State<Lab>, Path(id): Path<i64>) -> Answer<Lease> {
    Ok(Json(lab.renew_entry_lease(id).await?))
}

/// Changes the priority of a waiting entry, and of its test plan
#[utoipa::path(put, path = "/queue/{id}/priority", operation_id = "set_queue_priority", tag = "queue", request_body = QueuePriority,
    params(("id" = i64, Path, description = "Entry")),
    responses((status = 200, description = "The entry", body = QueueEntry), Refusals))]
pub async fn prioritise(
    State(lab): State<Lab>,
    Path(id): Path<i64>,
    Json(new): Json<QueuePriority>,
) -> Answer<QueueEntry> {
    Ok(Json(lab.prioritise(id, new.priority).await?))
}

/// Pauses a queue: the active run continues, and no further entry starts
#[utoipa::path(post, path = "/bench/{bench}/queue/pause", operation_id = "pause_queue", tag = "queue",
    params(("bench" = String, Path, description = "Name")),
    responses((status = 200, description = "The queue", body = BenchQueue), Refusals))]
pub async fn pause(
    State(lab): State<Lab>,
    Extension(caller): Extension<Caller>,
    Path(bench): Path<String>,
) -> Answer<BenchQueue> {
    Ok(Json(lab.pause_queue(&bench, &caller.name).await?))
}

/// Resumes a queue
#[utoipa::path(post, path = "/bench/{bench}/queue/resume", operation_id = "resume_queue", tag = "queue",
    params(("bench" = String, Path, description = "Name")),
    responses((status = 200, description = "The queue", body = BenchQueue), Refusals))]
pub async fn resume(
    State(lab): State<Lab>,
    Extension(caller): Extension<Caller>,
    Path(bench): Path<String>,
) -> Answer<BenchQueue> {
    Ok(Json(lab.resume_queue(&bench, &caller.name).await?))
}
