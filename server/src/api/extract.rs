//! Extractors of a request. Errors become problem documents.

use super::problem::Problem;
use axum::extract::{FromRequest, FromRequestParts};
use axum::response::{IntoResponse, Response};
use serde::Serialize;

/// A JSON body.
#[derive(FromRequest)]
#[from_request(via(axum::Json), rejection(Problem))]
pub struct Json<T>(pub T);

impl<T: Serialize> IntoResponse for Json<T> {
    fn into_response(self) -> Response {
        axum::Json(self.0).into_response()
    }
}

#[derive(FromRequestParts)]
#[from_request(via(axum::extract::Query), rejection(Problem))]
pub struct Query<T>(pub T);

#[derive(FromRequestParts)]
#[from_request(via(axum::extract::Path), rejection(Problem))]
pub struct Path<T>(pub T);

/// Answer of a handler.
pub type Answer<T> = Result<Json<T>, Problem>;
/// Answer of a handler that has created an object.
pub type Created<T> = Result<(axum::http::StatusCode, Json<T>), Problem>;

pub fn created<T>(made: T) -> Created<T> {
    Ok((axum::http::StatusCode::CREATED, Json(made)))
}
