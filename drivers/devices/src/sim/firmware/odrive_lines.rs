//! The lines of the ASCII protocol (`communication/ascii_protocol.cpp`, tag fw-v0.5.6).

use super::odrive::{Odrive, TRAP_TRAJ};
use super::odrive_properties::{Refused, read, write};
use super::scan::{float, print_float, unsigned};
use crate::sim::plant::Plant;
use crate::sim::trouble::Trouble;

/// Receive buffer: a longer line is discarded up to its end.
const LONGEST_LINE: usize = 256;
/// Reply buffer: a longer reply is cut and ends with the terminating zero instead of its line feed.
const LONGEST_REPLY: usize = 64;
/// Characters that `r` keeps: a buffer of ten with its terminating zero.
const LONGEST_VALUE: usize = 9;

const HELP: [&str; 15] = [
    "Please see documentation for more details",
    "",
    "Available commands syntax reference:",
    "Position: q axis pos vel-lim I-lim",
    "Position: p axis pos vel-ff I-ff",
    "Velocity: v axis vel I-ff",
    "Torque: c axis T",
    "",
    "Properties start at odrive root, such as axis0.requested_state",
    "Read: r property",
    "Write: w property value",
    "",
    "Save config: ss",
    "Erase config: se",
    "Reboot: sr",
];

/// Removes whole lines from `input`. `\n`, `\r` and `!` each end a line, so `\r\n` ends two.
pub fn receive(drive: &mut Odrive, input: &mut Vec<u8>, plant: &Plant, output: &mut Vec<u8>) {
    while let Some(end) = input.iter().position(|byte| matches!(byte, b'\n' | b'\r' | b'!')) {
        let line: Vec<u8> = input.drain(..=end).collect();
        if end < LONGEST_LINE && !drive.is_booting() {
            answer(drive, &line[..end], plant, output);
        }
    }
    // A full buffer without a line end marks the line as too long, independent of its final length.
    input.truncate(LONGEST_LINE);
}

fn sum(bytes: &[u8]) -> u8 {
    bytes.iter().fold(0, |sum, byte| sum ^ byte)
}

struct Reply<'a> {
    output: &'a mut Vec<u8>,
    with_checksum: bool,
}

impl Reply<'_> {
    fn line(&mut self, text: &str) {
        let mut line = text.as_bytes().to_vec();
        line.truncate(LONGEST_REPLY - 1);
        if self.with_checksum {
            line.extend(format!("*{}", sum(&line)).bytes());
        }
        line.extend(b"\r\n");
        if line.len() > LONGEST_REPLY - 1 {
            line.truncate(LONGEST_REPLY - 1);
            line.push(0);
        }
        self.output.extend(line);
    }
}

fn answer(drive: &mut Odrive, line: &[u8], plant: &Plant, output: &mut Vec<u8>) {
    let uncommented = line.split(|byte| *byte == b';').next().unwrap_or_default();
    // An asterisk with nothing after it is an ordinary character.
    let star = uncommented.iter().position(|byte| *byte == b'*').filter(|star| star + 1 < uncommented.len());
    let body = &uncommented[..star.unwrap_or(uncommented.len())];
    if let Some(star) = star {
        let checksum = String::from_utf8_lossy(&uncommented[star + 1..]).into_owned();
        if unsigned(&checksum).map(|(checksum, _)| checksum) != Some(sum(body).into()) {
            return;
        }
    }
    let mut reply = Reply { output, with_checksum: star.is_some() };
    let text = String::from_utf8_lossy(body).into_owned();
    let mut characters = text.chars();
    let letter = characters.next();
    let rest = characters.as_str();
    match letter {
        _ if drive.trouble == Trouble::Refusing => reply.line("unknown command"),
        Some('p' | 'q' | 'v' | 'c' | 't') => setpoint(drive, letter.unwrap_or_default(), rest, &mut reply),
        Some('f') => feedback(drive, rest, &mut reply),
        Some('u') => match unsigned(rest) {
            None => reply.line("invalid command format"),
            Some((axis @ 2.., _)) => reply.line(&format!("invalid motor {axis}")),
            Some(_) => drive.feed_watchdog(),
        },
        Some('e') => encoder(drive, rest, &mut reply),
        Some('s') => system(drive, rest, plant),
        Some('r') => property(drive, rest, plant, &mut reply),
        Some('w') => assignment(drive, rest, plant, &mut reply),
        Some('i') => {
            reply.line("Hardware version: 3.6-56V");
            reply.line("Firmware version: 0.5.6");
            reply.line(match drive.trouble {
                Trouble::Exchanged => "Serial number: 376E35743299",
                _ => "Serial number: 376E35743231",
            });
        }
        Some('h') => HELP.iter().for_each(|line| reply.line(line)),
        _ => reply.line("unknown command"),
    }
}

