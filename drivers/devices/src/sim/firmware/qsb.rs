//! A US Digital QSB-D (QSB Command List 1.28): an LS7366R counter behind hexadecimal registers.

use super::Firmware;
use super::qsb_registers::{self as register, Registers};
use crate::sim::plant::{Plant, S1_COUNTS, S2_COUNTS, STEP_S};
use crate::sim::trouble::Trouble;

/// Unit of intervals and time stamps.
const TICK_S: f64 = 1.0 / 512.0;
const LONGEST_LINE: usize = 256;
const GREETING: &[u8] = b"QSB-D  0E!\r\n";
const POWER_LOST: u32 = 1 << 2;
const INDEX_SEEN: u32 = 1 << 4;
/// Bits of MDR0: the function of the index, and the function that sets the count to 0.
const INDEX_MODE: u32 = 3 << 4;
const INDEX_RESETS: u32 = 2 << 4;

/// The encoder that is wired to a unit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Encoder {
    S1,
    S2,
}

impl Encoder {
    /// Quarter periods since the encoder's own zero, at which its index is.
    fn quarters(self, plant: &Plant) -> i64 {
        match self {
            Encoder::S1 => plant.s1_counts(),
            Encoder::S2 => plant.s2_counts(),
        }
    }

    /// Quarter periods per turn.
    fn counts(self) -> i64 {
        match self {
            Encoder::S1 => S1_COUNTS as i64,
            Encoder::S2 => S2_COUNTS as i64,
        }
    }
}

struct Streamed {
    register: u8,
    reported: Option<u32>,
}

pub struct Qsb {
    encoder: Encoder,
    registers: Registers,
    /// Encoder count at which the counter shows 0.
    origin: i64,
    /// Turns of the encoder since its own zero: each change is a passage of its index.
    turn: i64,
    status: u32,
    stamp_from_s: f64,
    streams: Vec<Streamed>,
    due_s: f64,
    pending: Vec<u8>,
    trouble: Trouble,
}

impl Qsb {
    pub fn new(encoder: Encoder) -> Self {
        Self {
            encoder,
            registers: Registers::factory(),
            origin: 0,
            turn: 0,
            status: POWER_LOST,
            stamp_from_s: 0.0,
            streams: Vec::new(),
            due_s: 0.0,
            pending: Vec::new(),
            trouble: Trouble::None,
        }
    }

    fn seen(&self, plant: &Plant) -> i64 {
        self.counted(self.encoder.quarters(plant))
    }

    /// Quarter periods at the wires, scaled by the factor in MDR0 and the direction in MDR1.
    fn counted(&self, quarters: i64) -> i64 {
        let counted = match self.registers.get(register::MDR0) & 3 {
            0 | 1 => quarters.div_euclid(4),
            2 => quarters.div_euclid(2),
            _ => quarters,
        };
        if self.registers.get(register::MDR1) & 1 << 8 == 0 { counted } else { -counted }
    }

    /// Restarts the count at the index.
    fn pass_index(&mut self, plant: &Plant) {
        let turn = self.turn_of(plant);
        let before = std::mem::replace(&mut self.turn, turn);
        if turn != before {
            self.origin = self.counted(turn.max(before) * self.encoder.counts());
            self.status |= INDEX_SEEN;
        }
    }

    fn turn_of(&self, plant: &Plant) -> i64 {
        self.encoder.quarters(plant).div_euclid(self.encoder.counts())
    }

    fn count(&self, plant: &Plant) -> u32 {
        let free = self.seen(plant) - self.origin;
        match self.registers.get(register::MDR0) >> 2 & 3 {
            3 => free.rem_euclid(i64::from(self.registers.get(register::DTR)) + 1) as u32,
            _ => free as u32,
        }
    }

    fn value(&self, register: u8, plant: &Plant) -> Option<u32> {
        Some(match register {
            register::DIO => match self.encoder {
                // The encoder's status output is wired to the first input.
                Encoder::S2 => plant.periods_are_consistent().into(),
                Encoder::S1 => 1,
            },
            register::STATUS => self.status | u32::from((self.count(plant) as i32) < 0) | 1 << 3,
            register::STAMP => self.stamp(plant),
            register::ENCODER => self.count(plant),
            register::VERSION if self.trouble == Trouble::Exchanged => 0x0009_9019,
            register::VERSION => match self.encoder {
                Encoder::S1 => 0x0000_1013,
                Encoder::S2 => 0x0000_2013,
            },
            _ => self.registers.find(register)?,
        })
    }

    fn stamp(&self, plant: &Plant) -> u32 {
        ((plant.now_s() - self.stamp_from_s) / TICK_S) as u32
    }

    /// The kind of the reply and its value.
    fn execute(&mut self, kind: char, register: u8, data: Option<u32>, plant: &Plant) -> (char, u32) {
        let unsupported = ('x', data.unwrap_or(0));
        if self.trouble == Trouble::Refusing {
            return unsupported;
        }
        match (kind, data) {
            ('R', None) => {
                self.streams.retain(|streamed| streamed.register != register);
                self.value(register, plant).map_or(unsupported, |value| ('r', value))
            }
            ('S', None) if self.value(register, plant).is_some() => {
                if self.streams.is_empty() {
                    self.due_s = plant.now_s();
                }
                self.streams.retain(|streamed| streamed.register != register);
                self.streams.push(Streamed { register, reported: None });
                ('s', self.value(register, plant).unwrap_or(0))
            }
            ('W', Some(data)) => self.write(register, data, plant),
            _ => unsupported,
        }
    }

