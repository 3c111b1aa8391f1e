//! Errors over HTTP as RFC 9457 problem documents. The `From` of [`LabError`] maps each error to a status.

use crate::lab::LabError;
use crate::view::Place;
use axum::extract::Request;
use axum::extract::rejection::{JsonRejection, PathRejection, QueryRejection};
use axum::http::{HeaderValue, StatusCode, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// RFC 9457 problem document.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Problem {
    /// `urn:jointbench:` and the kind: `not_found`, `invalid`, `formula`, `file_refused`, `conflict`, `over`, `gone`, `bench_fault`, `malformed`,
    /// `forbidden`, `unauthorized`, `not_allowed`, `too_large`, `busy`, `internal`.
    #[serde(rename = "type")]
    #[schema(value_type = String)]
    pub type_: Box<str>,
    #[schema(value_type = String)]
    pub title: Box<str>,
    pub status: u16,
    /// Cause and remedy.
    pub detail: String,
    /// The requested path.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<String>)]
    pub instance: Option<Box<str>>,
    /// Line of the uploaded file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub line: Option<u64>,
    /// Column of the uploaded file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<String>)]
    pub column: Option<Box<str>>,
    /// Position of the error in a formula.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<Place>)]
    pub place: Option<Box<Place>>,
}

/// Kind of a permanent conflict.
const OVER: &str = "over";
/// Kind of a temporary refusal.
const BUSY: &str = "busy";
/// Time after which a client may retry [s].
const RETRY_AFTER: HeaderValue = HeaderValue::from_static("1");

impl Problem {
    pub fn new(status: StatusCode, kind: &str, title: &str, detail: impl Into<String>) -> Self {
        Self {
            type_: format!("urn:jointbench:{kind}").into(),
            title: title.into(),
            status: status.as_u16(),
            detail: detail.into(),
            instance: None,
            line: None,
            column: None,
            place: None,
        }
    }

    /// The same as [`LabError::exit_code`].
    pub fn exit_code(&self) -> u8 {
        match self.status {
            409 if self.type_.ends_with(OVER) => 2,
            409 | 500.. => 1,
            _ => 2,
        }
    }

    pub fn malformed(detail: impl Into<String>) -> Self {
        Self::new(StatusCode::BAD_REQUEST, "malformed", "Malformed request", detail)
    }

    pub fn forbidden(detail: impl Into<String>) -> Self {
        Self::new(StatusCode::FORBIDDEN, "forbidden", "Not allowed", detail)
    }

    pub fn unauthorized() -> Self {
        let detail = "this daemon requires a token: send it as `Authorization: Bearer TOKEN`";
        Self::new(StatusCode::UNAUTHORIZED, "unauthorized", "Token required", detail)
    }

    pub fn too_large(detail: impl Into<String>) -> Self {
        Self::new(StatusCode::PAYLOAD_TOO_LARGE, "too_large", "Request too large", detail)
    }

    /// A limit is reached at the moment.
    pub fn busy(detail: impl Into<String>) -> Self {
        Self::new(StatusCode::SERVICE_UNAVAILABLE, BUSY, "Too many requests", detail)
    }

    /// All connections except the reserved ones are in use.
    pub fn full() -> Self {
        Self::busy("all connections are in use (health and software stop remain available): retry in one second")
    }

    /// Too many wrong tokens from one address.
    pub fn too_many(detail: impl Into<String>) -> Self {
        Self::new(StatusCode::TOO_MANY_REQUESTS, BUSY, "Too many wrong tokens", detail)
    }

    pub fn no_method(method: &str, path: &str) -> Self {
        let detail = format!("{method} is not available at {path}; /api/v1/openapi.json lists all operations");
        Self::new(StatusCode::METHOD_NOT_ALLOWED, "not_allowed", "Method not allowed", detail)
    }

    pub fn no_route(path: &str) -> Self {
        let detail = format!("{path} does not exist; /api/v1/openapi.json lists all operations");
        Self::new(StatusCode::NOT_FOUND, "not_found", "Not found", detail)
    }
}

