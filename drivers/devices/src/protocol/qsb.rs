//! US Digital QSB quadrature counters (QSB Command List 1.28): registers, read and written as hexadecimal lines.
//!
//! A driver sets the reply format first ([`FORMAT`]): line ends, spaces and a time stamp. With the default format a
//! reader cannot detect the end of a line in every configuration.

use super::scan_line;
use crate::transport::{Command, Request, Scan, shown};
use jointbench_instrument::FaultKind;

const LINE_LIMIT: usize = 64;
/// Line feed, carriage return, time stamp, spaces: for [`Register::Format`].
pub const FORMAT: u32 = 0xF;

/// Registers of a counter, by their number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Register {
    /// What the channel counts: quadrature with 0.
    Mode = 0x00,
    /// Levels of the digital inputs.
    DigitalInputs = 0x01,
    /// Quadrature factor, counting mode, index (LS7366R MDR0).
    CounterMode = 0x03,
    /// Bit 8: direction (LS7366R MDR1).
    Direction = 0x04,
    /// Flags of the counter: power loss, passage of the index.
    Status = 0x06,
    /// Clears count or status.
    Clear = 0x09,
    /// The count.
    Encoder = 0x0E,
    /// Serial number, variant and firmware.
    Version = 0x14,
    /// Format of replies ([`FORMAT`]).
    Format = 0x15,
    /// Starts and stops streams.
    Command = 0x16,
}

/// Identity of a unit, from [`Register::Version`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Version {
    /// Serial number of the unit.
    pub serial: u32,
    /// D, M or S.
    pub variant: char,
    /// Version of its firmware.
    pub firmware: u8,
}

impl From<u32> for Version {
    fn from(value: u32) -> Self {
        let variant = ['D', 'M', 'S'].get((value >> 8 & 0xF) as usize).copied().unwrap_or('?');
        Self { serial: value >> 12, variant, firmware: value as u8 }
    }
}

/// Stops all streams and sets the reply format. Its replies still have the previous format.
#[derive(Debug, Clone, Copy)]
pub struct StopStreams;

impl Command for StopStreams {
    fn encode(&self, out: &mut Vec<u8>) {
        out.extend_from_slice(b"\rW160\rW15F\r");
    }

    fn name(&self) -> String {
        "W160".into()
    }
}

/// Reads a register.
#[derive(Debug, Clone, Copy)]
pub struct ReadRegister(pub Register);

impl Command for ReadRegister {
    fn encode(&self, out: &mut Vec<u8>) {
        out.extend_from_slice(format!("{}\r", self.name()).as_bytes());
    }

    fn name(&self) -> String {
        format!("R{:02X}", self.0 as u8)
    }
}

impl Request for ReadRegister {
    type Reply = u32;

    fn scan(&self, received: &[u8]) -> Scan {
        scan_line(received, LINE_LIMIT)
    }

    fn decode(&self, packet: &[u8]) -> Result<u32, FaultKind> {
        held(packet, 'r', self.0)
    }
}

/// The reply to a write is the value of the register after the write.
#[derive(Debug, Clone, Copy)]
pub struct WriteRegister(pub Register, pub u32);

impl Command for WriteRegister {
    fn encode(&self, out: &mut Vec<u8>) {
        out.extend_from_slice(format!("{}\r", self.name()).as_bytes());
    }

    fn name(&self) -> String {
        format!("W{:02X}{:X}", self.0 as u8, self.1)
    }
}

impl Request for WriteRegister {
    type Reply = ();

    fn scan(&self, received: &[u8]) -> Scan {
        scan_line(received, LINE_LIMIT)
    }

    fn decode(&self, packet: &[u8]) -> Result<(), FaultKind> {
        let value = held(packet, 'w', self.0)?;
        if value == self.1 {
            return Ok(());
        }
        Err(FaultKind::Reported {
            what: format!("register {:02X} reads {value:X} after {}", self.0 as u8, self.name()),
        })
    }
}

/// The value of the register. The time stamp of the reply must be there, and is not used.
fn held(packet: &[u8], kind: char, register: Register) -> Result<u32, FaultKind> {
    let garbled =
        || FaultKind::Garbled { what: format!("{}: expected `{kind} {:02X} …`", shown(packet), register as u8) };
    let text = std::str::from_utf8(packet).map_err(|_| garbled())?;
    let text: String = text.trim_end().strip_suffix('!').ok_or_else(garbled)?.chars().filter(|c| *c != ' ').collect();
    let hex = |from: usize, to: usize| text.get(from..to).and_then(|digits| u32::from_str_radix(digits, 16).ok());
    let (Some(letter), Some(of), Some(value), Some(_stamp)) = (text.chars().next(), hex(1, 3), hex(3, 11), hex(11, 19))
    else {
        return Err(garbled());
    };
    if text.len() != 19 || of != register as u32 {
        return Err(garbled());
    }
    match letter {
        'e' => Err(FaultKind::Refused { what: format!("register {of:02X} rejects {value:X}") }),
        'x' => Err(FaultKind::Refused { what: format!("register {of:02X} does not know this command") }),
        _ if letter == kind => Ok(value),
        _ => Err(garbled()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn encoded(command: impl Command) -> Vec<u8> {
        let mut out = Vec::new();
        command.encode(&mut out);
        out
    }

    #[test]
    fn published_requests() {
        assert_eq!(encoded(WriteRegister(Register::Format, FORMAT)), b"W15F\r");
        assert_eq!(encoded(ReadRegister(Register::Version)), b"R14\r");
        assert_eq!(encoded(WriteRegister(Register::Clear, 2)), b"W092\r");
        assert_eq!(encoded(ReadRegister(Register::Encoder)), b"R0E\r");
    }

    #[test]
    fn published_replies() {
        let version = ReadRegister(Register::Version).decode(b"r 14 00001201 0000ABCE !\r\n").unwrap();
        assert_eq!(Version::from(version), Version { serial: 1, variant: 'S', firmware: 1 });
        let format = WriteRegister(Register::Format, FORMAT);
        assert_eq!(format.decode(b"w 15 0000000F 0000ABCD !\r\n"), Ok(()));
        let count = ReadRegister(Register::Encoder).decode(b"r 0E 000012F3 0000ABD0 !\r\n");
        assert_eq!(count, Ok(0x12F3));
    }

    #[test]
    fn what_is_refused_or_of_another_register_is_no_value() {
        let read = ReadRegister(Register::Encoder);
        assert!(matches!(read.decode(b"x 0E 00000000 00000001 !\r\n"), Err(FaultKind::Refused { .. })));
        let write = WriteRegister(Register::CounterMode, 3);
        assert!(matches!(write.decode(b"e 03 00000003 00000001 !\r\n"), Err(FaultKind::Refused { .. })));
        assert!(matches!(write.decode(b"w 03 0000004F 00000001 !\r\n"), Err(FaultKind::Reported { .. })));
        for line in
            ["r 06 000012F3 0000ABD0 !\r\n", "s 0E FFFFFFFE 0000ABD1 !\r\n", "r 0E 000012F3 !\r\n", "QSB-D  0E!\r\n"]
        {
            assert!(matches!(read.decode(line.as_bytes()), Err(FaultKind::Garbled { .. })), "{line}");
        }
    }
}
