//! The interface of a protocol to the link: bytes to send, and a scan of the received bytes. Never a port.

use jointbench_instrument::FaultKind;

/// The content at the start of the received bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scan {
    /// The beginning of a packet; more bytes are needed.
    Short,
    /// A whole packet, framing included.
    Packet {
        /// Length of the packet in bytes.
        length: usize,
    },
    /// Bytes that cannot begin a packet.
    Noise {
        /// Number of bytes to discard.
        skip: usize,
    },
}

/// A message to an instrument without a reply.
pub trait Command {
    /// Appends the bytes of the message.
    fn encode(&self, out: &mut Vec<u8>);

    /// Name of the command in faults and logs.
    fn name(&self) -> String;
}

/// A command that is answered. The request knows its reply.
pub trait Request: Command {
    /// Meaning of the reply.
    type Reply;

    /// Finds the reply at the start of the received bytes.
    fn scan(&self, received: &[u8]) -> Scan;

    /// `packet` has the length that [`Request::scan`] returned.
    fn decode(&self, packet: &[u8]) -> Result<Self::Reply, FaultKind>;
}

/// Printable form of bytes for the text of a fault, at most 48 of them.
pub fn shown(bytes: &[u8]) -> String {
    let head = &bytes[..bytes.len().min(48)];
    let rest = if head.len() < bytes.len() { "…" } else { "" };
    format!("`{}`{rest}", head.escape_ascii())
}
