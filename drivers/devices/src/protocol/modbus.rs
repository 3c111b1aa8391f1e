//! Modbus RTU (Modbus over Serial Line 1.02): reads holding registers, which is enough for the thermometer.

use super::crc16;
use crate::transport::{Command, Request, Scan, shown};
use jointbench_instrument::FaultKind;

const READ_HOLDING: u8 = 0x03;
const EXCEPTION: u8 = 0x80;
/// Slave, function, exception code, checksum.
const EXCEPTION_LENGTH: usize = 5;

/// Up to 125 consecutive registers.
#[derive(Debug, Clone, Copy)]
pub struct ReadRegisters {
    /// Address of the module on the line.
    pub slave: u8,
    /// Address of the first register, from 0.
    pub first: u16,
    /// Number of registers, 1 to 125.
    pub count: u8,
}

impl ReadRegisters {
    fn reply_length(&self) -> usize {
        EXCEPTION_LENGTH + 2 * usize::from(self.count)
    }
}

impl Command for ReadRegisters {
    fn encode(&self, out: &mut Vec<u8>) {
        let [high, low] = self.first.to_be_bytes();
        let frame = [self.slave, READ_HOLDING, high, low, 0, self.count];
        out.extend_from_slice(&frame);
        out.extend_from_slice(&crc16(&frame));
    }

    fn name(&self) -> String {
        format!("holding registers {} to {} of slave {}", self.first, self.first + u16::from(self.count), self.slave)
    }
}

impl Request for ReadRegisters {
    type Reply = Vec<u16>;

    /// A frame with a wrong checksum is noise up to the next possible start of a frame. Without such a start it is a
    /// garbled reply.
    fn scan(&self, received: &[u8]) -> Scan {
        let begins = |at: &usize| {
            let function = received.get(at + 1).copied().unwrap_or(READ_HOLDING);
            received[*at] == self.slave && function & !EXCEPTION == READ_HOLDING
        };
        let next = |from: usize| (from..received.len()).find(begins);
        match next(0) {
            None if received.is_empty() => Scan::Short,
            None => Scan::Noise { skip: received.len() },
            Some(0) => {
                let length = match received.get(1) {
                    Some(function) if function & EXCEPTION != 0 => EXCEPTION_LENGTH,
                    _ => self.reply_length(),
                };
                match received.get(..length) {
                    None => Scan::Short,
                    Some(frame) if is_whole(frame) => Scan::Packet { length },
                    Some(_) => next(1).map_or(Scan::Packet { length }, |skip| Scan::Noise { skip }),
                }
            }
            Some(skip) => Scan::Noise { skip },
        }
    }

    fn decode(&self, packet: &[u8]) -> Result<Vec<u16>, FaultKind> {
        let garbled = |what: &str| FaultKind::Garbled { what: format!("{}: {what}", shown(packet)) };
        if !is_whole(packet) {
            return Err(garbled("the checksum is wrong"));
        }
        match packet[..packet.len() - 2] {
            [_, function, code] if function & EXCEPTION != 0 => {
                Err(FaultKind::Refused { what: format!("{}: {}", self.name(), exception(code)) })
            }
            [_, _, length, ref words @ ..]
                if usize::from(length) == words.len() && words.len() == 2 * usize::from(self.count) =>
            {
                Ok(words.chunks_exact(2).map(|word| u16::from_be_bytes([word[0], word[1]])).collect())
            }
            _ => Err(garbled("fewer registers than requested")),
        }
    }
}

fn is_whole(frame: &[u8]) -> bool {
    matches!(frame.split_last_chunk(), Some((content, sums)) if crc16(content) == *sums)
}

fn exception(code: u8) -> String {
    let text = match code {
        1 => "illegal function",
        2 => "illegal register address",
        3 => "illegal value",
        4 => "device failure",
        6 => "device busy",
        _ => return format!("exception {code}"),
    };
    text.to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIX: ReadRegisters = ReadRegisters { slave: 1, first: 0, count: 6 };

    #[test]
    fn published_frames() {
        for (request, bytes) in [
            (SIX, [0x01, 0x03, 0x00, 0x00, 0x00, 0x06, 0xC5, 0xC8]),
            (ReadRegisters { first: 210, count: 2, ..SIX }, [0x01, 0x03, 0x00, 0xD2, 0x00, 0x02, 0x64, 0x32]),
            (ReadRegisters { first: 200, ..SIX }, [0x01, 0x03, 0x00, 0xC8, 0x00, 0x06, 0x44, 0x36]),
        ] {
            let mut out = Vec::new();
            request.encode(&mut out);
            assert_eq!(out, bytes);
        }
        let reply = b"\x01\x03\x0C\x10\x00\x13\xF8\x40\x00\x00\x00\xFF\xFF\x0F\x0A\x41\x32";
        assert_eq!(SIX.scan(reply), Scan::Packet { length: 17 });
        assert_eq!(SIX.decode(reply), Ok(vec![0x1000, 0x13F8, 0x4000, 0, 0xFFFF, 0x0F0A]));
        let name = ReadRegisters { first: 210, count: 2, ..SIX };
        assert_eq!(name.decode(b"\x01\x03\x04\x40\x15\x00\x00\xFE\x37"), Ok(vec![0x4015, 0]));
        assert_eq!(SIX.scan(b"\x01\x83\x02\xC0\xF1"), Scan::Packet { length: 5 });
        assert!(
            matches!(SIX.decode(b"\x01\x83\x02\xC0\xF1"), Err(FaultKind::Refused { what }) if what.contains("address"))
        );
    }

    #[test]
    fn a_wrong_checksum_or_another_length_is_no_reading() {
        let mut reply = *b"\x01\x03\x0C\x10\x00\x13\xF8\x40\x00\x00\x00\xFF\xFF\x0F\x0A\x41\x32";
        let fewer = ReadRegisters { count: 5, ..SIX };
        assert!(matches!(fewer.decode(&reply), Err(FaultKind::Garbled { .. })));
        reply[4] ^= 1;
        assert!(matches!(SIX.decode(&reply), Err(FaultKind::Garbled { .. })));
        assert_eq!(SIX.scan(b"\x00\x02\x01\x03"), Scan::Noise { skip: 2 });
        assert_eq!(SIX.scan(b"\x01\x03\x0C"), Scan::Short);
    }
}
