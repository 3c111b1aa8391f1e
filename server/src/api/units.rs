//! Units under test.

use super::extract::{Answer, Json, Query};
use super::refusals::Refusals;
use crate::lab::Lab;
use crate::view::UnitList;
use axum::extract::State;
use serde::Deserialize;
use utoipa::IntoParams;

#[derive(Debug, Clone, Default, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(default, deny_unknown_fields)]
pub struct UnitQuery {
    /// Terms as in the list of runs, such as `part:P batch:7`: units with a run that matches, with all their runs.
    pub search: String,
    /// The search is incomplete: unknown terms are ignored and reported instead of rejected.
    pub typing: bool,
}

/// Units under test with their verdicts, newest first, and first-pass yield by part, revision and batch
#[utoipa::path(get, path = "/units", operation_id = "list_units", tag = "runs", params(UnitQuery),
    responses((status = 200, description = "Units and yields", body = UnitList), Refusals))]
pub async fn list(State(lab): State<Lab>, Query(query): Query<UnitQuery>) -> Answer<UnitList> {
    Ok(Json(match query.typing {
        true => lab.units_while_typing(&query.search).await?,
        false => lab.units(&query.search).await?,
    }))
}
