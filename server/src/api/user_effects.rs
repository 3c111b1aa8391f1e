//! User-defined effects.

use super::cancellation::{DetachQuery, cancel_on_disconnect};
use super::extract::{Answer, Created, Json, Path, created};
use super::presence::Presence;
use super::problem::Problem;
use super::refusals::Refusals;
use crate::lab::Lab;
use crate::view::{Effect, EffectCheck, EffectDefinition, EffectTrial, FormulaLanguage};
use axum::extract::State;
use axum::http::StatusCode;

/// Defines an effect by its formula, or a new version of it
#[utoipa::path(post, path = "/effects", operation_id = "define_effect", tag = "effects", request_body = EffectDefinition,
    responses((status = 201, description = "The effect, available to all models of its kind", body = Effect), Refusals))]
pub async fn define(State(lab): State<Lab>, Json(definition): Json<EffectDefinition>) -> Created<Effect> {
    created(lab.define_effect(&definition).await?)
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
#[utoipa::path(get, path = "/formulas/{kind}", operation_id = "formula_language", tag = "effects",
    params(("kind" = String, Path, description = "Kind of runs")),
    responses((status = 200, description = "Signals, functions and operators", body = FormulaLanguage), Refusals))]
pub async fn language(State(lab): State<Lab>, Path(kind): Path<String>) -> Answer<FormulaLanguage> {
    Ok(Json(lab.formula_language(&kind)?))
}