    fn write(&mut self, register: u8, data: u32, plant: &Plant) -> (char, u32) {
        let refused = ('e', data);
        match register {
            register::CLEAR => match data {
                0 => self.registers.set(register::MDR0, 0),
                1 => self.registers.set(register::MDR1, 0),
                2 => self.origin = self.seen(plant),
                3 => self.status = 0,
                _ => return refused,
            },
            register::LOAD => match data {
                0 => self.origin = self.seen(plant) - i64::from(self.registers.get(register::DTR) as i32),
                1 => {
                    let count = self.count(plant);
                    self.registers.set(register::OTR, count);
                }
                _ => return refused,
            },
            register::STAMP => self.stamp_from_s = plant.now_s() - f64::from(data.saturating_sub(1)) * TICK_S,
            register::COMMAND => match data & 0xF {
                0 => self.streams.clear(),
                1 => self.streams.retain(|streamed| streamed.register != register::ENCODER),
                3 => self.registers.save(),
                _ => {}
            },
            register::MDR0 | register::MDR1 if data > 0x1FF => return refused,
            register::MDR0 | register::MDR1 => {
                // The count keeps its value after a change of the counting mode.
                let shown = self.seen(plant) - self.origin;
                self.registers.set(register, data);
                self.origin = self.seen(plant) - shown;
                self.turn = self.turn_of(plant);
            }
            _ if self.registers.is_writable(register) => self.registers.set(register, data),
            _ => return ('x', data),
        }
        ('w', data)
    }

    fn reply(&self, kind: char, register: u8, value: u32, plant: &Plant) -> Vec<u8> {
        let format = self.registers.get(register::EOR);
        let space = if format & 8 != 0 { " " } else { "" };
        let mut line = format!("{kind}{space}{register:02X}{space}{value:08X}{space}");
        if format & 4 != 0 {
            line.push_str(&format!("{:08X}{space}", self.stamp(plant)));
        }
        line.push('!');
        if format & 2 != 0 {
            line.push('\r');
        }
        if format & 1 != 0 {
            line.push('\n');
        }
        line.into_bytes()
    }

    fn line(&mut self, line: &[u8], plant: &Plant, output: &mut Vec<u8>) {
        let mut text = String::new();
        for byte in line {
            match byte {
                0x08 => drop(text.pop()),
                byte => text.push(char::from(*byte)),
            }
        }
        let Some(kind) = text.chars().next() else { return };
        let register = text.get(1..3).and_then(|digits| u8::from_str_radix(digits, 16).ok());
        let data = match text.get(3..) {
            None | Some("") => Ok(None),
            Some(digits) if digits.len() <= 8 => u32::from_str_radix(digits, 16).map(Some).map_err(drop),
            Some(_) => Err(()),
        };
        let (kind, register, value) = match (register, data) {
            (Some(register), Ok(data)) => {
                let (kind, value) = self.execute(kind, register, data, plant);
                (kind, register, value)
            }
            (register, _) => ('x', register.unwrap_or(0), 0),
        };
        output.extend(self.reply(kind, register, value, plant));
    }
}

impl Firmware for Qsb {
    fn receive(&mut self, input: &mut Vec<u8>, plant: &mut Plant, output: &mut Vec<u8>) {
        while let Some(end) = input.iter().position(|byte| matches!(byte, b'\r' | b'\n')) {
            let line: Vec<u8> = input.drain(..=end).collect();
            self.line(&line[..end], plant, output);
        }
        input.truncate(LONGEST_LINE);
    }

    fn step(&mut self, plant: &mut Plant) {
        if self.registers.get(register::MDR0) & INDEX_MODE == INDEX_RESETS {
            self.pass_index(plant);
        }
        let interval = self.registers.get(register::INTERVAL);
        if self.streams.is_empty() || interval == 0xFFFF || plant.now_s() + 0.5 * STEP_S < self.due_s {
            return;
        }
        // Interval 0: as fast as the line permits, 886 reports per second.
        self.due_s += if interval == 0 { 1.0 / 886.0 } else { f64::from(interval) * TICK_S };
        let threshold = self.registers.get(register::THRESHOLD);
        for at in 0..self.streams.len() {
            let Streamed { register, reported } = self.streams[at];
            let Some(value) = self.value(register, plant) else { continue };
            let moved = reported.map(|reported| (value.wrapping_sub(reported) as i32).unsigned_abs());
            if moved.is_none_or(|moved| moved >= threshold) {
                self.streams[at].reported = Some(value);
                let line = self.reply('s', register, value, plant);
                self.pending.extend(line);
            }
        }
    }

    fn unasked(&mut self, output: &mut Vec<u8>) {
        output.append(&mut self.pending);
    }

    fn is_streaming(&self) -> bool {
        !self.streams.is_empty()
    }

    fn apply_trouble(&mut self, trouble: Trouble) {
        self.trouble = trouble;
    }

    fn power_cycle(&mut self, plant: &mut Plant) {
        self.registers.restore();
        if self.encoder == Encoder::S2 {
            plant.power_cycle_s2();
        }
        self.streams.clear();
        self.stamp_from_s = plant.now_s();
        self.status = POWER_LOST;
        self.origin = self.seen(plant);
        self.pending = GREETING.to_vec();
    }
}
