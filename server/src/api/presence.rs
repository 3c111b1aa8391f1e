//! Whether the client of a request is still connected.
//!
//! A changing request is completed even if its client disconnects. A long computation can be cancelled.

use axum::extract::FromRequestParts;
use axum::http::request::Parts;
use std::convert::Infallible;
use tokio_util::sync::{CancellationToken, DropGuard};

/// The client of one request, as an argument of a handler. Cheap to clone.
#[derive(Debug, Clone, Default)]
pub struct Presence(CancellationToken);

impl Presence {
    /// Returns when the connection has closed before the answer was ready; never otherwise.
    pub async fn gone(&self) {
        self.0.cancelled().await;
    }

    pub fn is_gone(&self) -> bool {
        self.0.is_cancelled()
    }

    /// For the connection: dropping the guard before [`DropGuard::disarm`] reports that the client is gone.
    pub fn guard(&self) -> DropGuard {
        self.0.clone().drop_guard()
    }
}

/// Without a connection, the client never disconnects.
impl<S: Sync> FromRequestParts<S> for Presence {
    type Rejection = Infallible;

    async fn from_request_parts(parts: &mut Parts, _: &S) -> Result<Self, Infallible> {
        Ok(parts.extensions.get::<Presence>().cloned().unwrap_or_default())
    }
}
