//! Lorenz telegrams (LCV-USB2, USB-VS2, DR-xxxx-VS, SI-RS485), as in the published client LorenzTelegram 1.0.0.
//!
//! `STX CMD TO FROM N P1..PN CS WCS`; every 02 after the first STX is sent twice, checksums included.

mod frames;
mod nack;
mod requests;
mod telegram;

pub use frames::{Frame, Frames, Item, PERIOD_STEP_S};
pub(crate) use nack::nack_text;
pub use requests::{ConfigBlock, Hello, RawReading, ReadConfig, ReadRaw, ReadStatusShort, StartStream, StopStream};
pub use telegram::{HOST, SENSOR, STX, Telegram, command};

/// Counts of the calibrated value at nominal torque; at and beyond it the reading is an overload (LCTSfunctions v2).
pub const NOMINAL_COUNTS: i16 = 25_000;
