//! Frames of seven bytes.

use crate::protocol::crc16;
use crate::transport::{Command, Request, Scan, shown};
use jointbench_instrument::FaultKind;

const REQUEST: u8 = 0xA5;
const REPLY: u8 = 0x5A;
const LENGTH: usize = 7;
const REFUSED: u8 = 0x80;
const FRESH: u8 = 0x40;

/// One command: its code on the wire, its parameter word, and the meaning of the word in the reply.
pub trait Order {
    /// Meaning of the word in the reply.
    type Reply;

    /// Code of the order on the wire.
    const CODE: u8;
    /// Name of the order in faults.
    const NAME: &'static str;

    /// Parameter word; 0 without a parameter.
    fn word(&self) -> u16 {
        0
    }

    /// Decodes the word of the reply.
    fn reply(&self, word: u16) -> Result<Self::Reply, FaultKind>;
}

/// An order with its number; the reply has the same number.
#[derive(Debug, Clone, Copy)]
pub struct Numbered<O> {
    /// Distinguishes consecutive orders.
    pub number: u8,
    /// The order itself.
    pub order: O,
}

/// A reply, and whether positions count from a power-up that is not yet acknowledged.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Reply<T> {
    /// The decoded word.
    pub value: T,
    /// The positions count from a power-up that is not yet acknowledged.
    pub fresh: bool,
}

impl<O: Order> Command for Numbered<O> {
    fn encode(&self, out: &mut Vec<u8>) {
        let [high, low] = self.order.word().to_be_bytes();
        let content = [self.number, O::CODE, high, low];
        out.push(REQUEST);
        out.extend_from_slice(&content);
        out.extend_from_slice(&crc16(&content));
    }

    fn name(&self) -> String {
        O::NAME.into()
    }
}

impl<O: Order> Request for Numbered<O> {
    type Reply = Reply<O::Reply>;

    /// A frame with a wrong checksum is noise up to the next possible start of a frame. Without such a start it is a
    /// garbled reply.
    fn scan(&self, received: &[u8]) -> Scan {
        let next = |from: usize| received.iter().skip(from).position(|byte| *byte == REPLY).map(|at| from + at);
        match next(0) {
            None if received.is_empty() => Scan::Short,
            None => Scan::Noise { skip: received.len() },
            Some(0) if received.len() < LENGTH => Scan::Short,
            Some(0) if is_whole(&received[..LENGTH]) => Scan::Packet { length: LENGTH },
            Some(0) => next(1).map_or(Scan::Packet { length: LENGTH }, |skip| Scan::Noise { skip }),
            Some(skip) => Scan::Noise { skip },
        }
    }

    fn decode(&self, packet: &[u8]) -> Result<Reply<O::Reply>, FaultKind> {
        let garbled = |why: &str| FaultKind::Garbled { what: format!("{}: {why}", shown(packet)) };
        let [_, number, command, high, low, _, _] = *packet else { return Err(garbled("expected seven bytes")) };
        if !is_whole(packet) {
            return Err(garbled("the checksum is wrong"));
        }
        if number != self.number || command & !(REFUSED | FRESH) != O::CODE {
            return Err(garbled("the reply to another command"));
        }
        let word = u16::from_be_bytes([high, low]);
        if command & REFUSED != 0 {
            return Err(FaultKind::Refused { what: format!("{}: {}", O::NAME, reason(word)) });
        }
        Ok(Reply { value: self.order.reply(word)?, fresh: command & FRESH != 0 })
    }
}

fn is_whole(frame: &[u8]) -> bool {
    matches!(frame[1..].split_last_chunk(), Some((content, sums)) if crc16(content) == *sums)
}

fn reason(code: u16) -> String {
    match code {
        1 => "the servo does not know this command".into(),
        2 => "arm power is off".into(),
        3 => "the value is out of range".into(),
        4 => "the servo is not ready".into(),
        _ => format!("reason {code}"),
    }
}

#[cfg(test)]
mod tests {
    use super::super::{PositionMode, ReadPosition, SetInterval};
    use super::*;

    fn encoded(command: &impl Command) -> Vec<u8> {
        let mut out = Vec::new();
        command.encode(&mut out);
        out
    }

    const READ: Numbered<ReadPosition> = Numbered { number: 7, order: ReadPosition };

    #[test]
    fn the_bytes_on_the_wire() {
        assert_eq!(encoded(&READ), [0xA5, 0x07, 0x01, 0x00, 0x00, 0x50, 0x90]);
        let go = Numbered { number: 0xFE, order: PositionMode(-2) };
        assert_eq!(encoded(&go), [0xA5, 0xFE, 0x03, 0xFF, 0xFE, 0x01, 0xBC]);
        let reply = [0x5A, 0x07, 0x01, 0xFF, 0xFE, 0x90, 0xE0];
        assert_eq!(READ.scan(&reply), Scan::Packet { length: 7 });
        assert_eq!(READ.decode(&reply), Ok(Reply { value: -2, fresh: false }));
        let fresh = [0x5A, 0x07, 0x41, 0x00, 0x00, 0x51, 0x44];
        assert_eq!(READ.decode(&fresh), Ok(Reply { value: 0, fresh: true }));
    }

    #[test]
    fn what_is_no_reply_to_this_command_is_no_reading() {
        for (bytes, why) in [
            ([0x5A, 0x07, 0x01, 0xFF, 0xFE, 0x90, 0xE1], "checksum"),
            ([0x5A, 0x06, 0x01, 0xFF, 0xFE, 0x91, 0x1C], "another command"),
            ([0x5A, 0x07, 0x02, 0xFF, 0xFE, 0x60, 0xE0], "another command"),
        ] {
            let fault = READ.decode(&bytes).unwrap_err();
            assert!(matches!(&fault, FaultKind::Garbled { what } if what.contains(why)), "{fault}");
        }
        let refused = [0x5A, 0x07, 0x81, 0x00, 0x02, 0xD0, 0xB9];
        assert!(matches!(READ.decode(&refused), Err(FaultKind::Refused { what }) if what.contains("arm power is off")));
        let set = Numbered { number: 1, order: SetInterval(32) };
        let other = [0x5A, 0x01, 0x07, 0x00, 0x10, 0xB1, 0xD5];
        assert!(matches!(set.decode(&other), Err(FaultKind::Garbled { what }) if what.contains("16")));
    }

    #[test]
    fn a_reply_is_found_behind_one_that_broke_off() {
        let bytes = [0x5A, 0x07, 0x01, 0x5A, 0x07, 0x01, 0xFF, 0xFE, 0x90, 0xE0];
        assert_eq!(READ.scan(&bytes), Scan::Noise { skip: 3 });
        assert_eq!(READ.scan(&bytes[3..]), Scan::Packet { length: 7 });
        assert_eq!(READ.scan(b"xyz"), Scan::Noise { skip: 3 });
    }
}
