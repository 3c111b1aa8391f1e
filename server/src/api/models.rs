//! Effects, model versions and residuals.

use super::cancellation::{DetachQuery, cancel_on_disconnect};
use super::extract::{Answer, Created, Json, Path, Query, created};
use super::presence::Presence;
use super::problem::Problem;
use super::refusals::Refusals;
use crate::lab::{Caller, Lab};
use crate::view::{Access, Diagnosis, Effect, Fit, Model, NewDiagnosis, NewModel, ResidualSet};
use axum::Extension;
use axum::extract::State;
use axum::http::header;
use axum::response::{IntoResponse, Response};
use serde::Deserialize;
use utoipa::IntoParams;

#[derive(Debug, Clone, Default, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(default, deny_unknown_fields)]
pub struct EffectQuery {
    /// `friction`, `encoder`, `stiffness` or `brake`; all if omitted.
    pub kind: Option<String>,
}

/// The library of effects, including user-defined effects
#[utoipa::path(get, path = "/effects", operation_id = "list_effects", tag = "effects", params(EffectQuery),
    responses((status = 200, description = "The effects", body = Vec<Effect>), Refusals))]
pub async fn effects(State(lab): State<Lab>, Query(query): Query<EffectQuery>) -> Answer<Vec<Effect>> {
    Ok(Json(lab.effects(query.kind.as_deref()).await?))
}

/// Fits a set of effects to a run and stores it as a version
#[utoipa::path(post, path = "/models", operation_id = "create_model", tag = "models", params(DetachQuery), request_body = NewModel,
    responses((status = 201, description = "The version", body = Model), Refusals))]
pub async fn create(
    State(lab): State<Lab>,
    Extension(caller): Extension<Caller>,
    presence: Presence,
    Query(query): Query<DetachQuery>,
    Json(new): Json<NewModel>,
) -> Created<Model> {
    let fit = async move { lab.create_model(new, &caller.name).await };
    created(cancel_on_disconnect(presence, query, fit).await?)
}

/// Keeps a trial version or a version without significant gain as a regular version of the run
#[utoipa::path(post, path = "/models/{id}/keep", operation_id = "keep_model", tag = "models", params(("id" = i64, Path, description = "Model version")),
    responses((status = 200, description = "The version", body = Model), Refusals))]
pub async fn keep(State(lab): State<Lab>, Extension(caller): Extension<Caller>, Path(id): Path<i64>) -> Answer<Model> {
    Ok(Json(lab.keep_model(id, &caller.name).await?))
}

#[derive(Debug, Clone, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(deny_unknown_fields)]
pub struct ModelQuery {
    /// The run that the versions were fitted to.
    pub run: i64,
}

/// All model versions of a run, oldest first
#[utoipa::path(get, path = "/models", operation_id = "list_models", tag = "models", params(ModelQuery),
    responses((status = 200, description = "The versions", body = Vec<Model>), Refusals))]
pub async fn list(State(lab): State<Lab>, Query(query): Query<ModelQuery>) -> Answer<Vec<Model>> {
    Ok(Json(lab.models(query.run).await?))
}

/// One model version
#[utoipa::path(get, path = "/models/{id}", operation_id = "get_model", tag = "models", params(("id" = i64, Path, description = "Model version")),
    responses((status = 200, description = "The version", body = Model), Refusals))]
pub async fn get(State(lab): State<Lab>, Path(id): Path<i64>) -> Answer<Model> {
    Ok(Json(lab.model(id).await?))
}

/// The fit of a model version alone
#[utoipa::path(get, path = "/fits/{id}", operation_id = "get_fit", tag = "models", params(("id" = i64, Path, description = "Model version")),
    responses((status = 200, description = "The fit", body = Fit), Refusals))]
pub async fn fit(State(lab): State<Lab>, Path(id): Path<i64>) -> Answer<Fit> {
    Ok(Json(lab.model(id).await?.fit))
}

/// Measured, predicted and residual of a model version, with the coordinates of each point
#[utoipa::path(get, path = "/models/{id}/residuals", operation_id = "get_residuals", tag = "models",
    params(("id" = i64, Path, description = "Model version")),
    responses((status = 200, description = "The residuals", body = ResidualSet), Refusals))]
pub async fn residuals(State(lab): State<Lab>, Path(id): Path<i64>) -> Result<Response, Problem> {
    let json = lab.residuals(id).await?;
    Ok(([(header::CONTENT_TYPE, "application/json")], json).into_response())
}

/// Finds where a model version fails and which effect is missing, and stores the diagnosis; a read token gets the
/// latest stored one
#[utoipa::path(post, path = "/diagnoses", operation_id = "diagnose_run", tag = "diagnoses", params(DetachQuery), request_body = NewDiagnosis,
    responses((status = 201, description = "The diagnosis", body = Diagnosis), Refusals))]
pub async fn diagnose(
    State(lab): State<Lab>,
    Extension(caller): Extension<Caller>,
    presence: Presence,
    Query(query): Query<DetachQuery>,
    Json(new): Json<NewDiagnosis>,
) -> Created<Diagnosis> {
    match caller.access {
        Access::Read => created(lab.diagnoses(new.model).await?.pop().ok_or_else(|| {
            Problem::forbidden("this version has no diagnosis yet, and a read token cannot create one")
        })?),
        _ => created(cancel_on_disconnect(presence, query, async move { lab.diagnose(new.model).await }).await?),
    }
}

/// One diagnosis
#[utoipa::path(get, path = "/diagnoses/{id}", operation_id = "get_diagnosis", tag = "diagnoses",
    params(("id" = i64, Path, description = "Diagnosis")),
    responses((status = 200, description = "The diagnosis", body = Diagnosis), Refusals))]
pub async fn diagnosis(State(lab): State<Lab>, Path(id): Path<i64>) -> Answer<Diagnosis> {
    Ok(Json(lab.diagnosis(id).await?))
}

#[derive(Debug, Clone, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(deny_unknown_fields)]
pub struct DiagnosisQuery {
    /// The version that was diagnosed.
    pub model: i64,
}

/// The diagnoses of a model version, oldest first
#[utoipa::path(get, path = "/diagnoses", operation_id = "list_diagnoses", tag = "diagnoses", params(DiagnosisQuery),
    responses((status = 200, description = "The diagnoses", body = Vec<Diagnosis>), Refusals))]
pub async fn diagnoses(State(lab): State<Lab>, Query(query): Query<DiagnosisQuery>) -> Answer<Vec<Diagnosis>> {
    Ok(Json(lab.diagnoses(query.model).await?))
}
