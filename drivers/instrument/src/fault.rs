//! What can go wrong with an instrument, and what the caller may do about it.

use serde::{Deserialize, Serialize};

/// A fault of one instrument on one port.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, thiserror::Error)]
#[error("{instrument} on {port}: {kind}")]
pub struct Fault {
    pub instrument: String,
    pub port: String,
    pub kind: FaultKind,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, thiserror::Error)]
#[serde(rename_all = "snake_case", tag = "fault", content = "detail")]
pub enum FaultKind {
    #[error("no reply within {deadline_ms} ms to {request}")]
    Silent { request: String, deadline_ms: u64 },
    #[error("reply not understood: {what}")]
    Garbled { what: String },
    #[error("port lost: {what}; check cable and power")]
    Disconnected { what: String },
    #[error("port cannot be opened: {what}")]
    NotOpened { what: String },
    #[error("another instrument answers: expected {expected}, found {found}")]
    WrongInstrument { expected: String, found: String },
    #[error("request refused: {what}")]
    Refused { what: String },
    #[error("instrument reports an error: {what}")]
    Reported { what: String },
    #[error("reading out of range: {what}")]
    Saturated { what: String },
    #[error("{count} samples missing from the stream")]
    StreamGap { count: u64 },
}

impl FaultKind {
    pub fn at(self, instrument: &str, port: &str) -> Fault {
        Fault { instrument: instrument.to_owned(), port: port.to_owned(), kind: self }
    }
}

impl Fault {
    /// The port is gone, and whatever was behind it.
    pub fn is_port_lost(&self) -> bool {
        matches!(self.kind, FaultKind::Disconnected { .. } | FaultKind::NotOpened { .. })
    }

    /// Another instrument answers than the one that was there before.
    pub fn is_wrong_instrument(&self) -> bool {
        matches!(self.kind, FaultKind::WrongInstrument { .. })
    }

    /// Worth one more try after the link was drained and the instrument identified again.
    pub fn is_retryable(&self) -> bool {
        matches!(self.kind, FaultKind::Silent { .. } | FaultKind::Garbled { .. } | FaultKind::StreamGap { .. })
    }
}
