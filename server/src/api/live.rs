//! The live stream: JSON text frames and binary sample frames on one WebSocket.

use super::problem::Problem;
use super::refusals::Refusals;
use crate::lab::{Caller, Lab};
use axum::Extension;
use axum::extract::State;
use axum::extract::ws::WebSocketUpgrade;
use axum::extract::ws::rejection::WebSocketUpgradeRejection;
use axum::response::Response;

/// A client has nothing to say: pings and the end are small [bytes].
const LARGEST_HEARD: usize = 4096;

/// Live stream (WebSocket)
///
/// Text frames are `LiveMessage`s. Binary frames carry samples, little endian: u32 sequence, u32 dropped frames, u32
/// rows, u32 channels, f64 t0 [s], then one f32 column after the other in the order of the last `channels` message;
/// `time_s` is relative to t0. A token is sent as the header `Authorization: Bearer TOKEN`, as `?token=TOKEN`, or, from
/// a browser and outside the address, in the subprotocols `jointbench` and `token.TOKEN` (percent-encoded). At most 30
/// frames a second; a slow client gets larger frames, never older ones.
#[utoipa::path(get, path = "/events", tag = "live",
    responses((status = 101, description = "The stream", body = crate::view::LiveMessage), Refusals))]
pub async fn stream(
    State(lab): State<Lab>,
    Extension(caller): Extension<Caller>,
    upgrade: Result<WebSocketUpgrade, WebSocketUpgradeRejection>,
) -> Result<Response, Problem> {
    let upgrade = upgrade.map_err(|why| Problem::malformed(format!("{why}: open a WebSocket at this address")))?;
    // A browser hangs up where none of what it offers is taken.
    let upgrade = upgrade.max_message_size(LARGEST_HEARD).max_frame_size(LARGEST_HEARD).protocols(["jointbench"]);
    Ok(upgrade.on_upgrade(async move |socket| {
        tokio::select! {
            () = crate::live::serve(socket, lab.clone()) => {}
            () = lab.shut_out(&caller) => {}
        }
    }))
}
