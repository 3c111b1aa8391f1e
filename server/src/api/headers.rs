//! Security headers of every answer.

use super::auth::Transport;
use axum::extract::Request;
use axum::http::HeaderValue;
use axum::http::header::{self, HeaderName};
use axum::middleware::Next;
use axum::response::Response;

/// An answer with one of these headers keeps its value.
const ALWAYS: [(HeaderName, &str); 7] = [
    (header::CONTENT_SECURITY_POLICY, jointbench_ui::CONTENT_SECURITY_POLICY),
    (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
    // For browsers without `frame-ancestors`.
    (header::X_FRAME_OPTIONS, "DENY"),
    (header::REFERRER_POLICY, "no-referrer"),
    (
        HeaderName::from_static("permissions-policy"),
        "camera=(), geolocation=(), microphone=(), payment=(), serial=(), usb=()",
    ),
    (HeaderName::from_static("cross-origin-opener-policy"), "same-origin"),
    (HeaderName::from_static("cross-origin-resource-policy"), "same-origin"),
];
/// After the first connection by TLS, a browser uses only TLS for a year.
const ONLY_TLS: &str = "max-age=31536000";

/// Middleware: adds the headers. Answers of the API are never cached: they are current and personal.
pub async fn add(transport: Transport, request: Request, next: Next) -> Response {
    let of_api = request.uri().path().starts_with("/api");
    let mut response = next.run(request).await;
    let headers = response.headers_mut();
    let mut insert = |name: HeaderName, value| {
        headers.entry(name).or_insert(HeaderValue::from_static(value));
    };
    ALWAYS.into_iter().for_each(|(name, value)| insert(name, value));
    if of_api {
        insert(header::CACHE_CONTROL, "no-store");
    }
    if transport.tls {
        insert(header::STRICT_TRANSPORT_SECURITY, ONLY_TLS);
    }
    response
}
