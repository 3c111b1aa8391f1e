//! How much memory answers take while they are made and sent: an answer lies in memory until its reader has taken it, and a
//! reader may be slow, or many.

use super::problem::Problem;
use crate::lab::LabError;
use axum::body::{Body, Bytes, HttpBody};
use axum::extract::{Request, State};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use http_body::{Frame, SizeHint};
use std::pin::Pin;
use std::sync::Arc;
use std::task::{Context, Poll};
use std::time::Duration;
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio::time::timeout;

/// Answers that lie in memory together [MiB]. One below 1 MiB counts as nothing: connections are counted anyway.
const SENT_AT_ONCE_MIB: u32 = 128;
/// Whoever waits longer is sent away.
const PATIENCE: Duration = Duration::from_secs(10);

/// What the answers of one daemon share.
#[derive(Clone)]
pub struct Scales {
    sent: Arc<Semaphore>,
}

impl Default for Scales {
    fn default() -> Self {
        Self { sent: Arc::new(Semaphore::new(SENT_AT_ONCE_MIB as usize)) }
    }
}

/// How many go through at once, for operations that need much memory while they are carried out.
#[derive(Clone)]
pub struct Gate {
    made: Arc<Semaphore>,
}

impl Gate {
    pub fn of(at_once: usize) -> Self {
        Self { made: Arc::new(Semaphore::new(at_once)) }
    }
}

/// Middleware: waits at a gate.
pub async fn one_by_one(State(gate): State<Gate>, request: Request, next: Next) -> Response {
    match timeout(PATIENCE, gate.made.acquire()).await {
        Ok(Ok(_made)) => next.run(request).await,
        _ => busy(),
    }
}

/// Middleware: an answer that is large waits until there is room for it.
pub async fn weigh(State(scales): State<Scales>, request: Request, next: Next) -> Response {
    let response = next.run(request).await;
    let bytes = response.body().size_hint().lower();
    let weight = u32::try_from(bytes >> 20).unwrap_or(u32::MAX).min(SENT_AT_ONCE_MIB);
    if weight == 0 {
        return response;
    }
    let Ok(Ok(held)) = timeout(PATIENCE, scales.sent.clone().acquire_many_owned(weight)).await else { return busy() };
    response.map(|body| Body::new(Weighed { body, _held: held }))
}

fn busy() -> Response {
    let detail = "too many large responses at once: retry in a few seconds";
    Problem::from(LabError::Busy(detail.into())).into_response()
}

/// Gives its weight back when it was sent, or when its reader has gone.
struct Weighed {
    body: Body,
    _held: OwnedSemaphorePermit,
}

impl HttpBody for Weighed {
    type Data = Bytes;
    type Error = axum::Error;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, axum::Error>>> {
        Pin::new(&mut self.body).poll_frame(context)
    }

    fn size_hint(&self) -> SizeHint {
        self.body.size_hint()
    }

    fn is_end_stream(&self) -> bool {
        self.body.is_end_stream()
    }
}
