//! An Advantech ADAM-4015 as a Modbus slave: six Pt100, 0 to 400 °C (ADAM-4000 manual, appendix G and table 5.2).

use super::Firmware;
use crate::sim::plant::{AMBIENT_C, Plant, Signal};
use crate::sim::trouble::Trouble;
use std::ops::Range;

const SLAVE: u8 = 1;
const CHANNELS: usize = 6;
/// Ten conversions per second, shared by six channels.
const REFRESH_S: f64 = 0.6;
/// Time constant of a Pt100 in the bore of a housing (assumed: 10 to 30 s).
const SENSOR_LAG_S: f64 = 20.0;
const NOISE_K: f64 = 0.1;
const PT100_400: u16 = 0x23;
const SPAN_C: f64 = 400.0;
const TYPE_CODES: u16 = 200;
const MODULE_NAME: [u16; 2] = [0x4015, 0x0000];
const ENABLED: u16 = 0x3F;

/// Longest Modbus frame on a serial line.
const LONGEST_FRAME: usize = 256;

const ILLEGAL_FUNCTION: u8 = 1;
const ILLEGAL_ADDRESS: u8 = 2;
const ILLEGAL_VALUE: u8 = 3;
const DEVICE_FAILURE: u8 = 4;

pub struct Adam {
    lagging_c: [f64; CHANNELS],
    values: [u16; CHANNELS],
    due_s: f64,
    trouble: Trouble,
}

impl Adam {
    pub fn new() -> Self {
        let mut adam =
            Self { lagging_c: [AMBIENT_C; CHANNELS], values: [0; CHANNELS], due_s: 0.0, trouble: Trouble::None };
        adam.values = adam.lagging_c.map(counts);
        adam
    }

    fn register(&self, register: u16) -> Option<u16> {
        let channel = |first: u16| usize::from(register - first);
        Some(match register {
            0..=5 if self.trouble == Trouble::Saturated => u16::MAX,
            0..=5 => self.values[channel(0)],
            200..=205 => PT100_400,
            210 | 211 if self.trouble == Trouble::Exchanged => [0x4017, 0][channel(210)],
            210 | 211 => MODULE_NAME[channel(210)],
            212..=215 => 0,
            220 => ENABLED,
            _ => return None,
        })
    }

    fn answer(&self, function: u8, first: u16, last: u16) -> Vec<u8> {
        let outcome = match function {
            _ if self.trouble == Trouble::Refusing => Err(DEVICE_FAILURE),
            3 if !(1..=125).contains(&last) => Err(ILLEGAL_VALUE),
            3 => {
                let words = (0..last).map(|offset| self.register(first.checked_add(offset)?));
                words.collect::<Option<Vec<u16>>>().ok_or(ILLEGAL_ADDRESS)
            }
            6 if !(TYPE_CODES..TYPE_CODES + CHANNELS as u16).contains(&first) => Err(ILLEGAL_ADDRESS),
            6 if last != PT100_400 => Err(ILLEGAL_VALUE),
            6 => return [&[function][..], &first.to_be_bytes(), &last.to_be_bytes()].concat(),
            _ => Err(ILLEGAL_FUNCTION),
        };
        match outcome {
            Ok(words) => {
                let mut reply = vec![function, 2 * words.len() as u8];
                reply.extend(words.into_iter().flat_map(u16::to_be_bytes));
                reply
            }
            Err(code) => vec![function | 0x80, code],
        }
    }
}

fn counts(celsius: f64) -> u16 {
    // `as` saturates, like the converter.
    (celsius / SPAN_C * f64::from(u16::MAX)).round() as u16
}

pub(super) fn crc(bytes: &[u8]) -> u16 {
    let mut sum = 0xFFFF;
    for byte in bytes {
        sum ^= u16::from(*byte);
        for _ in 0..8 {
            let carried = sum & 1;
            sum >>= 1;
            sum ^= carried * 0xA001;
        }
    }
    sum
}

/// The first request with a correct checksum. Its length depends on its function (Modbus application protocol 1.1b3).
fn first_frame(input: &[u8]) -> Option<Range<usize>> {
    (0..input.len()).find_map(|start| {
        let length = match input.get(start + 1)? {
            7 | 11 | 12 | 17 => 4,
            15 | 16 => 9 + usize::from(*input.get(start + 6)?),
            _ => 8,
        };
        let frame = input.get(start..start + length)?;
        let (body, sum) = frame.split_at(length - 2);
        (crc(body).to_le_bytes() == sum).then_some(start..start + length)
    })
}

impl Firmware for Adam {
    fn receive(&mut self, input: &mut Vec<u8>, _plant: &mut Plant, output: &mut Vec<u8>) {
        // The simulation has no gaps in time, so the checksum finds the requests.
        while let Some(found) = first_frame(input) {
            let frame: Vec<u8> = input.drain(..found.end).skip(found.start).collect();
            if frame[0] == SLAVE {
                let word = |at: usize| u16::from_be_bytes([frame[at], frame[at + 1]]);
                let mut reply = vec![SLAVE];
                reply.extend(match frame.len() {
                    8 => self.answer(frame[1], word(2), word(4)),
                    // None of the functions that it supports.
                    _ => vec![frame[1] | 0x80, ILLEGAL_FUNCTION],
                });
                reply.extend(crc(&reply).to_le_bytes());
                output.extend(reply);
            }
        }
        // The remaining bytes may begin a frame.
        let spent = input.len().saturating_sub(LONGEST_FRAME - 1);
        input.drain(..spent);
    }

    fn step(&mut self, plant: &mut Plant) {
        if plant.now_s() < self.due_s {
            return;
        }
        self.due_s += REFRESH_S;
        let gain = 1.0 - (-REFRESH_S / SENSOR_LAG_S).exp();
        let true_c = [plant.brake.housing_c(), plant.gear_c()];
        for (channel, lagging_c) in self.lagging_c.iter_mut().enumerate() {
            *lagging_c += gain * (true_c.get(channel).unwrap_or(&AMBIENT_C) - *lagging_c);
            let noise_k = NOISE_K * plant.noise_of(Signal::Temperature) * if channel % 2 == 0 { 1.0 } else { -1.0 };
            self.values[channel] = counts(*lagging_c + noise_k);
        }
    }

    fn apply_trouble(&mut self, trouble: Trouble) {
        self.trouble = trouble;
    }

    /// Type codes are kept without power, and so is the temperature of a sensor.
    fn power_cycle(&mut self, _plant: &mut Plant) {}
}
