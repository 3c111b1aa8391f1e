//! A rotating torque sensor with two ranges behind an LCV-USB-VS2 interface: telegrams, blocks, polling and stream.
//!
//! Based on the published client (LorenzTelegram 1.0.0) and LCTSfunctions v2; shares no code with the driver's codec.

use super::Firmware;
use crate::sim::plant::{Plant, STEP_S, Signal};
use crate::sim::trouble::Trouble;

pub(super) const STX: u8 = 0x02;
const ACK: u8 = 0x06;
pub(super) const NACK: u8 = 0x15;
pub(super) const ADDRESS: u8 = 0x01;
pub(super) const BROADCAST: u8 = 0x00;

/// Counts at nominal torque; 16 bits give a range of up to 131 %.
const NOMINAL_COUNTS: f64 = 25_000.0;
/// Channel A is the full range of the shaft, channel B its small range.
const NOMINAL_NM: [u16; 2] = [200, 20];
/// As a fraction of nominal torque (assumed).
const NOISE: [f64; 2] = [5.0e-5, 1.5e-4];
const CHANNELS: [Signal; 2] = [Signal::TorqueCoarse, Signal::TorqueFine];

/// Stream periods are multiples of 200 µs. Two channels at 230400 baud fill the line at 4608 frames per second.
const PERIOD_S: f64 = 200e-6;
const LINE_BYTES_S: f64 = 23_040.0;

pub(super) const WRONG_SIZE: u8 = 40;
pub(super) const UNKNOWN_COMMAND: u8 = 41;
pub(super) const WRONG_CHECKSUM: u8 = 42;
pub(super) const WRONG_PARAMETER: u8 = 43;
pub(super) const WRITE_ONCE: u8 = 45;
/// The inductive link to the rotor is interrupted.
pub(super) const ROTOR_NOT_FOUND: u8 = 9;

/// A bad stream loses `LOST_FRAMES` of every `LOST_OF` frames.
const LOST_FRAMES: u64 = 7;
const LOST_OF: u64 = 500;
/// Largest frequency error of the sensor's quartz (assumed; specimens differ).
const QUARTZ_TOLERANCE: f64 = 40e-6;

struct Stream {
    period_s: f64,
    /// Remaining frames. `None`: endless.
    left: Option<u16>,
    channels: &'static [usize],
    due_s: f64,
    sent: u64,
}

pub struct Lorenz {
    check_signal: bool,
    stream: Option<Stream>,
    pending: Vec<u8>,
    blocks: Vec<(u8, [u8; 32])>,
    trouble: Trouble,
}

impl Lorenz {
    pub fn new() -> Self {
        let mut stator = [0; 28];
        stator[..10].copy_from_slice(&[0x10, 0x01, 0x08, 0x56, 0x00, 0x01, 0xE2, 0x40, 0x01, 0x01]);
        let mut hardware = [0; 28];
        hardware[0] = 0x12;
        hardware[11] = 0x07;
        let mut operation = [0; 28];
        operation[0] = 0x13;
        operation[7] = ADDRESS;
        operation[10..13].copy_from_slice(&[0x10, 0x01, 0x02]);
        let mut software = [0; 28];
        software[..2].copy_from_slice(&[0x14, 0x01]);
        let mut rotor = [0; 28];
        rotor[..8].copy_from_slice(&[0x40, 0x08, 0x66, 0x10, 0x00, 0x01, 0xE2, 0x41]);
        rotor[10..12].copy_from_slice(&NOMINAL_NM[0].to_be_bytes());
        rotor[14..16].copy_from_slice(&NOMINAL_NM[1].to_be_bytes());
        // 0.05 % and 0.1 %, in units of 0.01 %.
        (rotor[12], rotor[16]) = (5, 10);
        let mut calibration = [0; 28];
        calibration[0] = 0x41;
        calibration[13..17].copy_from_slice(&[0x61, 0xA8, 0x61, 0xA8]);
        let mut user = calibration;
        user[0] = 0x42;
        let mut rotor_operation = [0; 28];
        rotor_operation[0] = 0x43;
        let blocks = [
            (0, stator),
            (1, hardware),
            (2, operation),
            (3, software),
            (128, rotor),
            (129, calibration),
            (130, user),
            (131, rotor_operation),
        ];
        let blocks = blocks.into_iter().map(|(number, data)| (number, sealed(data))).collect();
        Self { check_signal: false, stream: None, pending: Vec::new(), blocks, trouble: Trouble::None }
    }

