//! Live.
pub async fn serve(_socket: axum::extract::ws::WebSocket, _lab: crate::lab::Lab) {}
