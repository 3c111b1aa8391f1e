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
    let announced = request.headers().get(CONTENT_LENGTH).and_then(|value| value.to_str().ok()?.parse::<usize>().ok());
    match announced {
        Some(bytes) if bytes > BODY_LIMIT_BYTES => {
            let _ = to_bytes(request.into_body(), HEARD_OUT_BYTES).await;
            let detail = format!("a request of {bytes} bytes is refused; at most {BODY_LIMIT_BYTES} bytes are read");
            Problem::too_large(detail).into_response()
        }
        _ => next.run(request).await,
    }
}
