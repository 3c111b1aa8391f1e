//! Notes and tags of runs.

use super::extract::{Answer, Created, Json, Path, created};
use super::refusals::Refusals;
use crate::lab::Lab;
use crate::view::{NewNote, Note, Run, Tags};
use axum::extract::State;

/// Notes about a run, the oldest first
#[utoipa::path(get, path = "/runs/{id}/notes", operation_id = "list_notes", tag = "runs",
    params(("id" = i64, Path, description = "Run")),
    responses((status = 200, description = "All notes", body = Vec<Note>), Refusals))]
pub async fn list(State(lab): State<Lab>, Path(id): Path<i64>) -> Answer<Vec<Note>> {
    Ok(Json(lab.notes(id).await?))
}

/// Stores a note about a run or a moment of it; notes are never changed
#[utoipa::path(post, path = "/runs/{id}/notes", operation_id = "write_note", tag = "runs", request_body = NewNote,
    params(("id" = i64, Path, description = "Run")),
    responses((status = 201, description = "The note", body = Note), Refusals))]
pub async fn write(State(lab): State<Lab>, Path(id): Path<i64>, Json(new): Json<NewNote>) -> Created<Note> {
    created(lab.write_note(id, &new).await?)
}

/// Sets the tags of a run
#[utoipa::path(put, path = "/runs/{id}/tags", operation_id = "set_tags", tag = "runs", request_body = Tags,
    params(("id" = i64, Path, description = "Run")),
    responses((status = 200, description = "The run", body = Run), Refusals))]
pub async fn set_tags(State(lab): State<Lab>, Path(id): Path<i64>, Json(tags): Json<Tags>) -> Answer<Run> {
    Ok(Json(lab.set_tags(id, &tags.tags).await?))
}

/// All tags in use, most frequent first
#[utoipa::path(get, path = "/tags", operation_id = "list_tags", tag = "runs",
    responses((status = 200, description = "Tags", body = Vec<String>), Refusals))]
pub async fn tags(State(lab): State<Lab>) -> Answer<Vec<String>> {
    Ok(Json(lab.tags().await?))
}
