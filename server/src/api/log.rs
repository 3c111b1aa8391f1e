//! The event log.

use super::extract::{Answer, Json, Query};
use super::refusals::Refusals;
use crate::lab::{Caller, Lab, OF_TOKENS};
use crate::view::{Access, LogEntry};
use axum::Extension;
use axum::extract::State;
use serde::Deserialize;
use utoipa::IntoParams;

#[derive(Debug, Clone, Default, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(default, deny_unknown_fields)]
pub struct LogQuery {
    /// Only this run; all benches and the newest runs if omitted.
    pub run: Option<i64>,
    /// Earlier entries: the runs before this one and the benches in that time. To page, use the smallest run number of
    /// the previous response.
    pub before: Option<i64>,
}

/// Event log with users, newest first: safety records, journals of runs, notes, model versions, and tokens for callers
/// with full access
#[utoipa::path(get, path = "/log", operation_id = "get_log", tag = "daemon", params(LogQuery),
    responses((status = 200, description = "The entries", body = Vec<LogEntry>), Refusals))]
pub async fn log(
    State(lab): State<Lab>,
    Extension(caller): Extension<Caller>,
    Query(query): Query<LogQuery>,
) -> Answer<Vec<LogEntry>> {
    let mut entries = lab.log(query.run, query.before).await?;
    if caller.access == Access::Read {
        entries.retain(|entry| entry.kind != OF_TOKENS);
    }
    Ok(Json(entries))
}
