//! What has happened.

use super::extract::{Answer, Json, Query};
use super::problem::Refusals;
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
    /// What is about this run alone; the benches and the newest runs where left out.
    pub run: Option<i64>,
    /// What was earlier: the runs before this one, and the benches meanwhile. Of an answer that is the run with the smallest number.
    pub before: Option<i64>,
}

/// What has happened and who did it, newest first: safety records, journals of runs, versions of their models, and tokens where the
/// caller may know of them
#[utoipa::path(get, path = "/log", operation_id = "log", tag = "daemon", params(LogQuery),
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
