//! What the instruments speak: bytes in, bytes out, no port. One type for each command; a request knows its reply.

pub mod gcs;
pub mod lorenz;
pub mod modbus;
pub mod odrive;
pub mod puma;
pub mod qsb;
pub mod scpi;

use crate::transport::Scan;

/// A reply line up to its line feed. Longer than `limit` without one: noise.
fn scan_line(received: &[u8], limit: usize) -> Scan {
    match received.iter().position(|byte| *byte == b'\n') {
        Some(end) => Scan::Packet { length: end + 1 },
        None if received.len() > limit => Scan::Noise { skip: received.len() },
        None => Scan::Short,
    }
}
