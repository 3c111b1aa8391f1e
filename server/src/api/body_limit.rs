//! Size limits of request bodies. No body is held in memory before its request is authenticated.

use super::problem::Problem;
use axum::body::{Body, Bytes, HttpBody};
use axum::extract::Request;
use axum::http::header::{CONTENT_LENGTH, EXPECT};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use http_body::{Frame, SizeHint};
use std::pin::Pin;
use std::sync::Arc;
use std::task::{Context, Poll};
use std::time::Duration;
use tokio::sync::{Semaphore, oneshot};

/// Largest body of an ordinary request.
pub const BODY_LIMIT_BYTES: usize = 1 << 20;
/// Largest table of a page.
pub const TABLE_LIMIT_BYTES: usize = 8 << 20;
/// Largest measured file.
pub const UPLOAD_LIMIT_BYTES: usize = 1 << 30;
/// Uploads at the same time.
pub const UPLOADS: usize = 2;

/// Limits for reading the rest of a refused body.
const MAX_DISCARDED_BYTES: usize = 16 << 20;
const DISCARD_TIMEOUT: Duration = Duration::from_secs(5);

/// Middleware: refuses a body whose announced size exceeds `limit`.
pub async fn guard(limit: usize, request: Request, next: Next) -> Response {
    match announced(&request) {
        Some(bytes) if bytes > limit => {
            let detail = format!("the request of {bytes} bytes exceeds the limit of {limit} bytes");
            Problem::too_large(detail).into_response()
        }
        _ => next.run(request).await,
    }
}

/// Middleware: refuses an upload while too many others are in progress.
pub async fn queue(uploads: Arc<Semaphore>, request: Request, next: Next) -> Response {
    match uploads.try_acquire() {
        Ok(_turn) => next.run(request).await,
        Err(_) => Problem::busy(format!("{UPLOADS} uploads are in progress: retry later")).into_response(),
    }
}

/// Middleware: after a refusal, reads and discards the rest of the body, within limits. Otherwise the client gets a broken
/// pipe instead of the refusal, and loses its connection.
pub async fn discard_body(request: Request, next: Next) -> Response {
    // Such a client has not sent the body.
    let asks_first = request.headers().contains_key(EXPECT);
    let (left, mut rest) = oneshot::channel();
    let response = next.run(request.map(|body| Body::new(ReturnedBody { body, left: Some(left) }))).await;
    if let Ok(body) = rest.try_recv()
        && !asks_first
    {
        let _ = tokio::time::timeout(DISCARD_TIMEOUT, discard(body)).await;
    }
    response
}

/// A body that is returned through `left` if it is dropped before its end.
struct ReturnedBody {
    body: Body,
    left: Option<oneshot::Sender<Body>>,
}

impl HttpBody for ReturnedBody {
    type Data = Bytes;
    type Error = axum::Error;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, Self::Error>>> {
        let polled = Pin::new(&mut self.body).poll_frame(context);
        if matches!(polled, Poll::Ready(None | Some(Err(_)))) {
            self.left = None;
        }
        polled
    }

    fn is_end_stream(&self) -> bool {
        self.body.is_end_stream()
    }

    fn size_hint(&self) -> SizeHint {
        self.body.size_hint()
    }
}

impl Drop for ReturnedBody {
    fn drop(&mut self) {
        if let Some(left) = self.left.take()
            && !self.body.is_end_stream()
        {
            // An error means that the answer is already being sent.
            let _ = left.send(std::mem::take(&mut self.body));
        }
    }
}

async fn discard(mut body: Body) {
    let mut bytes = 0;
    while let Some(Ok(frame)) = std::future::poll_fn(|context| Pin::new(&mut body).poll_frame(context)).await {
        bytes += frame.data_ref().map_or(0, Bytes::len);
        if bytes > MAX_DISCARDED_BYTES {
            return;
        }
    }
}

fn announced(request: &Request) -> Option<usize> {
    request.headers().get(CONTENT_LENGTH)?.to_str().ok()?.parse().ok()
}
