//! Run tables in and out, as files.

use super::extract::{Created, Path, Query, created};
use super::problem::{Problem, Refusals};
use crate::lab::{Caller, FileFormat, ImportRequest, Lab};
use crate::view::Run;
use axum::Extension;
use axum::extract::State;
use axum::extract::multipart::{Multipart, MultipartError};
use axum::http::header;
use axum::response::{IntoResponse, Response};
use serde::Deserialize;
use utoipa::{IntoParams, ToSchema};

#[derive(Debug, Clone, Copy, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(deny_unknown_fields)]
pub struct ExportQuery {
    /// Kind of file.
    #[param(inline)]
    pub format: FileFormat,
    /// Begin of the stretch on the run's clock; its first row where left out.
    pub from_s: Option<f64>,
    /// End of the stretch; the last row where left out.
    pub to_s: Option<f64>,
    /// Begin names of a CSV that a spreadsheet would take for a formula (= + - @) with an apostrophe; such a name comes
    /// back as another one.
    #[serde(default)]
    pub spreadsheet_safe: bool,
}

/// The run, or a stretch of it, as one file in full resolution, which `import` takes back unchanged
#[utoipa::path(get, path = "/runs/{id}/export", tag = "runs",
    params(("id" = i64, Path, description = "Run"), ExportQuery),
    responses(
        (status = 200, description = "The file", body = Vec<u8>, content_type = "application/octet-stream"),
        Refusals))]
pub async fn export(
    State(lab): State<Lab>,
    Path(id): Path<i64>,
    Query(query): Query<ExportQuery>,
) -> Result<Response, Problem> {
    let bytes = match query.spreadsheet_safe && query.format == FileFormat::Csv {
        true => lab.export_for_spreadsheets(id, query.from_s, query.to_s).await?,
        false => lab.export(id, query.format, query.from_s, query.to_s).await?,
    };
    let name = format!("attachment; filename=\"run-{id}.{}\"", query.format.extension());
    let headers = [(header::CONTENT_TYPE, query.format.media_type().to_owned()), (header::CONTENT_DISPOSITION, name)];
    Ok((headers, bytes).into_response())
}

/// The run's facts as `meta.json`: what an exported CSV needs beside it
#[utoipa::path(get, path = "/runs/{id}/meta", operation_id = "export_meta", tag = "runs",
    params(("id" = i64, Path, description = "Run")),
    responses((status = 200, description = "The facts", body = serde_json::Value), Refusals))]
pub async fn export_meta(State(lab): State<Lab>, Path(id): Path<i64>) -> Result<Response, Problem> {
    let headers = [(header::CONTENT_TYPE, "application/json")];
    Ok((headers, lab.export_meta(id).await?).into_response())
}

#[derive(Debug, Clone, Default, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(default, deny_unknown_fields)]
pub struct ImportQuery {
    /// Name to keep the run under; the file's name where left out.
    pub name: Option<String>,
}

/// The parts of an upload.
#[derive(ToSchema)]
#[allow(dead_code, reason = "describes the multipart body in the specification")]
pub struct ImportForm {
    /// Run table: `.csv`, `.csv.gz`, `.parquet` or `.arrow`. The part carries the file's name.
    #[schema(value_type = String, format = Binary)]
    file: Vec<u8>,
    /// `meta.json`; a Parquet file may carry it itself.
    meta: Option<String>,
    /// `column=name in the file`; may be repeated.
    map: Option<Vec<String>>,
    /// `column=factor`; may be repeated.
    scale: Option<Vec<String>>,
    /// Name in the file of a column that stays out, whatever it holds; may be repeated.
    leave: Option<Vec<String>>,
    /// Whether rows with an empty cell stay out; refused otherwise. How many did is told with the run.
    leave_empty_rows: Option<bool>,
}

/// Takes a measured file in as a run; a refused file leaves nothing behind
#[utoipa::path(post, path = "/runs/import", tag = "runs", params(ImportQuery),
    request_body(content = ImportForm, content_type = "multipart/form-data"),
    responses((status = 201, description = "The run", body = Run), Refusals))]
pub async fn import(
    State(lab): State<Lab>,
    Extension(caller): Extension<Caller>,
    Query(query): Query<ImportQuery>,
    form: Multipart,
) -> Created<Run> {
    let request = read_form(form, query.name).await?;
    created(lab.import(request, &caller.name).await?)
}

async fn read_form(mut form: Multipart, name: Option<String>) -> Result<ImportRequest, Problem> {
    let mut request = ImportRequest::default();
    while let Some(part) = form.next_field().await.map_err(unreadable)? {
        let part_name = part.name().unwrap_or_default().to_owned();
        match part_name.as_str() {
            "file" => {
                request.file_name = part.file_name().unwrap_or("run.csv").to_owned();
                request.bytes = part.bytes().await.map_err(unreadable)?.to_vec();
            }
            "meta" => request.meta = Some(part.text().await.map_err(unreadable)?),
            "map" => request.map.push(part.text().await.map_err(unreadable)?),
            "scale" => request.scale.push(part.text().await.map_err(unreadable)?),
            "leave" => request.leave.push(part.text().await.map_err(unreadable)?),
            "leave_empty_rows" => request.leave_empty_rows = part.text().await.map_err(unreadable)? == "true",
            other => {
                let expected = "file, meta, map, scale, leave or leave_empty_rows";
                return Err(Problem::malformed(format!("part {other:?}: expected {expected}")));
            }
        }
    }
    if request.file_name.is_empty() {
        return Err(Problem::malformed("the part `file` is missing: send the run table as multipart/form-data"));
    }
    request.name = name;
    Ok(request)
}

fn unreadable(error: MultipartError) -> Problem {
    match error.status() {
        axum::http::StatusCode::PAYLOAD_TOO_LARGE => Problem::too_large(error.body_text()),
        _ => Problem::malformed(error.body_text()),
    }
}
