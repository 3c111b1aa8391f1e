//! The live stream: sends the activity of the benches to every client in real time.

pub mod frame;
mod hub;
mod outbox;

pub use hub::{Hub, Piece, Rows};

use crate::lab::Lab;
use crate::view::LiveMessage;
use axum::body::Bytes;
use axum::extract::ws::{Message, WebSocket};
use outbox::{Frame, Outbox};
use std::time::Duration;
use tokio::sync::broadcast::Receiver;
use tokio::sync::broadcast::error::RecvError;
use tokio::time::{Instant, MissedTickBehavior, interval, interval_at, timeout};

/// At most 30 frames a second.
const FRAME_EVERY: Duration = Duration::from_millis(34);

/// Interval of pings to a client if nothing else is sent.
const PING_EVERY: Duration = Duration::from_secs(20);
/// A client that answers or accepts nothing for this time is disconnected.
const SILENCE: Duration = Duration::from_secs(60);

/// Serves one client until it disconnects.
pub async fn serve(mut socket: WebSocket, lab: Lab) {
    let mut pieces = lab.hub().listen();
    let mut outbox = Outbox::default();
    for bench in lab.benches() {
        outbox.text(&LiveMessage::Bench { bench: Box::new(bench) });
    }
    let mut tick = interval(FRAME_EVERY);
    tick.set_missed_tick_behavior(MissedTickBehavior::Delay);
    let mut ping = interval_at(Instant::now() + PING_EVERY, PING_EVERY);
    ping.set_missed_tick_behavior(MissedTickBehavior::Delay);
    let mut heard_at = Instant::now();
    loop {
        tokio::select! {
            _ = tick.tick() => {
                drain(&mut pieces, &mut outbox);
                for frame in outbox.take() {
                    let message = match frame {
                        Frame::Text(text) => Message::Text(text.into()),
                        Frame::Binary(bytes) => Message::Binary(bytes.into()),
                    };
                    if !sent(&mut socket, message).await {
                        return;
                    }
                }
            }
            _ = ping.tick() => {
                if heard_at.elapsed() > SILENCE || !sent(&mut socket, Message::Ping(Bytes::new())).await {
                    return;
                }
            }
            piece = pieces.recv() => match piece {
                Ok(piece) => outbox.put(&piece),
                Err(RecvError::Lagged(pieces)) => outbox.lost(pieces),
                Err(RecvError::Closed) => return,
            },
            // Clients send no messages; reading answers pings and detects a disconnection.
            heard = socket.recv() => match heard {
                Some(Ok(_)) => heard_at = Instant::now(),
                _ => return,
            },
        }
    }
}

/// Returns whether the client has accepted the message.
async fn sent(socket: &mut WebSocket, message: Message) -> bool {
    matches!(timeout(SILENCE, socket.send(message)).await, Ok(Ok(())))
}

/// Collects the pieces that arrived during a write.
fn drain(pieces: &mut Receiver<Piece>, outbox: &mut Outbox) {
    use tokio::sync::broadcast::error::TryRecvError;
    loop {
        match pieces.try_recv() {
            Ok(piece) => outbox.put(&piece),
            Err(TryRecvError::Lagged(pieces)) => outbox.lost(pieces),
            Err(TryRecvError::Empty | TryRecvError::Closed) => return,
        }
    }
}