/// `p`, `q`, `v`, `c`, `t`: an axis and one to three numbers. The rest of the line is ignored.
fn setpoint(drive: &mut Odrive, letter: char, rest: &str, reply: &mut Reply<'_>) {
    let Some((axis, rest)) = unsigned(rest) else { return reply.line("invalid command format") };
    let Some((first, rest)) = float(rest) else { return reply.line("invalid command format") };
    if axis > 1 {
        return reply.line(&format!("invalid motor {axis}"));
    }
    if axis == 1 {
        // The second axis has no motor on this bench: the drive accepts the set-point and nothing moves.
        return;
    }
    let second = float(rest);
    let third = second.and_then(|(_, rest)| float(rest)).map(|(value, _)| value);
    let second = second.map(|(value, _)| value);
    match letter {
        'v' => {
            drive.config.control_mode = 2;
            drive.input_vel = first;
            // A missing value keeps the present torque.
            drive.input_torque = second.unwrap_or(drive.input_torque);
        }
        'c' => {
            drive.config.control_mode = 1;
            drive.input_torque = first;
        }
        't' => {
            drive.config.control_mode = 3;
            // This input mode persists afterwards.
            drive.config.input_mode = TRAP_TRAJ;
            drive.input_pos = first;
        }
        'q' => {
            drive.config.control_mode = 3;
            drive.input_pos = first;
            // Not only for this move: the configuration is overwritten.
            drive.config.vel_limit = second.unwrap_or(drive.config.vel_limit);
            drive.config.torque_lim = third.unwrap_or(drive.config.torque_lim);
        }
        _ => {
            drive.config.control_mode = 3;
            drive.input_pos = first;
            drive.input_vel = second.unwrap_or(drive.input_vel);
            drive.input_torque = third.unwrap_or(drive.input_torque);
        }
    }
    drive.feed_watchdog();
}

fn feedback(drive: &Odrive, rest: &str, reply: &mut Reply<'_>) {
    match unsigned(rest) {
        None => reply.line("invalid command format"),
        Some((axis @ 2.., _)) => reply.line(&format!("invalid motor {axis}")),
        Some((axis, _)) => {
            let encoder = &drive.encoders[axis as usize];
            reply.line(&format!("{} {}", print_float(encoder.turns()), print_float(encoder.turns_s())));
        }
    }
}

/// `esl axis counts`.
fn encoder(drive: &mut Odrive, rest: &str, reply: &mut Reply<'_>) {
    let Some(rest) = rest.strip_prefix("sl") else { return reply.line("invalid command format") };
    let Some((axis, rest)) = unsigned(rest) else { return reply.line("invalid command format") };
    let Some((count, _)) = unsigned(rest) else { return reply.line("invalid command format") };
    if axis > 1 {
        return reply.line(&format!("invalid motor {axis}"));
    }
    // The count is read with its sign and printed without.
    drive.encoders[axis as usize].set_count((count as i32).into());
    drive.feed_watchdog();
    reply.line(&format!("encoder set to {count}"));
}

fn system(drive: &mut Odrive, rest: &str, plant: &Plant) {
    match rest.bytes().next() {
        Some(b's') => drive.save(plant.now_s()),
        Some(b'e') => drive.erase(plant.now_s()),
        Some(b'r') => drive.reboot(plant.now_s()),
        Some(b'c') => drive.clear_errors(),
        _ => {}
    }
}

fn property(drive: &mut Odrive, rest: &str, plant: &Plant, reply: &mut Reply<'_>) {
    let Some(path) = rest.split_ascii_whitespace().next() else { return reply.line("invalid command format") };
    match read(drive, plant, path) {
        None => reply.line("invalid property"),
        Some(mut text) => {
            text.truncate(LONGEST_VALUE);
            reply.line(&text);
        }
    }
}

fn assignment(drive: &mut Odrive, rest: &str, plant: &Plant, reply: &mut Reply<'_>) {
    let mut words = rest.split_ascii_whitespace();
    let Some(path) = words.next() else { return reply.line("invalid command format") };
    let value = match words.next() {
        Some(value) => {
            drive.stale_value = value.to_owned();
            value.to_owned()
        }
        // The firmware does not check for a value: it writes the content of its buffer.
        None => drive.stale_value.clone(),
    };
    match write(drive, plant, path, &value) {
        Ok(()) => {}
        Err(Refused::NoSuchProperty) => reply.line("invalid property"),
        Err(Refused::NotPossible) => reply.line("not implemented"),
    }
}
