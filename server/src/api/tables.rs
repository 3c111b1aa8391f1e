//! Tables of a page as files.

use super::extract::{Json, Query};
use super::problem::Problem;
use super::refusals::{File, Refusals};
use crate::lab::{Lab, TableFormat};
use crate::view::Table;
use axum::extract::State;
use axum::http::header;
use axum::response::{IntoResponse, Response};
use serde::Deserialize;
use utoipa::IntoParams;

#[derive(Debug, Clone, Copy, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(deny_unknown_fields)]
pub struct TableQuery {
    /// Kind of file.
    #[param(inline)]
    pub format: TableFormat,
    /// Prefix texts of a CSV that start with = + - @ with an apostrophe, so that a spreadsheet does not interpret them
    /// as formulas.
    #[serde(default)]
    pub spreadsheet_safe: bool,
}

/// Converts a table, such as the data of a plot, to a file, without storing it
#[utoipa::path(post, path = "/tables", operation_id = "write_table", tag = "daemon", params(TableQuery),
    responses(
        (status = 200, description = "The file", content((File = "text/csv"), (File = "application/vnd.apache.parquet"))),
        Refusals))]
pub async fn write(
    State(lab): State<Lab>,
    Query(query): Query<TableQuery>,
    Json(table): Json<Table>,
) -> Result<Response, Problem> {
    let bytes = lab.write_table(table, query.format, query.spreadsheet_safe).await?;
    Ok(([(header::CONTENT_TYPE, query.format.media_type())], bytes).into_response())
}
