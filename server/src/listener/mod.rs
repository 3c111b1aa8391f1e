//! The accept loop: connections within limits, below the router.
//!
//! Guarantees: a request that has arrived is executed even if its client disconnects. A slow client cannot block other
//! clients. [`Demand::Vital`] requests are answered even if all other connections are in use.

mod answering;
mod body;
mod demand;
mod limits;
mod slots;
mod stage;
mod tls;
mod wire;

pub use demand::Demand;
pub use limits::Limits;
pub use tls::{Tls, TlsFiles};

use answering::Answering;
use axum::Router;
use hyper::server::conn::http1;
use hyper_util::rt::TokioIo;
use slots::{ConnectionSlot, ConnectionSlots};
use std::net::SocketAddr;
use std::sync::Arc;
use std::time::Duration;
use tokio::io::{AsyncRead, AsyncWrite};
use tokio::net::{TcpListener, TcpStream};
use tokio::task::JoinSet;
use wire::Wire;

/// Interval of the check for clients that exceed a time limit.
const CHECK_INTERVAL: Duration = Duration::from_millis(250);
/// Pause after the system has refused a connection, usually because of too many open files.
const REFUSED_PAUSE: Duration = Duration::from_millis(50);

/// Shared data of the connections.
#[derive(Clone)]
struct Shared {
    router: Router,
    tls: Option<Tls>,
    limits: Arc<Limits>,
}

/// Serves until it is dropped, which closes every connection.
pub async fn serve(listener: TcpListener, router: Router, tls: Option<Tls>, limits: Limits) {
    let limits = Arc::new(limits);
    let slots = ConnectionSlots::new(limits.clone());
    let mut connections = JoinSet::new();
    if let Some(tls) = tls.clone() {
        connections.spawn(async move { tls.follow().await });
    }
    let shared = Shared { router, tls, limits };
    let mut check = tokio::time::interval(CHECK_INTERVAL);
    loop {
        tokio::select! {
            accepted = listener.accept() => match accepted {
                Ok((stream, peer)) => match slots.take() {
                    Some(slot) => drop(connections.spawn(connection(shared.clone(), stream, peer, slot))),
                    None => tracing::warn!(%peer, "a connection is refused: every other one is being answered"),
                },
                Err(fault) => {
                    tracing::warn!(%fault, "a connection is refused by the system");
                    tokio::time::sleep(REFUSED_PAUSE).await;
                }
            },
            Some(ended) = connections.join_next() => if let Err(fault) = ended {
                tracing::error!(%fault, "a connection has panicked");
            },
            _ = check.tick() => slots.close_overdue(),
        }
    }
}

async fn connection(shared: Shared, stream: TcpStream, peer: SocketAddr, slot: ConnectionSlot) {
    let close = slot.close.clone();
    tokio::select! {
        () = close.cancelled() => tracing::debug!(%peer, "connection closed: it has waited for its client for too long"),
        () = handshake(shared, stream, peer, slot) => {}
    }
}

async fn handshake(shared: Shared, stream: TcpStream, peer: SocketAddr, slot: ConnectionSlot) {
    // Sends small answers immediately. This fails if the client has already disconnected, but its request still counts.
    let _ = stream.set_nodelay(true);
    match &shared.tls {
        None => serve_connection(&shared, stream, peer, slot).await,
        Some(tls) => match tls.accept(stream).await {
            Ok(stream) => serve_connection(&shared, stream, peer, slot).await,
            Err(fault) => tracing::debug!(%peer, %fault, "no TLS connection"),
        },
    }
}

async fn serve_connection<S>(shared: &Shared, stream: S, peer: SocketAddr, slot: ConnectionSlot)
where
    S: AsyncRead + AsyncWrite + Unpin + Send + 'static,
{
    let slot = Arc::new(slot);
    let wire = Wire::new(stream, slot.clone(), shared.limits.write_stall);
    let service = Answering { router: shared.router.clone(), peer, limits: shared.limits.clone(), slot };
    let served = http1::Builder::new()
        // The limits of this module distinguish a slow head from an idle connection.
        .header_read_timeout(None)
        .max_headers(limits::HEADERS)
        .max_buf_size(limits::HEAD_BYTES)
        .serve_connection(TokioIo::new(wire), service)
        .with_upgrades()
        .await;
    if let Err(fault) = served {
        tracing::debug!(%peer, %fault, "connection ended");
    }
}
