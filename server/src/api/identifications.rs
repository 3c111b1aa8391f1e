//! Results of procedures.

use super::extract::{Answer, Json, Path, Query};
use super::problem::Problem;
use super::refusals::Refusals;
use crate::lab::Lab;
use crate::view::{Earlier, Identification, ModelOverlay, Trends};
use axum::extract::State;
use axum::http::header;
use axum::response::{Html, IntoResponse};
use serde::Deserialize;
use utoipa::IntoParams;

/// Quantities with intervals, figures and a verdict, computed from the samples by the procedure of the run
#[utoipa::path(get, path = "/runs/{id}/identification", operation_id = "get_identification", tag = "runs", params(("id" = i64, Path, description = "Run")),
    responses((status = 200, description = "Result of the run", body = Identification), Refusals))]
pub async fn get(State(lab): State<Lab>, Path(id): Path<i64>) -> Answer<Identification> {
    Ok(Json(lab.identification(id).await?))
}

/// Results of earlier complete runs of the same bench and procedure, newest first, at most twelve
#[utoipa::path(get, path = "/runs/{id}/earlier", operation_id = "list_earlier_results", tag = "runs", params(("id" = i64, Path, description = "Run")),
    responses((status = 200, description = "Quantities of earlier runs", body = Vec<Earlier>), Refusals))]
pub async fn earlier(State(lab): State<Lab>, Path(id): Path<i64>) -> Answer<Vec<Earlier>> {
    Ok(Json(lab.earlier(id).await?))
}

/// JUnit report of an ended run: a test case for the run, and one for each of its limits
#[utoipa::path(get, path = "/runs/{id}/junit", operation_id = "get_junit", tag = "runs", params(("id" = i64, Path, description = "Run")),
    responses((status = 200, description = "The report", body = String, content_type = "application/xml"), Refusals))]
pub async fn junit(State(lab): State<Lab>, Path(id): Path<i64>) -> Result<impl IntoResponse, Problem> {
    Ok(([(header::CONTENT_TYPE, "application/xml")], lab.junit(id).await?))
}

#[derive(Debug, Clone, Default, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(default, deny_unknown_fields)]
pub struct TrendQuery {
    /// As in the list of runs; unknown terms are ignored.
    pub search: String,
}

/// What the newest 500 complete runs that a search finds have found, the oldest first
#[utoipa::path(get, path = "/trends", operation_id = "get_trends", tag = "runs", params(TrendQuery),
    responses((status = 200, description = "Quantities with intervals, and the conditions of each run", body = Trends), Refusals))]
pub async fn trends(State(lab): State<Lab>, Query(query): Query<TrendQuery>) -> Answer<Trends> {
    Ok(Json(lab.trends(&query.search).await?))
}

/// A run, also an active one, compared with the latest model of its kind from another run of its bench; `null` without
/// one
#[utoipa::path(get, path = "/runs/{id}/beside", operation_id = "compare_with_latest_model", tag = "runs", params(("id" = i64, Path, description = "Run")),
    responses((status = 200, description = "Measured signal, model and residual", body = Option<ModelOverlay>), Refusals))]
pub async fn model_overlay(State(lab): State<Lab>, Path(id): Path<i64>) -> Answer<Option<ModelOverlay>> {
    Ok(Json(lab.model_overlay(id).await?))
}

#[derive(Debug, Clone, Default, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(default, deny_unknown_fields)]
pub struct ReportQuery {
    /// Model version of the report; the latest active version if omitted.
    pub model: Option<i64>,
    /// Only the first page, without the appendix.
    pub short: bool,
}

/// Report of the run as HTML: a first page that fits one sheet, and an appendix with model, diagnosis and provenance
#[utoipa::path(get, path = "/runs/{id}/report", operation_id = "get_report", tag = "runs", params(("id" = i64, Path, description = "Run"), ReportQuery),
    responses((status = 200, description = "The self-contained page", body = String, content_type = "text/html"), Refusals))]
pub async fn report(
    State(lab): State<Lab>,
    Path(id): Path<i64>,
    Query(query): Query<ReportQuery>,
) -> Result<impl IntoResponse, Problem> {
    Ok(([(header::CONTENT_SECURITY_POLICY, REPORT_POLICY)], Html(lab.report(id, query.model, query.short).await?)))
}

/// A report carries its own styles, and nothing that runs.
const REPORT_POLICY: &str =
    "default-src 'none'; style-src 'unsafe-inline'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";
