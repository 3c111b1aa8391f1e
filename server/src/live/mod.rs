//! The live stream: what the benches do, to every client, as it happens.

pub mod frame;
mod hub;
mod outbox;

pub use hub::{Hub, Piece, Rows};

use crate::lab::Lab;
use crate::view::LiveMessage;
use axum::extract::ws::{Message, WebSocket};
use outbox::{Frame, Outbox};
use std::time::Duration;
use tokio::sync::broadcast::Receiver;
use tokio::sync::broadcast::error::RecvError;
use tokio::time::{MissedTickBehavior, interval};

/// At most 30 frames a second.
const FRAME_EVERY: Duration = Duration::from_millis(34);

/// Serves one client until it leaves.
pub async fn serve(mut socket: WebSocket, lab: Lab) {
    let mut pieces = lab.hub().listen();
    let mut outbox = Outbox::default();
    for bench in lab.benches() {
        outbox.text(&LiveMessage::Bench { bench: Box::new(bench) });
    }
    let mut tick = interval(FRAME_EVERY);
    tick.set_missed_tick_behavior(MissedTickBehavior::Delay);
    loop {
        tokio::select! {
            _ = tick.tick() => {
                drain(&mut pieces, &mut outbox);
                for frame in outbox.take() {
                    let message = match frame {
                        Frame::Text(text) => Message::Text(text.into()),
                        Frame::Binary(bytes) => Message::Binary(bytes.into()),
                    };
                    if socket.send(message).await.is_err() {
                        return;
                    }
                }
            }
            piece = pieces.recv() => match piece {
                Ok(piece) => outbox.put(&piece),
                Err(RecvError::Lagged(pieces)) => outbox.lost(pieces),
                Err(RecvError::Closed) => return,
            },
            // A client has nothing to say; reading answers its pings and notices when it leaves.
            heard = socket.recv() => if !matches!(heard, Some(Ok(_))) {
                return;
            },
        }
    }
}

/// What came in while the client was being written to.
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
