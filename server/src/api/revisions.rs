//! Model versions: comparison, evaluation on other runs, export and import.

use super::cancellation::{DetachQuery, cancel_on_disconnect};
use super::extract::{Answer, Created, Json, Path, Query, created};
use super::presence::Presence;
use super::problem::Problem;
use super::refusals::Refusals;
use crate::lab::{Caller, Lab};
use crate::view::{Comparison, Evaluation, ImportedModel, ModelImport, NewEvaluation, Worth};
use axum::Extension;
use axum::extract::State;
use axum::http::header;
use axum::response::{IntoResponse, Response};
use jointbench_model::export::Format;
use serde::Deserialize;
use utoipa::{IntoParams, ToSchema};

#[derive(Debug, Clone, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(deny_unknown_fields)]
pub struct CompareQuery {
    /// The run that both are evaluated on; the run of the first version if omitted.
    pub run: Option<i64>,
}

/// Comparison of two model versions: effects, parameters, and the error of both on one run
#[utoipa::path(get, path = "/models/{id}/compare/{other}", operation_id = "compare_models", tag = "models",
    params(("id" = i64, Path, description = "First version"), ("other" = i64, Path, description = "Second version"), CompareQuery),
    responses((status = 200, description = "The comparison", body = Comparison), Refusals))]
pub async fn compare(
    State(lab): State<Lab>,
    Path((id, other)): Path<(i64, i64)>,
    Query(query): Query<CompareQuery>,
) -> Answer<Comparison> {
    Ok(Json(lab.compare(id, other, query.run).await?))
}

/// Contribution of each effect of a model version: validation error without it, the others refitted
#[utoipa::path(get, path = "/models/{id}/worth", operation_id = "get_effects_worth", tag = "models",
    params(("id" = i64, Path, description = "Model version")),
    responses((status = 200, description = "One entry for each effect; nothing is stored", body = Vec<Worth>), Refusals))]
pub async fn worth(State(lab): State<Lab>, Path(id): Path<i64>) -> Answer<Vec<Worth>> {
    Ok(Json(lab.worth(id).await?))
}

/// Change of the prediction by an additional effect, at each point of the residuals
#[utoipa::path(get, path = "/models/{id}/with/{effect}", operation_id = "predict_with_effect", tag = "models",
    params(("id" = i64, Path, description = "Model version"), ("effect" = String, Path, description = "A missing effect")),
    responses((status = 200, description = "In the unit of the residuals", body = Vec<f64>), Refusals))]
pub async fn with_effect(State(lab): State<Lab>, Path((id, effect)): Path<(i64, String)>) -> Answer<Vec<f64>> {
    Ok(Json(lab.with_effect(id, effect).await?))
}

/// The error of a model version on any run of its kind
#[utoipa::path(post, path = "/models/{id}/evaluate", operation_id = "evaluate_model", tag = "models",
    params(("id" = i64, Path, description = "Model version")), request_body = NewEvaluation,
    responses((status = 200, description = "The error on that run", body = Evaluation), Refusals))]
pub async fn evaluate(
    State(lab): State<Lab>,
    presence: Presence,
    Path(id): Path<i64>,
    Json(new): Json<NewEvaluation>,
) -> Answer<Evaluation> {
    let evaluation = async move { lab.evaluate(id, new.run).await };
    Ok(Json(cancel_on_disconnect(presence, DetachQuery::default(), evaluation).await?))
}

/// `json` can be imported again; `c` is a C99 header, `lut` a CSV table, `mujoco` and `urdf` the attributes of a joint.
#[derive(Debug, Clone, Copy, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum ExportFormat {
    Json,
    C,
    Lut,
    Mujoco,
    Urdf,
}

impl From<ExportFormat> for Format {
    fn from(format: ExportFormat) -> Self {
        match format {
            ExportFormat::Json => Format::Json,
            ExportFormat::C => Format::C,
            ExportFormat::Lut => Format::Table,
            ExportFormat::Mujoco => Format::Mujoco,
            ExportFormat::Urdf => Format::Urdf,
        }
    }
}

#[derive(Debug, Clone, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(deny_unknown_fields)]
pub struct ModelExportQuery {
    /// Kind of file.
    #[param(inline)]
    pub format: ExportFormat,
}

/// A model version as a file
#[utoipa::path(get, path = "/models/{id}/export", operation_id = "export_model", tag = "models",
    params(("id" = i64, Path, description = "Model version"), ModelExportQuery),
    responses((status = 200, description = "The file", body = String, content_type = "text/plain"), Refusals))]
pub async fn export(
    State(lab): State<Lab>,
    Path(id): Path<i64>,
    Query(query): Query<ModelExportQuery>,
) -> Result<Response, Problem> {
    let format = Format::from(query.format);
    let (run, text) = lab.export_model(id, format).await?;
    let media_type = match query.format {
        ExportFormat::Json => "application/json",
        ExportFormat::C => "text/x-c; charset=utf-8",
        ExportFormat::Lut => "text/csv; charset=utf-8",
        ExportFormat::Mujoco | ExportFormat::Urdf => "application/xml",
    };
    let name = format!("attachment; filename=\"run-{run}-model-{id}.{}\"", format.extension());
    Ok(([(header::CONTENT_TYPE, media_type.to_owned()), (header::CONTENT_DISPOSITION, name)], text).into_response())
}

/// Stores an exported model as a version of a run
#[utoipa::path(post, path = "/models/import", operation_id = "import_model", tag = "models", request_body = ModelImport,
    responses((status = 201, description = "The version", body = ImportedModel), Refusals))]
pub async fn import(
    State(lab): State<Lab>,
    Extension(caller): Extension<Caller>,
    Json(import): Json<ModelImport>,
) -> Created<ImportedModel> {
    created(lab.import_model(import, &caller.name).await?)
}
