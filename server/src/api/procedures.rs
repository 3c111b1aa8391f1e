//! Procedures and previews of runs.

use super::extract::{Answer, Json, Path, Query};
use super::refusals::Refusals;
use crate::lab::Lab;
use crate::view::{Preview, PreviewRequest, Procedure};
use axum::extract::State;
use serde::Deserialize;
use utoipa::IntoParams;

#[derive(Debug, Clone, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(deny_unknown_fields)]
pub struct ProcedureQuery {
    /// Name of a bench: each procedure then states whether the bench can run it, with the defaults from applied
    /// results.
    pub bench: Option<String>,
}

/// All procedures with their parameters
#[utoipa::path(get, path = "/procedures", operation_id = "list_procedures", tag = "procedures", params(ProcedureQuery),
    responses((status = 200, description = "The procedures", body = Vec<Procedure>), Refusals))]
pub async fn list(State(lab): State<Lab>, Query(query): Query<ProcedureQuery>) -> Answer<Vec<Procedure>> {
    Ok(Json(lab.procedures(query.bench.as_deref()).await?))
}

/// Dry run without motion: duration, steps, extremes against the limits, checks
#[utoipa::path(post, path = "/procedures/{id}/preview", operation_id = "preview_plan", tag = "procedures",
    params(("id" = String, Path, description = "Procedure")), request_body = PreviewRequest,
    responses((status = 200, description = "The plan of the procedure", body = Preview), Refusals))]
pub async fn preview(
    State(lab): State<Lab>,
    Path(id): Path<String>,
    Json(request): Json<PreviewRequest>,
) -> Answer<Preview> {
    Ok(Json(lab.preview(&request.bench, &id, &request.parameters).await?))
}
