//! Limits the memory of large answers. An answer is in memory until its client has received it, and clients may be slow.

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

/// Memory of all answers [MiB]. An answer below 1 MiB is not counted, because connections are limited.
const SENT_AT_ONCE_MIB: u32 = 128;
/// A request that waits longer is refused.
const PATIENCE: Duration = Duration::from_secs(10);

/// Shared by all answers of a daemon.
#[derive(Clone)]
pub struct ResponseBudget {
    sent: Arc<Semaphore>,
}

impl Default for ResponseBudget {
    fn default() -> Self {
        Self { sent: Arc::new(Semaphore::new(SENT_AT_ONCE_MIB as usize)) }
    }
}

/// Limits the number of simultaneous requests, for operations that need much memory.
#[derive(Clone)]
pub struct ConcurrencyLimit {
    made: Arc<Semaphore>,
}

impl ConcurrencyLimit {
    pub fn of(at_once: usize) -> Self {
        Self { made: Arc::new(Semaphore::new(at_once)) }
    }
}

/// Middleware: waits until the number of requests is below the limit.
pub async fn limit_concurrency(State(limit): State<ConcurrencyLimit>, request: Request, next: Next) -> Response {
    match timeout(PATIENCE, limit.made.acquire()).await {
        Ok(Ok(_made)) => next.run(request).await,
        _ => busy(),
    }
}

/// Middleware: a large answer waits for free memory.
pub async fn limit_memory(State(budget): State<ResponseBudget>, request: Request, next: Next) -> Response {
    let response = next.run(request).await;
    let bytes = response.body().size_hint().lower();
    let weight = u32::try_from(bytes >> 20).unwrap_or(u32::MAX).min(SENT_AT_ONCE_MIB);
    if weight == 0 {
        return response;
    }
    let Ok(Ok(held)) = timeout(PATIENCE, budget.sent.clone().acquire_many_owned(weight)).await else { return busy() };
    response.map(|body| Body::new(Budgeted { body, _held: held }))
}

fn busy() -> Response {
    let detail = "too many large responses at once: retry in a few seconds";
    Problem::from(LabError::Busy(detail.into())).into_response()
}

/// Releases its memory when it is sent, or when its client has disconnected.
struct Budgeted {
    body: Body,
    _held: OwnedSemaphorePermit,
}

impl HttpBody for Budgeted {
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
