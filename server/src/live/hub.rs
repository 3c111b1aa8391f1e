//! Distributes data of the bench threads to all clients: best effort, without waiting.

use crate::view::LiveMessage;
use jointbench_instrument::Trace;
use std::sync::Arc;
use tokio::sync::broadcast::{self, Receiver, Sender};

/// A client that is this many pieces behind loses the oldest piece.
const CAPACITY: usize = 1024;

/// The newest rows of a run.
#[derive(Debug, Clone)]
pub struct Rows {
    pub bench: String,
    pub run: i64,
    pub rows: Trace,
}

#[derive(Debug, Clone)]
pub enum Piece {
    Message(Arc<LiveMessage>),
    Rows(Arc<Rows>),
}

/// Publishes pieces to subscribers. Cheap to clone.
#[derive(Debug, Clone)]
pub struct Hub {
    pieces: Sender<Piece>,
}

impl Hub {
    pub fn new() -> Self {
        Self { pieces: broadcast::channel(CAPACITY).0 }
    }

    pub fn publish(&self, message: LiveMessage) {
        // An error only means that there are no subscribers.
        let _ = self.pieces.send(Piece::Message(Arc::new(message)));
    }

    pub fn publish_rows(&self, rows: Rows) {
        if self.pieces.receiver_count() > 0 {
            let _ = self.pieces.send(Piece::Rows(Arc::new(rows)));
        }
    }

    pub fn subscribe(&self) -> Receiver<Piece> {
        self.pieces.subscribe()
    }
}

impl Default for Hub {
    fn default() -> Self {
        Self::new()
    }
}
