//! A Puma axis servo (Corke 1994).
//!
//! From the document:
//!
//! - The axis processor accepts position set-points (`POSMODE`) and moves to each in `ninter` clock ticks. Every new
//!   set-point restarts that count.
//! - The status word has error bits. Bits 6 and 7 belong to the processor. The bits for RAM, envelope and encoder are
//!   described, but never set.
//! - The memory is readable (`DIAGREAD`) at the addresses of table 2.7, with `velgan` at 0x04 and not at 0x5C.
//! - Set-points follow every 28 ms, which are the 32 ticks of the initial `ninter`; other intervals: `interval`.
//! - Motor current is measured as the voltage at a shunt by an A/D converter.
//!
//! Defined by this project, because the available pages do not describe it or the original is a parallel bus: the whole
//! wire format. This includes the command codes, all other commands, the places of the other status bits, the scale of
//! the converters, the codes of refusal, and the frames. A frame has seven bytes in each direction, with the word
//! big-endian:
//!
//! ```text
//! request  A5 number command high low crc crc
//! reply    5A number command high low crc crc
//! ```
//!
//! The reply repeats `number`, so that it cannot be confused with another reply. The checksum of the four bytes between
//! is the CRC-16 of Modbus, low byte first. It detects every error burst of up to 16 bits, as is typical of a cable. In
//! the command of a reply, bit 7 is set if the request is refused; the word is then the reason. Bit 6 is set while
//! positions count from a power-up that is not acknowledged (`CLEAR`).

mod frame;
mod interval;
pub mod memory;
mod orders;
mod status;

pub use frame::{Numbered, Order, Reply};
pub use interval::{VAL_INTERVAL, interval, intervals};
pub use orders::{
    ArmPower, Clear, CurrentMode, DiagRead, DiagWrite, Fact, Identify, Limit, PositionMode, ReadCurrent, ReadPosition,
    ReadStatus, SetInterval, Stop,
};
pub use status::Status;

/// One count of the converters: 12 bit over ±10 V.
pub(crate) const VOLTS_PER_COUNT: f64 = 10.0 / 2048.0;
/// The largest value of a converter.
pub const MOST_COUNTS: i16 = 2047;
