//! The live stream: distributes the activity of the benches to the clients. `api::live` sends it.

pub mod frame;
mod hub;
mod outbox;

pub use hub::{Hub, Piece, Rows};
pub use outbox::{Frame, Outbox};
