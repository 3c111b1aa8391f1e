//! Telegrams: framing, stuffing, both checksums.

use crate::transport::{Scan, shown};
use jointbench_instrument::FaultKind;

/// Start of a telegram; doubled inside of it.
pub const STX: u8 = 0x02;
/// Address of the computer.
pub const HOST: u8 = 0xFF;
/// Address of the first sensor.
pub const SENSOR: u8 = 0x01;

/// Command codes.
pub mod command {
    /// Reply: done.
    pub const ACK: u8 = 0x06;
    /// Reply: refused, with an error code.
    pub const NACK: u8 = 0x15;
    /// Checks whether the sensor answers.
    pub const HELLO: u8 = 0x40;
    /// Both channels, raw and calibrated.
    pub const READ_RAW: u8 = 0x41;
    /// State of the device as one error code.
    pub const READ_STATUS_SHORT: u8 = 0x43;
    /// One block of the configuration.
    pub const READ_CONFIG: u8 = 0x44;
    /// Selects a special mode; mode 3 is the stream of both channels.
    pub const SPECIAL_MODE: u8 = 0x5A;
}

/// A message in either direction (LorenzTelegram 1.0.0).
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Telegram {
    /// One of the codes in [`command`].
    pub command: u8,
    /// Address of the receiver.
    pub to: u8,
    /// Address of the sender.
    pub from: u8,
    /// At most 255 bytes.
    pub parameters: Vec<u8>,
}

impl Telegram {
    /// From the computer to the first sensor.
    pub fn to_sensor(command: u8, parameters: &[u8]) -> Self {
        Self { command, to: SENSOR, from: HOST, parameters: parameters.to_vec() }
    }

    /// # Panics
    /// If there are more than 255 parameters: a programming error.
    pub fn encode(&self, out: &mut Vec<u8>) {
        let count = u8::try_from(self.parameters.len()).expect("at most 255 parameters");
        let mut body = vec![self.command, self.to, self.from, count];
        body.extend_from_slice(&self.parameters);
        let (sum, weighted) = checksums(&body);
        body.extend([sum, weighted]);
        out.push(STX);
        for byte in body {
            out.push(byte);
            if byte == STX {
                out.push(STX);
            }
        }
    }

    /// Decodes a whole telegram of the length that `scan` finds.
    pub fn decode(packet: &[u8]) -> Result<Self, FaultKind> {
        let garbled = |why: &str| FaultKind::Garbled { what: format!("{}: {why}", shown(packet)) };
        let Unstuffed::Whole(body, _) = unstuff(packet) else { return Err(garbled("expected a whole telegram")) };
        let (content, sums) = body.split_at(body.len() - 2);
        let (sum, weighted) = checksums(content);
        if sums != [sum, weighted] {
            return Err(garbled(&format!("expected the checksums {sum:02X} {weighted:02X}")));
        }
        Ok(Self { command: body[0], to: body[1], from: body[2], parameters: content[4..].to_vec() })
    }
}

/// CS: sum of the bytes. WCS: sum of the partial sums, with the carry added to the lowest bit.
fn checksums(body: &[u8]) -> (u8, u8) {
    body.iter().fold((0u8, 0u8), |(sum, weighted), byte| {
        let sum = sum.wrapping_add(*byte);
        let (folded, carry) = weighted.overflowing_add(sum);
        (sum, if carry { folded.wrapping_add(1) } else { folded })
    })
}

/// Result of removing the stuffing from a telegram.
enum Unstuffed {
    /// CMD..WCS, and the length on the wire.
    Whole(Vec<u8>, usize),
    Short,
    /// A single STX inside: the telegram is incomplete and another one begins here.
    BrokenOff(usize),
}

fn unstuff(received: &[u8]) -> Unstuffed {
    // Older documents double the first STX as well. No command is 02, so two in a row can only mean that.
    let mut at = if received.get(1) == Some(&STX) { 2 } else { 1 };
    let mut body = Vec::with_capacity(48);
    while body.len() < 6 || body.len() < usize::from(body[3]) + 6 {
        match (received.get(at), received.get(at + 1)) {
            (None, _) | (Some(&STX), None) => return Unstuffed::Short,
            (Some(&STX), Some(&STX)) => at += 2,
            (Some(&STX), Some(_)) => return Unstuffed::BrokenOff(at),
            (Some(_), _) => at += 1,
        }
        body.push(received[at - 1]);
    }
    Unstuffed::Whole(body, at)
}

pub fn scan(received: &[u8]) -> Scan {
    match received.iter().position(|byte| *byte == STX) {
        None if received.is_empty() => Scan::Short,
        None => Scan::Noise { skip: received.len() },
        Some(0) => match unstuff(received) {
            Unstuffed::Whole(_, length) => Scan::Packet { length },
            Unstuffed::Short => Scan::Short,
            Unstuffed::BrokenOff(skip) => Scan::Noise { skip },
        },
        Some(skip) => Scan::Noise { skip },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(command: u8, parameters: &[u8], wire: &[u8]) {
        let telegram = Telegram::to_sensor(command, parameters);
        let mut out = Vec::new();
        telegram.encode(&mut out);
        assert_eq!(out, wire, "{out:02X?}");
        assert_eq!(scan(wire), Scan::Packet { length: wire.len() });
        assert_eq!(scan(&wire[..wire.len() - 1]), Scan::Short);
        assert_eq!(Telegram::decode(wire).unwrap(), telegram);
        let mut doubled = vec![STX];
        doubled.extend_from_slice(wire);
        assert_eq!(Telegram::decode(&doubled).unwrap(), telegram, "two leading STX");
    }

    #[test]
    fn published_telegrams() {
        check(0x41, &[], &[0x02, 0x41, 0x01, 0xFF, 0x00, 0x41, 0x06]);
        check(0x40, &[], &[0x02, 0x40, 0x01, 0xFF, 0x00, 0x40, 0x02, 0x02]);
        check(0x44, &[2], &[0x02, 0x44, 0x01, 0xFF, 0x01, 0x02, 0x02, 0x47, 0x5A]);
        check(0x5A, &[3, 5, 0, 0, b'C'], &[0x02, 0x5A, 0x01, 0xFF, 0x05, 0x03, 0x05, 0x00, 0x00, 0x43, 0xAA, 0xB2]);
    }

    #[test]
    fn noise_is_skipped_up_to_the_start() {
        assert_eq!(scan(&[0x00, 0xFF, 0x02, 0x41]), Scan::Noise { skip: 2 });
        assert_eq!(scan(&[0x00, 0xFF]), Scan::Noise { skip: 2 });
        assert_eq!(scan(&[]), Scan::Short);
        assert_eq!(scan(&[0x02, 0x41, 0x02, 0x41, 0x01]), Scan::Noise { skip: 2 }, "a telegram that broke off");
    }

    #[test]
    fn every_flipped_bit_is_noticed() {
        let mut wire = Vec::new();
        Telegram::to_sensor(0x41, &[1, 2, 3, 250]).encode(&mut wire);
        for bit in 8..wire.len() * 8 {
            let mut bad = wire.clone();
            bad[bit / 8] ^= 1 << (bit % 8);
            let taken = match scan(&bad) {
                Scan::Packet { length } if length == bad.len() => Telegram::decode(&bad).ok(),
                _ => None,
            };
            assert_eq!(taken, None, "bit {bit}");
        }
    }
}
