//! State of the daemon.

use super::extract::{Answer, Json};
use super::problem::Problem;
use super::refusals::Refusals;
use crate::lab::{Caller, Lab};
use crate::store::StoreHealth;
use crate::view::Access;
use axum::Extension;
use axum::extract::{Request, State};
use axum::http::header;
use axum::response::IntoResponse;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct Health {
    pub version: String,
    /// Process id, as in the lock file of the data folder.
    pub process: u32,
    /// Why the dashboard is not part of this build, if it is missing.
    pub dashboard_missing: Option<String>,
    /// What the caller may do.
    pub access: Access,
    /// Result of the latest check of the store.
    #[serde(default)]
    #[schema(required = true)]
    pub store: StoreHealth,
}

/// Whether the daemon is running
#[utoipa::path(get, path = "/health", operation_id = "get_health", tag = "daemon",
    responses((status = 200, description = "The daemon is running", body = Health), Refusals))]
pub async fn health(State(lab): State<Lab>, Extension(caller): Extension<Caller>) -> Answer<Health> {
    let dashboard_missing = jointbench_ui::missing().map(str::to_owned);
    Ok(Json(Health {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        process: std::process::id(),
        dashboard_missing,
        access: caller.access,
        store: lab.store_health(),
    }))
}

/// Metrics for Prometheus: benches, queues, runs and the store.
pub async fn metrics(State(lab): State<Lab>) -> Result<impl IntoResponse, Problem> {
    let kind = "application/openmetrics-text; version=1.0.0; charset=utf-8";
    Ok(([(header::CONTENT_TYPE, kind)], lab.metrics().await?))
}

/// This description
#[utoipa::path(get, path = "/openapi.json", operation_id = "get_specification", tag = "daemon",
    responses((status = 200, description = "OpenAPI 3.1", body = serde_json::Value), Refusals))]
pub async fn specification() -> Json<utoipa::openapi::OpenApi> {
    Json(super::specification())
}

pub async fn no_such_route(request: Request) -> Problem {
    Problem::no_route(request.uri().path())
}

pub async fn no_such_method(request: Request) -> Problem {
    Problem::no_method(request.method().as_str(), request.uri().path())
}
