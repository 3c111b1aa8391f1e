//! How much may be sent.

use super::problem::Problem;
use axum::body::to_bytes;
use axum::extract::Request;
use axum::http::header::CONTENT_LENGTH;
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};

/// Largest body of an ordinary request; an upload may have [`UPLOAD_LIMIT_BYTES`].
pub const BODY_LIMIT_BYTES: usize = 1 << 20;
pub const UPLOAD_LIMIT_BYTES: usize = 1 << 30;

/// What is still read of a body that is refused.
const HEARD_OUT_BYTES: usize = 16 << 20;

/// Middleware: refuses a body that is announced as too large, after it has been heard to its end (within reason). Who is cut
/// off in the middle of a sentence sees a broken pipe and never the refusal.
pub async fn guard(request: Request, next: Next) -> Response {
    match announced(&request) {
        Some(bytes) if bytes > BODY_LIMIT_BYTES => {
            hear_out(request).await;
            let detail = format!("a request of {bytes} bytes is refused; at most {BODY_LIMIT_BYTES} bytes are read");
            Problem::too_large(detail).into_response()
        }
        _ => next.run(request).await,
    }
}

/// Middleware: takes an ordinary body in before anything looks at the request. Whoever then refuses it for its path, its method or
/// its token leaves nothing unread on the connection, which would be closed under the client's next request.
pub async fn take_in(request: Request, next: Next) -> Response {
    if announced(&request).is_none_or(|bytes| bytes > BODY_LIMIT_BYTES) {
        return next.run(request).await;
    }
    let (parts, body) = request.into_parts();
    match to_bytes(body, BODY_LIMIT_BYTES).await {
        Ok(bytes) => next.run(Request::from_parts(parts, bytes.into())).await,
        Err(_) => Problem::malformed("the body broke off").into_response(),
    }
}

/// What is left of a refused body.
pub async fn hear_out(request: Request) {
    let _ = to_bytes(request.into_body(), HEARD_OUT_BYTES).await;
}

fn announced(request: &Request) -> Option<usize> {
    request.headers().get(CONTENT_LENGTH)?.to_str().ok()?.parse().ok()
}