impl From<LabError> for Problem {
    fn from(error: LabError) -> Self {
        let detail = error.to_string();
        match error {
            LabError::NotFound(_) => Self::new(StatusCode::NOT_FOUND, "not_found", "Not found", detail),
            LabError::Invalid(_) => Self::new(StatusCode::UNPROCESSABLE_ENTITY, "invalid", "Invalid values", detail),
            LabError::File { line, column, .. } => Self {
                line,
                column: column.map(String::into_boxed_str),
                ..Self::new(StatusCode::UNPROCESSABLE_ENTITY, "file_refused", "File rejected", detail)
            },
            LabError::Formula(fault) => Self {
                place: Some(Box::new((*fault).into())),
                ..Self::new(StatusCode::UNPROCESSABLE_ENTITY, "formula", "Invalid formula", detail)
            },
            LabError::Conflict(_) => {
                Self::new(StatusCode::CONFLICT, "conflict", "Not possible in the present state", detail)
            }
            LabError::Gone(_) => Self::new(StatusCode::GONE, "gone", "Samples are in the archive", detail),
            LabError::Over(_) => Self::new(StatusCode::CONFLICT, OVER, "No longer possible", detail),
            LabError::Busy(_) => {
                Self::new(StatusCode::SERVICE_UNAVAILABLE, BUSY, "Not possible in the present state", detail)
            }
            LabError::TooLarge(_) => Self::new(StatusCode::PAYLOAD_TOO_LARGE, "too_large", "Too large", detail),
            LabError::Bench(_) => {
                Self::new(StatusCode::SERVICE_UNAVAILABLE, "bench_fault", "Bench not responding", detail)
            }
            LabError::Setup(_) | LabError::Internal(_) => {
                tracing::error!(%detail, "request failed inside");
                Self::new(StatusCode::INTERNAL_SERVER_ERROR, "internal", "Internal error", detail)
            }
        }
    }
}

const SEE: &str = "; /api/v1/openapi.json describes all operations";

/// Removes the prefix of the extractor.
fn plain(text: &str) -> &str {
    text.split_once(": ").map_or(text, |(_, what)| what)
}

impl From<JsonRejection> for Problem {
    fn from(rejection: JsonRejection) -> Self {
        match rejection.status() {
            StatusCode::PAYLOAD_TOO_LARGE => Self::too_large(rejection.body_text()),
            StatusCode::UNSUPPORTED_MEDIA_TYPE => Self::malformed("send JSON with `Content-Type: application/json`"),
            _ => Self::malformed(format!("invalid JSON body: {}{SEE}", plain(&rejection.body_text()))),
        }
    }
}

impl From<QueryRejection> for Problem {
    fn from(rejection: QueryRejection) -> Self {
        Self::malformed(format!("invalid query: {}{SEE}", plain(&rejection.body_text())))
    }
}

impl From<PathRejection> for Problem {
    fn from(rejection: PathRejection) -> Self {
        Self::malformed(format!("invalid path: {}{SEE}", plain(&rejection.body_text())))
    }
}

impl IntoResponse for Problem {
    fn into_response(self) -> Response {
        let status = StatusCode::from_u16(self.status).unwrap_or(StatusCode::INTERNAL_SERVER_ERROR);
        let body = serde_json::to_vec(&self).unwrap_or_default();
        let mut response = (status, [(header::CONTENT_TYPE, "application/problem+json")], body).into_response();
        if status == StatusCode::UNAUTHORIZED {
            response.headers_mut().insert(header::WWW_AUTHENTICATE, HeaderValue::from_static("Bearer"));
        }
        if self.type_.ends_with(BUSY) {
            response.headers_mut().insert(header::RETRY_AFTER, RETRY_AFTER);
        }
        response.extensions_mut().insert(self);
        response
    }
}

/// Middleware: adds the requested path to a problem.
pub async fn name_instance(request: Request, next: Next) -> Response {
    let path = request.uri().path().into();
    let mut response = next.run(request).await;
    match response.extensions_mut().remove::<Problem>() {
        Some(problem) => Problem { instance: Some(path), ..problem }.into_response(),
        None => response,
    }
}
