//! The memory of a Puma's axis processor: Corke 1994, table 2.7.
//!
//! Multi-byte numbers have the lowest byte at the lowest address, as on a 6503, and three-byte numbers have 8
//! fractional bits (assumed). Addresses without a variable in the table are memory that no routine reads.

use super::puma::{CURRENT, ENCODER_COUNTS, Puma};

/// Initial values in table 2.7.
const DIVISOR: u8 = 0x6F;
const JVEC1: u8 = 0x0D;
const JVEC2: u8 = 0x0E;
const POSITION_BUFFER: u8 = 0x20;
const COMMAND_BUFFER: u8 = 0x44;
/// Bytes of a command in its buffer: its code, and its word with the high byte first.
const COMMAND: usize = 3;

pub const BYTES: usize = 0x80;

/// Memory without a variable, and the last four commands.
pub struct Ram {
    spare: [u8; BYTES],
    commands: [u8; 12],
    next: usize,
    /// Whole commands that wait for the command in progress.
    pub pending: u8,
}

impl Ram {
    pub fn new() -> Self {
        Self { spare: [0; BYTES], commands: [0; 12], next: 0, pending: 0 }
    }

    pub fn keep(&mut self, command: u8, word: u16) {
        let [high, low] = word.to_be_bytes();
        self.commands[self.next..self.next + COMMAND].copy_from_slice(&[command, high, low]);
        self.next = (self.next + COMMAND) % self.commands.len();
    }
}

pub fn read(servo: &Puma, address: u8) -> u8 {
    // 16 bits of counts after 8 fractional bits.
    let fixed = |value: f64, first: u8| ((value * 256.0).round() as i64 >> (8 * (address - first))) as u8;
    let word = |value: u16, first: u8| value.to_le_bytes()[usize::from(address - first)];
    let axis = &servo.axis;
    match address {
        0x00 | 0x01 => word(servo.status(), 0x00),
        0x02 => servo.memory_pointer,
        0x03 => axis.gains.propgan,
        0x04 => axis.gains.velgan,
        0x05 => axis.gains.outscl,
        0x06 => servo.ninter,
        // The distance shifted by this is the increment with 8 fractional bits (assumed): 3 for 32 ticks.
        0x07 => 8 - servo.ninter.trailing_zeros() as u8,
        0x08 => DIVISOR,
        // One byte for 800 counts: the lower byte.
        0x09 => ENCODER_COUNTS as u8,
        0x0A..=0x0C => fixed(axis.increment, 0x0A),
        0x0D..=0x0F => fixed(axis.interpolated, 0x0D),
        0x10 | 0x11 => ((axis.offset * 256.0).round() as i16).to_le_bytes()[usize::from(address - 0x10)],
        0x12..=0x14 => fixed(axis.error, 0x12),
        0x15..=0x17 => fixed(axis.derivative, 0x15),
        0x18..=0x1A if servo.mode == CURRENT => fixed(f64::from(servo.current_word), 0x18),
        0x18..=0x1A => fixed(axis.force, 0x18),
        0x1B | 0x1C => word(JVEC1.into(), 0x1B),
        0x1D | 0x1E => word(JVEC2.into(), 0x1D),
        0x1F => POSITION_BUFFER + 2 * axis.next as u8,
        0x20..=0x3F => {
            let at = usize::from(address - POSITION_BUFFER);
            axis.positions[at / 2].to_le_bytes()[at % 2]
        }
        0x41 => servo.ram.pending,
        0x43 => COMMAND_BUFFER + servo.ram.next as u8,
        0x44..=0x4F => servo.ram.commands[usize::from(address - COMMAND_BUFFER)],
        0x50 => axis.count,
        0x52 | 0x53 => word(axis.gains.postol, 0x52),
        0x54 | 0x55 => word(axis.gains.inttol, 0x54),
        0x56..=0x58 => fixed(servo.counts as f64, 0x56),
        // No 6503 is simulated: its stack is empty.
        0x7E => 0,
        other => servo.ram.spare.get(usize::from(other)).copied().unwrap_or_default(),
    }
}

/// Whether the host may write to the address: gains, tolerances, and addresses without a variable.
pub fn write(servo: &mut Puma, address: u8, byte: u8) -> bool {
    let gains = &mut servo.axis.gains;
    let put = |word: &mut u16, first: u8| {
        let mut bytes = word.to_le_bytes();
        bytes[usize::from(address - first)] = byte;
        *word = u16::from_le_bytes(bytes);
    };
    match address {
        0x03 => gains.propgan = byte,
        0x04 => gains.velgan = byte,
        0x05 => gains.outscl = byte,
        0x52 | 0x53 => put(&mut gains.postol, 0x52),
        0x54 | 0x55 => put(&mut gains.inttol, 0x54),
        0x40 | 0x42 | 0x51 | 0x59..=0x7D | 0x7F => servo.ram.spare[usize::from(address)] = byte,
        _ => return false,
    }
    true
}
