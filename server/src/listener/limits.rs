//! Limits of the number of connections and of their waiting times.

use std::time::Duration;

#[derive(Debug, Clone)]
pub struct Limits {
    /// From the start of the connection, or the first byte of a further request, to the end of the request head.
    pub head: Duration,
    /// Between two requests of one connection.
    pub idle: Duration,
    /// In this time, [`Limits::body_progress_bytes`] or the end of a body must arrive.
    pub body_pause: Duration,
    pub body_progress_bytes: usize,
    /// Limit of a whole body; not for an upload, which only has the limit above.
    pub body_total: Duration,
    /// A client that accepts no byte of its answer in this time is disconnected.
    pub write_stall: Duration,
    /// All connections.
    pub connections: usize,
    /// Connections of these that are only for requests that must always be answered ([`super::Demand::Vital`]).
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

/// Size of a request head, and buffer of a connection in each direction.
pub const HEAD_BYTES: usize = 32 << 10;
pub const HEADERS: usize = 64;
