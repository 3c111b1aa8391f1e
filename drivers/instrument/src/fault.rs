//! Instrument faults, and how the caller may react to them.

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
    /// The port is lost, and with it the instrument.
    pub fn is_port_lost(&self) -> bool {
        matches!(self.kind, FaultKind::Disconnected { .. } | FaultKind::NotOpened { .. })
    }

    /// The instrument that answers is not the one that answered before.
    pub fn is_wrong_instrument(&self) -> bool {
        matches!(self.kind, FaultKind::WrongInstrument { .. })
    }

    /// One retry is useful after the link is drained and the instrument is identified again.
    pub fn is_retryable(&self) -> bool {
        matches!(self.kind, FaultKind::Silent { .. } | FaultKind::Garbled { .. } | FaultKind::StreamGap { .. })
    }
}
