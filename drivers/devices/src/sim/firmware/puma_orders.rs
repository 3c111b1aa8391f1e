//! The commands of a Puma's servo board, frame by frame, and its replies.

use super::adam::crc;
use super::puma::{AMPERES_PER_VOLT, CURRENT, MOST_COUNTS, POSITION, Power, Puma, RELEASE_S, VOLTS_PER_COUNT};
use super::puma_memory as memory;
use crate::sim::plant::{Plant, Signal};
use crate::sim::trouble::Trouble;

const SHUNT_NOISE_V: f64 = 0.02;

/// `eintscl` is then 1 (assumed).
const LONGEST_NINTER: u16 = 128;

const UNKNOWN: u16 = 1;
const NO_ARM_POWER: u16 = 2;
const OUT_OF_RANGE: u16 = 3;
const NOT_READY: u16 = 4;

/// Removes whole frames from `input`; bytes that cannot begin a frame are discarded.
pub fn receive(servo: &mut Puma, input: &mut Vec<u8>, plant: &Plant, output: &mut Vec<u8>) {
    loop {
        let start = input.iter().position(|byte| *byte == 0xA5).unwrap_or(input.len());
        input.drain(..start);
        let Some(&[_, number, command, high, low, crc_low, crc_high]) = input.first_chunk() else { return };
        if crc(&input[1..5]) != u16::from_le_bytes([crc_low, crc_high]) {
            input.drain(..1);
            continue;
        }
        input.drain(..7);
        servo.heard_s = plant.now_s();
        servo.ram.keep(command, u16::from_be_bytes([high, low]));
        servo.ram.pending = u8::try_from(input.len() / 7).unwrap_or(u8::MAX);
        let (mark, word) = match execute(servo, command, u16::from_be_bytes([high, low]), plant) {
            Ok(word) => (0, word),
            Err(reason) => (0x80, reason),
        };
        let fresh = if servo.fresh { 0x40 } else { 0 };
        let [high, low] = word.to_be_bytes();
        let content = [number, command & 0x3F | mark | fresh, high, low];
        output.push(0x5A);
        output.extend(content);
        output.extend(crc(&content).to_le_bytes());
    }
}

/// The word of the reply, or the reason of a refusal.
fn execute(servo: &mut Puma, command: u8, word: u16, plant: &Plant) -> Result<u16, u16> {
    let signed = word.cast_signed();
    let now_s = plant.now_s();
    match command {
        _ if servo.trouble == Trouble::Refusing => return Err(NOT_READY),
        0x00 => return Ok(servo.status()),
        0x01 => return Ok((servo.counts as i16).cast_unsigned()),
        0x02 => {
            let volts = servo.shunt_a / AMPERES_PER_VOLT + SHUNT_NOISE_V * plant.noise_of(Signal::MotorCurrent);
            let most = f64::from(MOST_COUNTS);
            return Ok(((volts / VOLTS_PER_COUNT).round().clamp(-most - 1.0, most) as i16).cast_unsigned());
        }
        0x03 | 0x04 if servo.power != Power::On => return Err(NO_ARM_POWER),
        0x03 => {
            if servo.mode != POSITION {
                servo.hold_here();
            }
            servo.mode = POSITION;
            // The word wraps, but the counter does not.
            let here = servo.axis.interpolated.round() as i64;
            let target = here + i64::from(signed.wrapping_sub(here as i16));
            servo.axis.go(target as f64, servo.ninter);
        }
        0x04 if signed.unsigned_abs() > servo.limit.unsigned_abs() => return Err(OUT_OF_RANGE),
        0x04 => (servo.mode, servo.current_word) = (CURRENT, signed),
        0x05 => servo.stop(),
        0x06 if servo.errors != 0 => return Err(NOT_READY),
        0x06 if servo.power == Power::Off => {
            servo.hold_here();
            servo.power = Power::ReleasingUntil(now_s + RELEASE_S);
        }
        0x06 => {}
        0x07 if !word.is_power_of_two() || word > LONGEST_NINTER => return Err(OUT_OF_RANGE),
        0x07 => servo.ninter = word as u8,
        0x08 if !(1..=MOST_COUNTS).contains(&signed) => return Err(OUT_OF_RANGE),
        0x08 => servo.limit = signed,
        0x09 => (servo.errors, servo.fresh) = (0, false),
        0x0A if usize::from(word) >= memory::BYTES => return Err(OUT_OF_RANGE),
        0x0A => {
            servo.memory_pointer = word as u8;
            return Ok(word << 8 | u16::from(memory::read(servo, word as u8)));
        }
        0x0C => {
            let [address, byte] = word.to_be_bytes();
            if !memory::write(servo, address, byte) {
                return Err(OUT_OF_RANGE);
            }
        }
        0x0B => return fact(servo, word),
        _ => return Err(UNKNOWN),
    }
    Ok(word)
}

fn fact(servo: &Puma, word: u16) -> Result<u16, u16> {
    match word {
        0 => Ok(0x0560),
        1 => Ok(2),
        2 if servo.trouble == Trouble::Exchanged => Ok(999),
        2 => Ok(1023),
        3 => Ok(12),
        _ => Err(OUT_OF_RANGE),
    }
}
