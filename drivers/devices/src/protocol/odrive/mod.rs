//! ODrive ASCII protocol, firmware 0.5.x (`Firmware/communication/ascii_protocol.cpp` of tag fw-v0.5.6).
//!
//! Lines end with a bare `\n`: the firmware takes `\r` and `\n` as one end each and answers the empty line between
//! them. Every command has a checksum, so every reply has one too. Set commands have no reply, even if a checksum error
//! discarded them, and their error replies arrive out of step. Therefore each set command is followed by a read of the
//! same property. `r` cuts its reply after nine characters, so positions are read with `f`, which does not.

mod errors;
mod line;
mod requests;

pub use errors::{ErrorWord, Part, ReadErrors};
pub use requests::{
    ClearErrors, FeedWatchdog, Feedback, ReadFeedback, ReadInfo, ReadNumber, RequestState, Set, SetTorque, SetVelocity,
    TorqueOff,
};

/// Axis states (`axis0.current_state`).
pub(crate) const IDLE: f64 = 1.0;
/// The drive follows its set-points.
pub(crate) const CLOSED_LOOP: f64 = 8.0;
