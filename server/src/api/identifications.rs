//! What a procedure makes of its run.

use super::extract::{Answer, Json, Path};
use super::problem::{Problem, Refusals};
use crate::lab::Lab;
use crate::view::Identification;
use axum::extract::State;
use axum::response::Html;

/// Quantities with intervals, figures and a verdict, worked out from the samples by the procedure of the run
#[utoipa::path(get, path = "/runs/{id}/identification", tag = "runs", params(("id" = i64, Path, description = "Run")),
    responses((status = 200, description = "What the run shows", body = Identification), Refusals))]
pub async fn get(State(lab): State<Lab>, Path(id): Path<i64>) -> Answer<Identification> {
    Ok(Json(lab.identification(id).await?))
}

/// The run as one page to send and to print: result, figures, model, diagnosis, provenance
#[utoipa::path(get, path = "/runs/{id}/report", tag = "runs", params(("id" = i64, Path, description = "Run")),
    responses((status = 200, description = "The page, complete in itself", body = String, content_type = "text/html"), Refusals))]
pub async fn report(State(lab): State<Lab>, Path(id): Path<i64>) -> Result<Html<String>, Problem> {
    Ok(Html(lab.report(id).await?))
}