    fn restart(&mut self) {
        *self = Self { blocks: std::mem::take(&mut self.blocks), trouble: self.trouble, ..Self::new() };
    }

    fn counts(&self, plant: &Plant, channel: usize) -> i16 {
        if self.check_signal {
            return NOMINAL_COUNTS as i16;
        }
        let of_nominal = plant.sensor_torque_nm() / f64::from(NOMINAL_NM[channel]);
        let noisy = of_nominal + NOISE[channel] * plant.noise_of(CHANNELS[channel]);
        // `as` saturates, like the converter.
        (noisy * NOMINAL_COUNTS).round() as i16
    }

    /// Uncalibrated converter counts: different gain, with an offset.
    fn raw(&self, plant: &Plant, channel: usize) -> i16 {
        (f64::from(self.counts(plant, channel)) * 0.92 + 117.0) as i16
    }

    fn execute(&mut self, command: u8, parameters: &[u8], plant: &Plant) -> (u8, Vec<u8>) {
        let refuse = |code| (NACK, vec![code]);
        if self.trouble == Trouble::Refusing {
            return refuse(ROTOR_NOT_FOUND);
        }
        let expected = match command {
            0x40..=0x43 | 0x49 | 0x4B => 0,
            0x44 | 0x45 => 1,
            0x46 => 33,
            0x5A => 5,
            _ => return refuse(UNKNOWN_COMMAND),
        };
        if parameters.len() != expected {
            return refuse(WRONG_SIZE);
        }
        match command {
            0x40 => (0x40, vec![0x01]),
            0x41 => {
                let words = [self.raw(plant, 0), self.raw(plant, 1), self.counts(plant, 0), self.counts(plant, 1)];
                let mut reply: Vec<u8> = words.into_iter().flat_map(i16::to_be_bytes).collect();
                reply.push(self.check_signal.into());
                (0x41, reply)
            }
            0x42 => (0x42, vec![0; 14]),
            0x43 => (0x43, vec![0]),
            0x44 => match self.blocks.iter().find(|(number, _)| *number == parameters[0]) {
                Some((0, block)) if self.trouble == Trouble::Exchanged => {
                    let mut data: [u8; 28] = std::array::from_fn(|at| block[at]);
                    data[7] ^= 0x55;
                    (0x44, [&[0][..], &sealed(data)].concat())
                }
                Some((number, block)) => (0x44, [&[*number][..], block].concat()),
                None => refuse(WRONG_PARAMETER),
            },
            0x45 => {
                self.check_signal = parameters[0] != 0;
                (ACK, vec![])
            }
            0x46 if matches!(parameters[0], 0 | 1 | 128 | 129) => refuse(WRITE_ONCE),
            0x46 => match self.blocks.iter_mut().find(|(number, _)| *number == parameters[0]) {
                Some((_, block)) => {
                    block.copy_from_slice(&parameters[1..]);
                    (ACK, vec![])
                }
                None => refuse(WRONG_PARAMETER),
            },
            0x49 => {
                self.restart();
                (0x40, vec![0x01])
            }
            // The LCV-USB has no angle output.
            0x4B => refuse(UNKNOWN_COMMAND),
            _ => self.start_stream(parameters, plant),
        }
    }

    fn start_stream(&mut self, parameters: &[u8], plant: &Plant) -> (u8, Vec<u8>) {
        let channels: &'static [usize] = match parameters[4] {
            b'A' => &[0],
            b'B' => &[1],
            b'C' => &[0, 1],
            _ => return (NACK, vec![WRONG_PARAMETER]),
        };
        let period_s = f64::from(parameters[1]) * PERIOD_S;
        let frame_s = (1 + 2 * channels.len()) as f64 / LINE_BYTES_S;
        if parameters[0] != 3 || parameters[1] == 0 || period_s < frame_s {
            return (NACK, vec![WRONG_PARAMETER]);
        }
        let count = u16::from_be_bytes([parameters[2], parameters[3]]);
        let left = (count > 0).then_some(count);
        let period_s = period_s * (1.0 + QUARTZ_TOLERANCE * plant.noise.trait_of(Signal::SensorQuartz));
        self.stream = Some(Stream { period_s, left, channels, due_s: plant.now_s() + period_s, sent: 0 });
        (ACK, vec![])
    }
}

