//! Tokens of users. Requires full access.

use super::extract::{Created, Json, Path, created};
use super::problem::Problem;
use super::refusals::Refusals;
use crate::lab::{Caller, Lab};
use crate::view::{MadeToken, NewToken, Token};
use axum::Extension;
use axum::extract::State;
use axum::http::StatusCode;

/// All valid tokens, without their secrets
#[utoipa::path(get, path = "/tokens", operation_id = "list_tokens", tag = "daemon",
    responses((status = 200, description = "The tokens", body = Vec<Token>), Refusals))]
pub async fn list(State(lab): State<Lab>, Extension(caller): Extension<Caller>) -> Json<Vec<Token>> {
    Json(lab.list_tokens(&caller))
}

/// Creates a token; its secret is returned only once
#[utoipa::path(post, path = "/tokens", operation_id = "create_token", tag = "daemon", request_body = NewToken,
    responses((status = 201, description = "The token with its secret", body = MadeToken), Refusals))]
pub async fn make(
    State(lab): State<Lab>,
    Extension(caller): Extension<Caller>,
    Json(new): Json<NewToken>,
) -> Created<MadeToken> {
    created(lab.make_token(&new, &caller).await?)
}

/// Revokes a token; rejected for the token of the request and for the tokens of the command line
#[utoipa::path(delete, path = "/tokens/{id}", operation_id = "revoke_token", tag = "daemon",
    params(("id" = i64, Path, description = "Token")),
    responses((status = 204, description = "The token is revoked"), Refusals))]
pub async fn revoke(
    State(lab): State<Lab>,
    Extension(caller): Extension<Caller>,
    Path(id): Path<i64>,
) -> Result<StatusCode, Problem> {
    lab.revoke_token(id, &caller).await?;
    Ok(StatusCode::NO_CONTENT)
}
