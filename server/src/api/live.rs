//! The live stream: JSON text frames and binary sample frames on one WebSocket.

use super::problem::Problem;
use super::refusals::Refusals;
use crate::lab::{Caller, Lab};
use crate::live::{Frame, Outbox, Piece};
use crate::view::LiveMessage;
use axum::Extension;
use axum::body::Bytes;
use axum::extract::State;
use axum::extract::ws::rejection::WebSocketUpgradeRejection;
use axum::extract::ws::{Message, WebSocket, WebSocketUpgrade};
use axum::response::Response;
use std::time::Duration;
use tokio::sync::broadcast::Receiver;
use tokio::sync::broadcast::error::{RecvError, TryRecvError};
use tokio::time::{Instant, MissedTickBehavior, interval, interval_at, timeout};

/// Clients send only pings and the end of the stream [bytes].
const LARGEST_RECEIVED: usize = 4096;
/// At most 30 frames a second.
const FRAME_EVERY: Duration = Duration::from_millis(34);

/// Interval of pings to a client if nothing else is sent.
const PING_EVERY: Duration = Duration::from_secs(20);
/// A client that answers or accepts nothing for this time is disconnected.
const SILENCE: Duration = Duration::from_secs(60);

/// Live stream (WebSocket)
///
/// Text frames are `LiveMessage`s. Binary frames carry samples, little endian: u32 sequence, u32 dropped frames, u32
/// rows, u32 channels, f64 t0 [s], then one f32 column after the other in the order of the last `channels` message;
/// `time_s` is relative to t0. A token is sent as the header `Authorization: Bearer TOKEN`, as `?token=TOKEN`, or, from
/// a browser and outside the address, in the subprotocols `jointbench` and `token.TOKEN` (percent-encoded). At most 30
/// frames a second; a slow client gets larger frames, never older ones.
#[utoipa::path(get, path = "/events", operation_id = "stream_events", tag = "live",
    responses((status = 101, description = "The stream", body = crate::view::LiveMessage), Refusals))]
pub async fn stream(
    State(lab): State<Lab>,
    Extension(caller): Extension<Caller>,
    upgrade: Result<WebSocketUpgrade, WebSocketUpgradeRejection>,
) -> Result<Response, Problem> {
    let upgrade = upgrade.map_err(|why| Problem::malformed(format!("{why}: open a WebSocket at this address")))?;
    // A browser closes the connection if no subprotocol is accepted.
    let upgrade = upgrade.max_message_size(LARGEST_RECEIVED).max_frame_size(LARGEST_RECEIVED).protocols(["jointbench"]);
    Ok(upgrade.on_upgrade(async move |socket| {
        tokio::select! {
            () = serve(socket, lab.clone()) => {}
            () = lab.until_revoked(&caller) => {}
        }
    }))
}

/// Serves one client until it disconnects.
async fn serve(mut socket: WebSocket, lab: Lab) {
    let mut pieces = lab.hub().subscribe();
    let mut outbox = Outbox::default();
    for bench in lab.benches() {
        outbox.text(&LiveMessage::Bench { bench: Box::new(bench) });
    }
    let mut tick = interval(FRAME_EVERY);
    tick.set_missed_tick_behavior(MissedTickBehavior::Delay);
    let mut ping = interval_at(Instant::now() + PING_EVERY, PING_EVERY);
    ping.set_missed_tick_behavior(MissedTickBehavior::Delay);
    let mut received_at = Instant::now();
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
                if received_at.elapsed() > SILENCE || !sent(&mut socket, Message::Ping(Bytes::new())).await {
                    return;
                }
            }
            piece = pieces.recv() => match piece {
                Ok(piece) => outbox.put(&piece),
                Err(RecvError::Lagged(pieces)) => outbox.lost(pieces),
                Err(RecvError::Closed) => return,
            },
            // Clients send no messages; reading answers pings and detects a disconnection.
            received = socket.recv() => match received {
                Some(Ok(_)) => received_at = Instant::now(),
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
    loop {
        match pieces.try_recv() {
            Ok(piece) => outbox.put(&piece),
            Err(TryRecvError::Lagged(pieces)) => outbox.lost(pieces),
            Err(TryRecvError::Empty | TryRecvError::Closed) => return,
        }
    }
}
