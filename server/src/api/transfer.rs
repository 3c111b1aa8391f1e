//! Export and import of run tables as files.

use super::extract::{Answer, Created, Json, Path, Query, created};
use super::problem::Problem;
use super::refusals::{File, Refusals};
use crate::job::Streamed;
use crate::lab::{Caller, Encoding, ExportRequest, FileFormat, ImportRequest, Lab, LabError};
use crate::store::StoreError;
use crate::view::{ImportPreview, Run};
use axum::Extension;
use axum::body::{Body, Bytes, HttpBody};
use axum::extract::State;
use axum::extract::multipart::{Field, Multipart, MultipartError};
use axum::http::header;
use axum::response::{IntoResponse, Response};
use serde::Deserialize;
use std::pin::Pin;
use std::task::{Context, Poll};
use tempfile::TempPath;
use tokio::io::AsyncWriteExt;
use utoipa::{IntoParams, ToSchema};

#[derive(Debug, Clone, Copy, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(deny_unknown_fields)]
pub struct ExportQuery {
    /// Kind of file.
    #[param(inline)]
    pub format: FileFormat,
    /// Start of the part, in run time; first row if omitted.
    pub from_s: Option<f64>,
    /// End of the part, in run time; last row if omitted.
    pub to_s: Option<f64>,
    /// Prefix column names of a CSV that start with = + - @ with an apostrophe, so that a spreadsheet does not
    /// interpret them as formulas. The names change by this.
    #[serde(default)]
    pub spreadsheet_safe: bool,
}

/// A run or a part of it as one file in full resolution, which `import` reads unchanged
#[utoipa::path(get, path = "/runs/{id}/export", operation_id = "export_run", tag = "runs",
    params(("id" = i64, Path, description = "Run"), ExportQuery),
    responses(
        (status = 200, description = "The file", content(
            (File = "text/csv"), (File = "application/vnd.apache.parquet"), (File = "application/x-matlab-data"))),
        Refusals))]
pub async fn export(
    State(lab): State<Lab>,
    Path(id): Path<i64>,
    Query(query): Query<ExportQuery>,
) -> Result<Response, Problem> {
    let ExportQuery { format, from_s, to_s, spreadsheet_safe } = query;
    let request =
        ExportRequest { run: id, encoding: Encoding::File(format), channels: None, from_s, to_s, spreadsheet_safe };
    let name = format!("attachment; filename=\"run-{id}.{}\"", query.format.extension());
    Ok(([(header::CONTENT_DISPOSITION, name)], streamed(&lab, request).await?).into_response())
}

/// A file, as it is written.
pub(super) async fn streamed(lab: &Lab, request: ExportRequest) -> Result<Response, Problem> {
    let headers = [(header::CONTENT_TYPE, request.encoding.media_type())];
    Ok((headers, Body::new(Pieces(lab.export(request).await?))).into_response())
}

/// Metadata of the run as `meta.json`, required for the import of an exported CSV
#[utoipa::path(get, path = "/runs/{id}/meta", operation_id = "export_run_meta", tag = "runs",
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
    /// Name of the run; the file name if omitted.
    pub name: Option<String>,
}

/// The parts of an upload.
#[derive(ToSchema)]
#[allow(dead_code, reason = "describes the multipart body in the specification")]
pub struct ImportForm {
    /// Run table: text (`.csv`, `.tsv`, `.txt`, `.dat` and others, also `.gz`), `.parquet` or `.arrow`. The part carries the
    /// file's name.
    #[schema(value_type = String, format = Binary)]
    file: Vec<u8>,
    /// `meta.json`; a Parquet file may carry it itself.
    meta: Option<String>,
    /// `column=name in the file`; repeatable.
    map: Option<Vec<String>>,
    /// `column=factor`; repeatable.
    scale: Option<Vec<String>>,
    /// File name of a column to omit; repeatable.
    leave: Option<Vec<String>>,
    /// Whether to omit rows with an empty cell (rejected otherwise). The run states their number.
    leave_empty_rows: Option<bool>,
    /// Lines of a text or rows of a columnar file to omit, such as `17`, `40-52` or `900-`; repeatable. The run states their
    /// number.
    omit_rows: Option<Vec<String>>,
    /// What stands for an empty cell, such as `OVLD` or `-9999`; `none`: no number does; may be repeated.
    missing: Option<Vec<String>>,
    /// `column=unit`, such as `motor_position_rad=deg`; may be repeated.
    unit: Option<Vec<String>>,
    /// `column` or `column=period`: an angle that wraps after a turn is made continuous; may be repeated.
    unwrap: Option<Vec<String>>,
    /// Names of the columns with commas between, for a table without a line of names.
    names: Option<String>,
    /// `point`, `comma` or `name in the file=comma`: the decimal sign; may be repeated.
    decimal: Option<Vec<String>>,
    /// Rows a second of a table without a time.
    rate: Option<f64>,
    /// The same in the place of the time that the table has.
    time_from_rate: Option<f64>,
    /// Whether rows of one time stamp are spread evenly up to the next.
    spread_time: Option<bool>,
    /// Whether each row is the mean of one steady operating point: a table of conditions without a time.
    operating_points: Option<bool>,
    /// Whether a file in which the time begins again is taken as several recordings of one measurement.
    split_runs: Option<bool>,
}

