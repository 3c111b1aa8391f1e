//! Units under test.

use super::extract::{Answer, Json, Path, Query};
use super::refusals::Refusals;
use crate::lab::{Caller, Lab};
use crate::view::{ControlChart, UnitChanges, UnitList, UnitReference, UnitSummary};
use axum::Extension;
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

/// Marks a unit as a reference unit, which yields and control charts exclude, or ends that
#[utoipa::path(put, path = "/units/{serial}/reference", operation_id = "set_unit_reference", tag = "runs",
    params(("serial" = String, Path, description = "Serial number")), request_body = UnitReference,
    responses((status = 200, description = "The unit", body = UnitSummary), Refusals))]
pub async fn set_reference(
    State(lab): State<Lab>,
    Extension(caller): Extension<Caller>,
    Path(serial): Path<String>,
    Json(new): Json<UnitReference>,
) -> Answer<UnitSummary> {
    Ok(Json(lab.set_unit_reference(&serial, new.reference, &caller.name).await?))
}

#[derive(Debug, Clone, Default, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(default, deny_unknown_fields)]
pub struct ControlChartQuery {
    /// Terms as in the list of runs, such as `part:P batch:7`. Reference units are excluded.
    pub search: String,
    /// Id of the procedure, such as `friction`.
    pub procedure: String,
    /// Name of the quantity; the first one with an interval if omitted.
    pub quantity: Option<String>,
}

/// What changed since the previous run of the same unit, and the scatter of its earlier runs; `null` for the first run, and for one that is not complete
#[utoipa::path(get, path = "/runs/{id}/changes", operation_id = "get_unit_changes", tag = "runs", params(("id" = i64, Path, description = "Complete run of a unit")),
    responses((status = 200, description = "The changes", body = Option<UnitChanges>), Refusals))]
pub async fn changes(State(lab): State<Lab>, Path(id): Path<i64>) -> Answer<Option<UnitChanges>> {
    Ok(Json(lab.unit_changes(id).await?))
}

/// Individuals chart of a quantity over units, with the rules that points violate, and the capability for the limits of the runs
#[utoipa::path(get, path = "/units/chart", operation_id = "get_control_chart", tag = "runs", params(ControlChartQuery),
    responses((status = 200, description = "The chart", body = ControlChart), Refusals))]
pub async fn chart(State(lab): State<Lab>, Query(query): Query<ControlChartQuery>) -> Answer<ControlChart> {
    Ok(Json(lab.control_chart(&query.search, &query.procedure, query.quantity.as_deref()).await?))
}
