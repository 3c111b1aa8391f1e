//! How long a connection may keep the daemon waiting, and how many there may be.

use std::time::Duration;

#[derive(Debug, Clone)]
pub struct Limits {
    /// From the connection, or from the first byte of a further request, to the end of the request's head.
    pub head: Duration,
    /// Between two requests of one connection.
    pub idle: Duration,
    /// Within this time [`Limits::body_progress_bytes`] of a body must arrive, or its end.
    pub body_pause: Duration,
    pub body_progress_bytes: usize,
    /// A whole body; an upload has no such limit, only the one above.
    pub body_total: Duration,
    /// A client that accepts no byte of its answer for so long is disconnected.
    pub write_stall: Duration,
    /// All connections together.
    pub connections: usize,
    /// Of these only for requests that must always be answered ([`super::Demand::Vital`]).
    pub reserved: usize,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            head: Duration::from_secs(10),
            idle: Duration::from_secs(75),
            body_pause: Duration::from_secs(10),
            body_progress_bytes: 1024,
            body_total: Duration::from_secs(120),
            write_stall: Duration::from_secs(60),
            connections: 256,
            reserved: 16,
        }
    }
}

/// The head of a request, and what is buffered of a connection in each direction.
pub const HEAD_BYTES: usize = 32 << 10;
pub const HEADERS: usize = 64;
