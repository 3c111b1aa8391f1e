//! ODrive ASCII protocol, firmware 0.5.x (`Firmware/communication/ascii_protocol.cpp` of tag fw-v0.5.6).
//!
//! Lines end with a bare `\n`: the firmware takes `\r` and `\n` as one end each and answers the empty line between them.
//! Every command carries its checksum, so that every reply carries one too. Sets are silent, also those that a checksum
//! error threw away, and their error replies come out of phase: a set therefore travels with a read of the same property.
//! `r` cuts its reply after nine characters: positions are read with `f`, which does not.

mod errors;
mod line;
mod requests;

pub use errors::{ErrorWord, Part, ReadErrors};
pub use requests::{
    ClearErrors, FeedWatchdog, Feedback, ReadFeedback, ReadInfo, ReadNumber, RequestState, Set, SetTorque, SetVelocity,
    StandDown,
};

/// Axis states (`axis0.current_state`).
pub const IDLE: f64 = 1.0;
pub const CLOSED_LOOP: f64 = 8.0;
