//! Instrument faults, and how the caller may react to them.

use serde::{Deserialize, Serialize};

/// A fault of one instrument on one port.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, thiserror::Error)]
#[error("{instrument} on {port}: {kind}")]
pub struct Fault {
    /// Name of the instrument in the bench description.
    pub instrument: String,
    /// Serial port, network address or other place at which it answers.
    pub port: String,
    /// What went wrong.
    pub kind: FaultKind,
}

/// What can go wrong between a driver and its instrument.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, thiserror::Error)]
#[serde(rename_all = "snake_case", tag = "fault", content = "detail")]
pub enum FaultKind {
    /// No complete reply came before the deadline.
    #[error("no reply within {deadline_ms} ms to {request}")]
    Silent {
        /// The request, in readable form.
        request: String,
        /// Time that the reply may take (ms).
        deadline_ms: u64,
    },
    /// A reply came, but it breaks the protocol or fails its checksum.
    #[error("reply not understood: {what}")]
    Garbled {
        /// What is wrong with it, and the bytes.
        what: String,
    },
    /// The port failed while it was in use.
    #[error("port lost: {what}; check cable and power")]
    Disconnected {
        /// The message of the operating system.
        what: String,
    },
    /// The port is missing, in use, or not permitted.
    #[error("port cannot be opened: {what}")]
    NotOpened {
        /// The message of the operating system.
        what: String,
    },
    /// Maker, model or serial number differ from the expected ones.
    #[error("another instrument answers: expected {expected}, found {found}")]
    WrongInstrument {
        /// Identity from the bench description or the last connection.
        expected: String,
        /// Identity that answered.
        found: String,
    },
    /// The instrument or its driver does not accept the request.
    #[error("request refused: {what}")]
    Refused {
        /// The request and the reason.
        what: String,
    },
    /// The instrument answers with an error of its own.
    #[error("instrument reports an error: {what}")]
    Reported {
        /// Its error, with code and meaning.
        what: String,
    },
    /// The value is beyond full scale, so that it is no measurement.
    #[error("reading out of range: {what}")]
    Saturated {
        /// The channel and its range.
        what: String,
    },
    /// A stream lost samples; it continues after them.
    #[error("{count} samples missing from the stream")]
    StreamGap {
        /// Number of lost samples.
        count: u64,
    },
}

impl FaultKind {
    /// This fault at an instrument and its port.
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
