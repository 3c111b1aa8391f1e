//! Requests of one connection, each executed in its own task.

use super::body::{Arriving, Leaving};
use super::slots::ConnectionSlot;
use super::stage::Stage;
use super::{Demand, Limits};
use crate::api::{Presence, Problem};
use axum::Router;
use axum::body::Body;
use axum::extract::ConnectInfo;
use axum::response::{IntoResponse, Response};
use hyper::body::Incoming;
use hyper::service::Service;
use hyper::{Request, StatusCode};
use std::convert::Infallible;
use std::net::SocketAddr;
use std::pin::Pin;
use std::sync::Arc;
use tokio::task::{JoinError, JoinHandle};
use tokio_util::task::AbortOnDropHandle;
use tower::ServiceExt;

pub struct Answering {
    pub router: Router,
    pub peer: SocketAddr,
    pub limits: Arc<Limits>,
    pub slot: Arc<ConnectionSlot>,
}

type Answer = hyper::Response<Leaving>;

impl Service<Request<Incoming>> for Answering {
    type Response = Answer;
    type Error = Infallible;
    type Future = Pin<Box<dyn Future<Output = Result<Answer, Infallible>> + Send>>;

    /// Starts the execution of the request before it returns. A client that disconnects drops only the returned future;
    /// the request continues unless it is read-only.
    fn call(&self, request: Request<Incoming>) -> Self::Future {
        let progress = self.slot.progress.clone();
        progress.enter(Stage::Answer);
        let demand = Demand::of(request.method(), request.uri().path());
        if !self.slot.admits(demand) {
            return Box::pin(async { Ok(Problem::full().into_response().map(|body| Leaving::new(body, None))) });
        }
        let (is_safe, presence) = (request.method().is_safe(), Presence::default());
        // Created here because the future may never be polled.
        let guard = presence.guard();
        let answer = Begun::new(is_safe, self.begin(request, demand, presence));
        Box::pin(async move {
            let response = answer.ended().await.unwrap_or_else(|fault| failed(&fault));
            guard.disarm();
            let follows = match response.status() {
                StatusCode::SWITCHING_PROTOCOLS => {
                    progress.enter(Stage::Stream);
                    None
                }
                _ => Some(progress),
            };
            Ok(response.map(|body| Leaving::new(body, follows)))
        })
    }
}

impl Answering {
    fn begin(&self, request: Request<Incoming>, demand: Demand, presence: Presence) -> JoinHandle<Response> {
        let (limits, progress) = (self.limits.clone(), self.slot.progress.clone());
        let mut request = request.map(|body| Body::new(Arriving::new(body, demand, limits, progress)));
        request.extensions_mut().insert(ConnectInfo(self.peer));
        request.extensions_mut().insert(presence);
        let router = self.router.clone();
        tokio::spawn(async move {
            let Ok(response) = router.oneshot(request).await;
            response
        })
    }
}

/// A request in progress.
enum Begun {
    /// Read-only: ends with its client.
    Safe(AbortOnDropHandle<Response>),
    /// Continues to its end without its client.
    Changing(JoinHandle<Response>),
}

impl Begun {
    fn new(is_safe: bool, task: JoinHandle<Response>) -> Self {
        match is_safe {
            true => Begun::Safe(AbortOnDropHandle::new(task)),
            false => Begun::Changing(task),
        }
    }

    async fn ended(self) -> Result<Response, JoinError> {
        match self {
            Begun::Safe(task) => task.await,
            Begun::Changing(task) => task.await,
        }
    }
}

fn failed(fault: &JoinError) -> Response {
    tracing::error!(%fault, "a request has panicked");
    let detail = "internal error of the daemon; see its log";
    Problem::new(StatusCode::INTERNAL_SERVER_ERROR, "internal", "The daemon failed", detail).into_response()
}
