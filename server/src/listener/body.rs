//! Bodies: a request body must arrive in time, and the end of a response body is detected.

use super::stage::{Progress, Stage};
use super::{Demand, Limits};
use axum::BoxError;
use axum::body::{Body, Bytes};
use http_body::{Body as HttpBody, Frame, SizeHint};
use hyper::body::Incoming;
use std::pin::Pin;
use std::sync::Arc;
use std::task::{Context, Poll};
use tokio::time::{Sleep, sleep};

/// Body of a request. It fails if its client pauses too long or exceeds the total time.
pub struct Arriving {
    inner: Incoming,
    limits: Arc<Limits>,
    progress: Arc<Progress>,
    total: Option<Pin<Box<Sleep>>>,
    pause: Option<Pin<Box<Sleep>>>,
    /// Bytes since the start of the pause timer.
    bytes: usize,
}

impl Arriving {
    pub fn new(inner: Incoming, demand: Demand, limits: Arc<Limits>, progress: Arc<Progress>) -> Self {
        let total = (demand != Demand::Upload).then(|| Box::pin(sleep(limits.body_total)));
        Self { inner, limits, progress, total, pause: None, bytes: 0 }
    }

    fn arrived(&mut self, frame: &Frame<Bytes>) {
        self.progress.enter(Stage::Answer);
        self.bytes += frame.data_ref().map_or(0, Bytes::len);
        if self.bytes >= self.limits.body_progress_bytes {
            (self.pause, self.bytes) = (None, 0);
        }
    }

    /// The reason to stop waiting for further bytes.
    fn ended(&mut self, context: &mut Context<'_>) -> Option<&'static str> {
        self.progress.enter(Stage::Body);
        let pause = self.pause.get_or_insert_with(|| Box::pin(sleep(self.limits.body_pause)));
        if pause.as_mut().poll(context).is_ready() {
            return Some("the request body stopped arriving");
        }
        let total = self.total.as_mut()?;
        total.as_mut().poll(context).is_ready().then_some("the request body took too long")
    }
}

impl HttpBody for Arriving {
    type Data = Bytes;
    type Error = BoxError;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, Self::Error>>> {
        match Pin::new(&mut self.inner).poll_frame(context) {
            Poll::Pending => match self.ended(context) {
                Some(why) => Poll::Ready(Some(Err(why.into()))),
                None => Poll::Pending,
            },
            Poll::Ready(Some(Ok(frame))) => {
                self.arrived(&frame);
                Poll::Ready(Some(Ok(frame)))
            }
            Poll::Ready(end) => {
                self.progress.enter(Stage::Answer);
                Poll::Ready(end.map(|frame| frame.map_err(Into::into)))
            }
        }
    }

    fn is_end_stream(&self) -> bool {
        self.inner.is_end_stream()
    }

    fn size_hint(&self) -> SizeHint {
        self.inner.size_hint()
    }
}

/// Body of a response. After its end, the connection waits for the next request.
pub struct Leaving {
    inner: Body,
    progress: Option<Arc<Progress>>,
}

impl Leaving {
    /// `progress`: `None` if no further request follows.
    pub fn new(inner: Body, progress: Option<Arc<Progress>>) -> Self {
        Self { inner, progress }
    }
}

impl HttpBody for Leaving {
    type Data = Bytes;
    type Error = axum::Error;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, Self::Error>>> {
        Pin::new(&mut self.inner).poll_frame(context)
    }

    fn is_end_stream(&self) -> bool {
        self.inner.is_end_stream()
    }

    fn size_hint(&self) -> SizeHint {
        self.inner.size_hint()
    }
}

impl Drop for Leaving {
    fn drop(&mut self) {
        if let Some(progress) = &self.progress {
            progress.enter(Stage::Idle);
        }
    }
}
