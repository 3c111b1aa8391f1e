//! Errors as they leave over HTTP: RFC 9457 problem documents. The one `From` decides the HTTP meaning of a refusal.

use crate::lab::LabError;
use crate::view::Place;
use axum::extract::Request;
use axum::extract::rejection::{JsonRejection, PathRejection, QueryRejection};
use axum::http::{HeaderValue, StatusCode, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use utoipa::openapi::{Content, RefOr, ResponseBuilder, schema::Ref};
use utoipa::{IntoResponses, ToSchema};

/// RFC 9457 problem document.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Problem {
    /// `urn:jointbench:` and the kind: `not_found`, `invalid`, `formula`, `file_refused`, `conflict`, `over`, `bench_fault`, `malformed`,
    /// `forbidden`, `unauthorized`, `not_allowed`, `too_large`, `busy`, `internal`.
    #[serde(rename = "type")]
    #[schema(value_type = String)]
    pub type_: Box<str>,
    #[schema(value_type = String)]
    pub title: Box<str>,
    pub status: u16,
    /// What is wrong and what to do about it.
    pub detail: String,
    /// The path that was asked for.
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
    /// Where a formula is wrong.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<Place>)]
    pub place: Option<Box<Place>>,
}

/// Kind of what no waiting will change.
const OVER: &str = "over";
/// Kind of what waiting alone changes.
const BUSY: &str = "busy";
/// When a client asks again that was refused for want of room [s].
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

    /// As [`LabError::exit_code`] says it of the same refusal.
    pub fn exit_code(&self) -> u8 {
        match self.status {
            409 if self.type_.ends_with(OVER) => 2,
            409 | 500.. => 1,
            _ => 2,
        }
    }

    pub fn malformed(detail: impl Into<String>) -> Self {
        Self::new(StatusCode::BAD_REQUEST, "malformed", "The request cannot be read", detail)
    }

    pub fn forbidden(detail: impl Into<String>) -> Self {
        Self::new(StatusCode::FORBIDDEN, "forbidden", "Not from there", detail)
    }

    pub fn unauthorized() -> Self {
        let detail = "this daemon was started with a token: send it as `Authorization: Bearer TOKEN`";
        Self::new(StatusCode::UNAUTHORIZED, "unauthorized", "A token is needed", detail)
    }

    pub fn too_large(detail: impl Into<String>) -> Self {
        Self::new(StatusCode::PAYLOAD_TOO_LARGE, "too_large", "The request is too large", detail)
    }

    /// A limit that others fill at the moment.
    pub fn busy(detail: impl Into<String>) -> Self {
        Self::new(StatusCode::SERVICE_UNAVAILABLE, BUSY, "Too much at once", detail)
    }

    /// Every connection but the reserved ones is taken.
    pub fn full() -> Self {
        Self::busy("every connection is taken; health and the software stop are still answered: try again in a second")
    }

    /// Too many wrong tokens from one address.
    pub fn too_many(detail: impl Into<String>) -> Self {
        Self::new(StatusCode::TOO_MANY_REQUESTS, BUSY, "Too many wrong tokens", detail)
    }

    pub fn no_method(method: &str, path: &str) -> Self {
        let detail = format!("{method} is not offered at {path}; /api/v1/openapi.json lists every operation");
        Self::new(StatusCode::METHOD_NOT_ALLOWED, "not_allowed", "Not offered there", detail)
    }

    pub fn no_route(path: &str) -> Self {
        let detail = format!("nothing is served at {path}; /api/v1/openapi.json lists every operation");
        Self::new(StatusCode::NOT_FOUND, "not_found", "Not there", detail)
    }
}

impl From<LabError> for Problem {
    fn from(error: LabError) -> Self {
        let detail = error.to_string();
        match error {
            LabError::NotFound(_) => Self::new(StatusCode::NOT_FOUND, "not_found", "Not there", detail),
            LabError::Invalid(_) => {
                Self::new(StatusCode::UNPROCESSABLE_ENTITY, "invalid", "The values do not fit", detail)
            }
            LabError::File { line, column, .. } => Self {
                line,
                column: column.map(String::into_boxed_str),
                ..Self::new(StatusCode::UNPROCESSABLE_ENTITY, "file_refused", "The file is refused", detail)
            },
            LabError::Formula(fault) => Self {
                place: Some(Box::new((*fault).into())),
                ..Self::new(StatusCode::UNPROCESSABLE_ENTITY, "formula", "The formula is wrong", detail)
            },
            LabError::Conflict(_) => Self::new(StatusCode::CONFLICT, "conflict", "Not at this moment", detail),
            LabError::Over(_) => Self::new(StatusCode::CONFLICT, OVER, "Not any more", detail),
            LabError::Busy(_) => Self::new(StatusCode::SERVICE_UNAVAILABLE, BUSY, "Not at this moment", detail),
            LabError::TooLarge(_) => Self::new(StatusCode::PAYLOAD_TOO_LARGE, "too_large", "Too large", detail),
            LabError::Bench(_) => {
                Self::new(StatusCode::SERVICE_UNAVAILABLE, "bench_fault", "The bench does not answer", detail)
            }
            LabError::Setup(_) | LabError::Internal(_) => {
                tracing::error!(%detail, "request failed inside");
                Self::new(StatusCode::INTERNAL_SERVER_ERROR, "internal", "The daemon failed", detail)
            }
        }
    }
}

const SEE: &str = "; /api/v1/openapi.json describes every operation";

/// Without the extractor's own preface.
fn plain(text: &str) -> &str {
    text.split_once(": ").map_or(text, |(_, what)| what)
}

impl From<JsonRejection> for Problem {
    fn from(rejection: JsonRejection) -> Self {
        match rejection.status() {
            StatusCode::PAYLOAD_TOO_LARGE => Self::too_large(rejection.body_text()),
            StatusCode::UNSUPPORTED_MEDIA_TYPE => Self::malformed("send JSON with `Content-Type: application/json`"),
            _ => Self::malformed(format!("the JSON body does not fit: {}{SEE}", plain(&rejection.body_text()))),
        }
    }
}

impl From<QueryRejection> for Problem {
    fn from(rejection: QueryRejection) -> Self {
        Self::malformed(format!("the query does not fit: {}{SEE}", plain(&rejection.body_text())))
    }
}

impl From<PathRejection> for Problem {
    fn from(rejection: PathRejection) -> Self {
        Self::malformed(format!("the path does not fit: {}{SEE}", plain(&rejection.body_text())))
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

/// Middleware: a problem names the path that was asked for.
pub async fn name_instance(request: Request, next: Next) -> Response {
    let path = request.uri().path().into();
    let mut response = next.run(request).await;
    match response.extensions_mut().remove::<Problem>() {
        Some(problem) => Problem { instance: Some(path), ..problem }.into_response(),
        None => response,
    }
}

/// The documented form of every refusal.
pub struct Refusals;

impl IntoResponses for Refusals {
    fn responses() -> BTreeMap<String, RefOr<utoipa::openapi::Response>> {
        let response = ResponseBuilder::new()
            .description("Refused: a problem document (RFC 9457) that says what is wrong and what to do")
            .content("application/problem+json", Content::new(Some(Ref::from_schema_name("Problem"))))
            .build();
        BTreeMap::from([("default".to_owned(), RefOr::T(response))])
    }
}
