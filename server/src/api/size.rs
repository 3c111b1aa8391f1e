//! How much may be sent. No body is held in memory before its request has been let in.

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
/// Of a table that a page shows.
pub const TABLE_LIMIT_BYTES: usize = 8 << 20;
/// Of a measured file.
pub const UPLOAD_LIMIT_BYTES: usize = 1 << 30;
/// So many files come in at the same time.
pub const UPLOADS: usize = 2;

/// What is still read, and thrown away, of a body that nobody wanted.
const HEARD_OUT_BYTES: usize = 16 << 20;
const HEARD_OUT: Duration = Duration::from_secs(5);

/// Middleware: refuses a body that is announced as larger than `limit`.
pub async fn guard(limit: usize, request: Request, next: Next) -> Response {
    match announced(&request) {
        Some(bytes) if bytes > limit => {
            let detail = format!("the request of {bytes} bytes exceeds the limit of {limit} bytes");
            Problem::too_large(detail).into_response()
        }
        _ => next.run(request).await,
    }
}

/// Middleware: refuses a file while others come in.
pub async fn queue(uploads: Arc<Semaphore>, request: Request, next: Next) -> Response {
    match uploads.try_acquire() {
        Ok(_turn) => next.run(request).await,
        Err(_) => Problem::busy(format!("{UPLOADS} uploads are in progress: retry later")).into_response(),
    }
}

/// Middleware: reads to its end, within reason, and throws away what a refusal has left of a body. Whoever is cut off in
/// the middle of a sentence sees a broken pipe and never the refusal, and has no connection for the next request.
pub async fn hear_out(request: Request, next: Next) -> Response {
    // Who asks before sending has not sent anything.
    let asks_first = request.headers().contains_key(EXPECT);
    let (left, mut rest) = oneshot::channel();
    let response = next.run(request.map(|body| Body::new(Watched { body, left: Some(left) }))).await;
    if let Ok(body) = rest.try_recv()
        && !asks_first
    {
        let _ = tokio::time::timeout(HEARD_OUT, throw_away(body)).await;
    }
    response
}

/// A body that is handed back where it is dropped before its end.
struct Watched {
    body: Body,
    left: Option<oneshot::Sender<Body>>,
}

impl HttpBody for Watched {
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

impl Drop for Watched {
    fn drop(&mut self) {
        if let Some(left) = self.left.take()
            && !self.body.is_end_stream()
        {
            // An error says that the answer is on its way already.
            let _ = left.send(std::mem::take(&mut self.body));
        }
    }
}

async fn throw_away(mut body: Body) {
    let mut bytes = 0;
    while let Some(Ok(frame)) = std::future::poll_fn(|context| Pin::new(&mut body).poll_frame(context)).await {
        bytes += frame.data_ref().map_or(0, Bytes::len);
        if bytes > HEARD_OUT_BYTES {
            return;
        }
    }
}

fn announced(request: &Request) -> Option<usize> {
    request.headers().get(CONTENT_LENGTH)?.to_str().ok()?.parse().ok()
}