/// Imports a measured file as a run; a rejected file stores no data
#[utoipa::path(post, path = "/runs/import", operation_id = "import_run", tag = "runs", params(ImportQuery),
    request_body(content = ImportForm, content_type = "multipart/form-data"),
    responses((status = 201, description = "The run", body = Run), Refusals))]
pub async fn import(
    State(lab): State<Lab>,
    Extension(caller): Extension<Caller>,
    Query(query): Query<ImportQuery>,
    form: Multipart,
) -> Created<Run> {
    let (request, _lies) = read_form(&lab, form, query.name).await?;
    created(lab.import(request, &caller.name).await?)
}

/// What a file holds, what was understood of it and what is proposed; keeps nothing
#[utoipa::path(post, path = "/runs/import/preview", operation_id = "preview_import", tag = "runs",
    request_body(content = ImportForm, content_type = "multipart/form-data"),
    responses((status = 200, description = "The preview", body = ImportPreview), Refusals))]
pub async fn preview(State(lab): State<Lab>, form: Multipart) -> Answer<ImportPreview> {
    let (request, _lies) = read_form(&lab, form, None).await?;
    Ok(Json(lab.preview_file(request).await?.into()))
}

/// All parts but the file together.
const MOST_WORDS_BYTES: usize = 1 << 20;

/// The file goes to the disk as it comes. It lies there for as long as the path that comes with the request.
async fn read_form(lab: &Lab, mut form: Multipart, name: Option<String>) -> Result<(ImportRequest, TempPath), Problem> {
    let (file, path) = lab.upload()?;
    let mut file = tokio::fs::File::from_std(file);
    let mut request = ImportRequest { file: path.to_path_buf(), name, ..ImportRequest::default() };
    let mut words = Words::default();
    while let Some(part) = form.next_field().await.map_err(unreadable)? {
        let part_name = part.name().unwrap_or_default().to_owned();
        match part_name.as_str() {
            "file" if !request.file_name.is_empty() => {
                return Err(Problem::malformed("the part `file` occurs twice: send one file per request"));
            }
            "file" => {
                request.file_name = part.file_name().unwrap_or("run.csv").to_owned();
                write(part, &mut file).await?;
            }
            "meta" => request.meta = Some(words.of(part).await?),
            name => {
                let text = words.of(part).await?;
                if !request.choices.take(name, text).map_err(LabError::from)? {
                    let expected = "file, meta, or a choice such as map, unit or leave_empty_rows";
                    return Err(Problem::malformed(format!(
                        "part {name:?}: expected {expected}; /api/v1/openapi.json names them all"
                    )));
                }
            }
        }
    }
    if request.file_name.is_empty() {
        return Err(Problem::malformed("the part `file` is missing: send the run table as multipart/form-data"));
    }
    Ok((request, path))
}

async fn write(mut part: Field<'_>, file: &mut tokio::fs::File) -> Result<(), Problem> {
    let unkept = |fault: std::io::Error| match fault.kind() {
        std::io::ErrorKind::StorageFull => LabError::from(StoreError::DiskFull),
        _ => LabError::Internal(format!("the file cannot be imported: {fault}")),
    };
    while let Some(piece) = part.chunk().await.map_err(unreadable)? {
        file.write_all(&piece).await.map_err(unkept)?;
    }
    file.flush().await.map_err(unkept)?;
    Ok(())
}

/// The parts that are words, which lie in memory.
#[derive(Default)]
struct Words {
    bytes: usize,
}

impl Words {
    async fn of(&mut self, mut part: Field<'_>) -> Result<String, Problem> {
        let mut text = Vec::new();
        while let Some(piece) = part.chunk().await.map_err(unreadable)? {
            self.bytes += piece.len();
            if self.bytes > MOST_WORDS_BYTES {
                let detail = format!("the form fields have more than {MOST_WORDS_BYTES} bytes in total");
                return Err(Problem::too_large(detail));
            }
            text.extend_from_slice(&piece);
        }
        String::from_utf8(text).map_err(|_| Problem::malformed("a form field is not UTF-8 text"))
    }
}

/// A body that comes piece by piece; one that breaks off says so to the client.
struct Pieces(Streamed);

impl HttpBody for Pieces {
    type Data = Bytes;
    type Error = LabError;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
    ) -> Poll<Option<Result<http_body::Frame<Bytes>, LabError>>> {
        self.0.poll_recv(context).map(|piece| piece.map(|piece| piece.map(http_body::Frame::data)))
    }
}

fn unreadable(error: MultipartError) -> Problem {
    match error.status() {
        axum::http::StatusCode::PAYLOAD_TOO_LARGE => Problem::too_large(error.body_text()),
        _ => Problem::malformed(error.body_text()),
    }
}
