//! The protocols of the instruments: bytes in, bytes out, no port. One type per command; a request knows its reply
//! type.

pub mod gcs;
pub mod lorenz;
pub mod modbus;
pub mod odrive;
pub mod puma;
pub mod qsb;
pub mod scpi;

use crate::transport::Scan;
use jointbench_instrument::FaultKind;
use jointbench_instrument::roles::Identity;

/// CRC-16 of Modbus: polynomial A001, reflected, from FFFF; low byte first.
fn crc16(bytes: &[u8]) -> [u8; 2] {
    let step = |sum: u16| if sum & 1 == 1 { sum >> 1 ^ 0xA001 } else { sum >> 1 };
    bytes.iter().fold(0xFFFF_u16, |sum, byte| (0..8).fold(sum ^ u16::from(*byte), |sum, _| step(sum))).to_le_bytes()
}

/// A reply line up to its line feed. A longer input than `limit` without a line feed is noise.
fn scan_line(received: &[u8], limit: usize) -> Scan {
    match received.iter().position(|byte| *byte == b'\n') {
        Some(end) => Scan::Packet { length: end + 1 },
        None if received.len() > limit => Scan::Noise { skip: received.len() },
        None => Scan::Short,
    }
}

/// The reply to `*IDN?`.
fn identity(text: &str) -> Result<Identity, FaultKind> {
    let fields: Vec<&str> = text.split(',').map(str::trim).collect();
    let [maker, model, serial, firmware] = fields[..] else {
        return Err(FaultKind::Garbled { what: format!("`{text}`: expected maker, model, serial number, firmware") });
    };
    let owned = str::to_owned;
    Ok(Identity { maker: owned(maker), model: owned(model), serial: owned(serial), firmware: owned(firmware) })
}