/// The data of a block with its two 16-bit checksums.
fn sealed(data: [u8; 28]) -> [u8; 32] {
    let mut sums = (0u16, 0u16);
    for byte in data {
        sums.0 = sums.0.wrapping_add(byte.into());
        sums.1 = sums.1.wrapping_add(sums.0);
    }
    let mut block = [0; 32];
    block[..28].copy_from_slice(&data);
    block[28..30].copy_from_slice(&sums.0.to_be_bytes());
    block[30..].copy_from_slice(&sums.1.to_be_bytes());
    block
}

pub(super) fn checks(bytes: &[u8]) -> [u8; 2] {
    let (mut sum, mut weighted) = (0u8, 0u16);
    for byte in bytes {
        sum = sum.wrapping_add(*byte);
        weighted += u16::from(sum);
        if weighted > 0xFF {
            weighted = (weighted + 1) & 0xFF;
        }
    }
    [sum, weighted as u8]
}

pub(super) fn send(output: &mut Vec<u8>, to: u8, (command, parameters): (u8, Vec<u8>)) {
    let mut body = vec![command, to, ADDRESS, parameters.len() as u8];
    body.extend(parameters);
    body.extend(checks(&body));
    output.push(STX);
    for byte in body {
        output.push(byte);
        if byte == STX {
            output.push(byte);
        }
    }
}

/// The first telegram without stuffing, and its length on the wire. `Err` contains the number of bytes to discard.
fn first_telegram(input: &[u8]) -> Result<Option<(Vec<u8>, usize)>, usize> {
    let Some(start) = input.iter().position(|byte| *byte == STX) else { return Err(input.len()) };
    if start > 0 {
        return Err(start);
    }
    // Any number of leading STX is one start.
    let mut at = input.iter().take_while(|byte| **byte == STX).count();
    let mut body = Vec::new();
    while body.len() < 6 || body.len() < usize::from(body[3]) + 6 {
        let Some(byte) = input.get(at) else { return Ok(None) };
        if *byte == STX {
            match input.get(at + 1) {
                None => return Ok(None),
                Some(&STX) => at += 1,
                Some(_) => return Err(at),
            }
        }
        body.push(*byte);
        at += 1;
    }
    Ok(Some((body, at)))
}

impl Firmware for Lorenz {
    fn receive(&mut self, input: &mut Vec<u8>, plant: &mut Plant, output: &mut Vec<u8>) {
        if self.stream.is_some() && input.contains(&STX) {
            // Any telegram ends the stream and is lost.
            self.stream = None;
            input.clear();
            return;
        }
        while !input.is_empty() {
            match first_telegram(input) {
                Err(skip) => drop(input.drain(..skip)),
                Ok(None) => break,
                Ok(Some((body, length))) => {
                    input.drain(..length);
                    let (content, sums) = body.split_at(body.len() - 2);
                    if body[1] != ADDRESS {
                        if body[1] == BROADCAST && sums == checks(content) {
                            self.execute(body[0], &content[4..], plant);
                        }
                        continue;
                    }
                    let reply = match sums == checks(content) {
                        true => self.execute(body[0], &content[4..], plant),
                        false => (NACK, vec![WRONG_CHECKSUM]),
                    };
                    send(output, body[2], reply);
                }
            }
        }
    }

    fn step(&mut self, plant: &mut Plant) {
        let now_s = plant.now_s();
        let Some(mut stream) = self.stream.take() else { return };
        while now_s + 0.5 * STEP_S >= stream.due_s && stream.left != Some(0) {
            if self.trouble != Trouble::StreamGap || stream.sent % LOST_OF >= LOST_FRAMES {
                // The index has one byte and wraps.
                self.pending.push(stream.sent as u8);
                for channel in stream.channels {
                    self.pending.extend(self.counts(plant, *channel).to_be_bytes());
                }
            }
            stream.sent += 1;
            stream.due_s += stream.period_s;
            stream.left = stream.left.map(|left| left - 1);
        }
        self.stream = (stream.left != Some(0)).then_some(stream);
    }

    fn unasked(&mut self, output: &mut Vec<u8>) {
        output.append(&mut self.pending);
    }

    fn is_streaming(&self) -> bool {
        self.stream.is_some() || !self.pending.is_empty()
    }

    fn apply_trouble(&mut self, trouble: Trouble) {
        self.trouble = trouble;
        if trouble == Trouble::Exchanged {
            // The stream was started on the original sensor, not on this one.
            self.stream = None;
            self.pending.clear();
        }
    }

    fn power_cycle(&mut self, _plant: &mut Plant) {
        self.restart();
    }
}
