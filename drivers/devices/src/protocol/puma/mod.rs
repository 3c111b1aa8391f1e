//! A Puma-type axis servo, as Corke describes it (*The Unimation Puma servo system*, the project's document 000).
//!
//! From the document: the axis processor takes position set-points (`POSMODE`) and goes from each to the next in
//! `ninter` clock ticks, a count that every new set-point starts again; a status word with error bits, of which bits 6
//! and 7 are the processor's own and the bits for RAM, envelope and encoder are told of and never set; the memory can
//! be read (`DIAGREAD`) at the addresses of table 2.7, `velgan` at 0x04 and not at 0x5C; 28 ms between set-points,
//! which are the 32 ticks that `ninter` begins with; motor current is read as volts of a shunt at an A/D converter.
//!
//! Ours, since the pages at hand are silent on it or the original is a parallel bus: everything that is on the wire.
//! The numbers of the commands, all other commands, the places of the other status bits, the scale of the converters,
//! the codes of refusal, and the frames. Seven bytes each way, the word big-endian:
//!
//! ```text
//! request  A5 number command high low crc crc
//! reply    5A number command high low crc crc
//! ```
//!
//! `number` comes back as it was sent, so that no reply can be taken for another one. The checksum of the four bytes
//! between is Modbus's CRC-16, low byte first: it notices every error within 16 bits of each other, as a cable makes them. A
//! reply's command has bit 7 set where the request is refused (the word is the reason), and bit 6 while positions count
//! from a power-up that nobody has acknowledged (`CLEAR`).

mod frame;
pub mod memory;
mod orders;
mod status;

pub use frame::{Numbered, Order, Reply};
pub use orders::{
    ArmPower, Clear, CurrentMode, DiagRead, DiagWrite, Fact, Identify, Limit, PositionMode, ReadCurrent, ReadPosition,
    ReadStatus, SetInterval, Stop,
};
pub use status::Status;

/// One count of the converters: 12 bit over ±10 V.
pub const VOLTS_PER_COUNT: f64 = 10.0 / 2048.0;
/// The largest word of a converter.
pub const MOST_COUNTS: i16 = 2047;
