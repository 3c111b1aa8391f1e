//! User-defined effects.

use super::cancellation::{DetachQuery, cancel_on_disconnect};
use super::extract::{Answer, Created, Json, Path, Query, created};
use super::presence::Presence;
use super::problem::Problem;
use super::refusals::Refusals;
use crate::lab::{Caller, Lab};
use crate::view::{Effect, EffectCheck, EffectDefinition, EffectTrial, FormulaLanguage};
use axum::Extension;
use axum::extract::State;
use axum::http::StatusCode;
use serde::Deserialize;
use utoipa::IntoParams;

#[derive(Debug, Clone, Default, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(default, deny_unknown_fields)]
pub struct DefineQuery {
    /// The run for which the effect was written: its diagnosis may suggest the effect. Other runs opt in.
    pub run: Option<i64>,
}

/// Defines an effect by its formula, or a new version of it
#[utoipa::path(post, path = "/effects", operation_id = "define_effect", tag = "effects", params(DefineQuery),
    request_body = EffectDefinition,
    responses((status = 201, description = "The effect, available to all models of its kind", body = Effect), Refusals))]
pub async fn define(
    State(lab): State<Lab>,
    Extension(caller): Extension<Caller>,
    Query(query): Query<DefineQuery>,
    Json(definition): Json<EffectDefinition>,
) -> Created<Effect> {
    created(lab.define_effect(&definition, query.run, &caller.name).await?)
}

/// Lets the diagnosis of a run suggest a user-defined effect
#[utoipa::path(put, path = "/runs/{id}/effects/{effect}", operation_id = "use_effect", tag = "effects",
    params(("id" = i64, Path, description = "The run"), ("effect" = String, Path, description = "A user-defined effect")),
    responses((status = 204, description = "The run uses the effect"), Refusals))]
pub async fn opt_in(
    State(lab): State<Lab>,
    Extension(caller): Extension<Caller>,
    Path((run, effect)): Path<(i64, String)>,
) -> Result<StatusCode, Problem> {
    lab.use_effect(run, &effect, true, &caller.name).await?;
    Ok(StatusCode::NO_CONTENT)
}

/// Keeps a user-defined effect out of the diagnosis of a run; models that contain it remain
#[utoipa::path(delete, path = "/runs/{id}/effects/{effect}", operation_id = "exclude_effect", tag = "effects",
    params(("id" = i64, Path, description = "The run"), ("effect" = String, Path, description = "A user-defined effect")),
    responses((status = 204, description = "The run does not use the effect"), Refusals))]
pub async fn opt_out(
    State(lab): State<Lab>,
    Extension(caller): Extension<Caller>,
    Path((run, effect)): Path<(i64, String)>,
) -> Result<StatusCode, Problem> {
    lab.use_effect(run, &effect, false, &caller.name).await?;
    Ok(StatusCode::NO_CONTENT)
}

/// Checks a formula and describes it, without storing it
#[utoipa::path(post, path = "/effects/check", operation_id = "check_effect", tag = "effects", request_body = EffectTrial,
    responses((status = 200, description = "The parsed formula", body = EffectCheck), Refusals))]
pub async fn check(State(lab): State<Lab>, presence: Presence, Json(trial): Json<EffectTrial>) -> Answer<EffectCheck> {
    let check = async move { lab.check_effect(&trial).await };
    Ok(Json(cancel_on_disconnect(presence, DetachQuery::default(), check).await?))
}

/// Deletes a user-defined effect; rejected while a model uses it
#[utoipa::path(delete, path = "/effects/{kind}/{id}", operation_id = "delete_effect", tag = "effects",
    params(("kind" = String, Path, description = "Kind of runs"), ("id" = String, Path, description = "The effect")),
    responses((status = 204, description = "Deleted"), Refusals))]
pub async fn delete(State(lab): State<Lab>, Path((kind, id)): Path<(String, String)>) -> Result<StatusCode, Problem> {
    lab.delete_effect(&kind, &id).await?;
    Ok(StatusCode::NO_CONTENT)
}

/// Signals, functions and operators that a formula of a kind may use
#[utoipa::path(get, path = "/formulas/{kind}", operation_id = "get_formula_language", tag = "effects",
    params(("kind" = String, Path, description = "Kind of runs")),
    responses((status = 200, description = "Signals, functions and operators", body = FormulaLanguage), Refusals))]
pub async fn language(State(lab): State<Lab>, Path(kind): Path<String>) -> Answer<FormulaLanguage> {
    Ok(Json(lab.formula_language(&kind)?))
}
