//! What every answer says to a browser.

use super::door::Surroundings;
use axum::extract::Request;
use axum::http::HeaderValue;
use axum::http::header::{self, HeaderName};
use axum::middleware::Next;
use axum::response::Response;

/// An answer that has one of these already keeps its own.
const ALWAYS: [(HeaderName, &str); 7] = [
    (header::CONTENT_SECURITY_POLICY, jointbench_ui::CONTENT_SECURITY_POLICY),
    (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
    // For browsers that do not know `frame-ancestors`.
    (header::X_FRAME_OPTIONS, "DENY"),
    (header::REFERRER_POLICY, "no-referrer"),
    (
        HeaderName::from_static("permissions-policy"),
        "camera=(), geolocation=(), microphone=(), payment=(), serial=(), usb=()",
    ),
    (HeaderName::from_static("cross-origin-opener-policy"), "same-origin"),
    (HeaderName::from_static("cross-origin-resource-policy"), "same-origin"),
];
/// A browser that has come by TLS once does not come without for a year.
const ONLY_TLS: &str = "max-age=31536000";

/// Middleware: adds them. Nothing of the API stays in a cache: it is of now, and for who asked.
pub async fn add(surroundings: Surroundings, request: Request, next: Next) -> Response {
    let of_api = request.uri().path().starts_with("/api");
    let mut response = next.run(request).await;
    let headers = response.headers_mut();
    let mut say = |name: HeaderName, value| {
        headers.entry(name).or_insert(HeaderValue::from_static(value));
    };
    ALWAYS.into_iter().for_each(|(name, value)| say(name, value));
    if of_api {
        say(header::CACHE_CONTROL, "no-store");
    }
    if surroundings.tls {
        say(header::STRICT_TRANSPORT_SECURITY, ONLY_TLS);
    }
    response
}
