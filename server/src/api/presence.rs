//! Whether the client that asked is still connected.
//!
//! A request that changes something is carried out to its end, whether its client waits for the answer or not. A long
//! computation may want to know all the same that nobody waits any more.

use axum::extract::FromRequestParts;
use axum::http::request::Parts;
use std::convert::Infallible;
use tokio_util::sync::{CancellationToken, DropGuard};

/// The client of one request. A handler takes it as an argument. Cheap to clone.
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

    /// For the connection: dropping the guard before [`DropGuard::disarm`] says that the client is gone.
    pub fn guard(&self) -> DropGuard {
        self.0.clone().drop_guard()
    }
}

/// A request that came over no connection has a client that stays.
impl<S: Sync> FromRequestParts<S> for Presence {
    type Rejection = Infallible;

    async fn from_request_parts(parts: &mut Parts, _: &S) -> Result<Self, Infallible> {
        Ok(parts.extensions.get::<Presence>().cloned().unwrap_or_default())
    }
}
