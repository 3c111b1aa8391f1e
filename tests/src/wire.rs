//! Commands to the drive, from the traffic that the daemon records.

use std::fs::{self, File};
use std::io::Read;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime, UNIX_EPOCH};

/// Removes the torque of the drive.
const DISARM: &str = "w axis0.requested_state 1*";
/// Closes the velocity loop: the drive has torque from now on.
const ARM: &str = "w axis0.requested_state 8*";
/// Requests position and velocity, once in each control tick.
const READ: &str = "f 0*";

pub fn now_s() -> f64 {
    unix_s(SystemTime::now())
}

fn unix_s(at: SystemTime) -> f64 {
    at.duration_since(UNIX_EPOCH).expect("after 1970").as_secs_f64()
}

/// A command to the drive.
#[derive(Debug, Clone, PartialEq)]
pub struct Command {
    /// Unix time.
    pub at_s: f64,
    pub text: String,
}

impl Command {
    pub fn disarms(&self) -> bool {
        self.text.starts_with(DISARM)
    }

    pub fn arms(&self) -> bool {
        self.text.starts_with(ARM)
    }

    pub fn reads(&self) -> bool {
        self.text.starts_with(READ)
    }
}

/// The growing traffic record of one worker's drive.
pub struct Wire {
    file: File,
    opened_s: Option<f64>,
    rest: String,
    pub commands: Vec<Command>,
}

impl Wire {
    /// The newest record below `folder`, which has one folder for each worker.
    pub fn newest(folder: &Path) -> Option<Self> {
        let mut workers: Vec<PathBuf> =
            fs::read_dir(folder).ok()?.filter_map(|entry| Some(entry.ok()?.path())).collect();
        workers.sort();
        let file = File::open(workers.last()?.join("joint.traffic")).ok()?;
        Some(Self { file, opened_s: None, rest: String::new(), commands: Vec::new() })
    }

    /// Reads the data since the last call.
    pub fn look(&mut self) {
        let mut new = String::new();
        self.file.read_to_string(&mut new).expect("the record is text");
        self.rest.push_str(&new);
        let Some(whole) = self.rest.rfind('\n') else { return };
        let lines = self.rest[..=whole].to_owned();
        self.rest.drain(..=whole);
        lines.lines().for_each(|line| self.take_in(line));
    }

    fn take_in(&mut self, line: &str) {
        if let Some(opened) = line.strip_prefix("# opened at ") {
            self.opened_s = opened.split(' ').next().and_then(|seconds| seconds.parse().ok());
            return;
        }
        let mut words = line.split(' ');
        let (Some(at), Some(">")) = (words.next(), words.next()) else { return };
        let at_s: f64 = at.parse().expect("seconds");
        let bytes: Vec<u8> = words.map(|byte| u8::from_str_radix(byte, 16).expect("hexadecimal")).collect();
        let text = String::from_utf8_lossy(&bytes).into_owned();
        self.commands.push(Command { at_s: at_s + self.opened_s.expect("the record says when it began"), text });
    }

    /// Time of the first command at or after `at_s` that removes the torque.
    pub fn disarmed_after(&self, at_s: f64) -> Option<f64> {
        self.commands.iter().find(|command| command.at_s >= at_s && command.disarms()).map(|command| command.at_s)
    }

    /// Time since which the drive has torque.
    pub fn armed_since(&self) -> Option<f64> {
        let last = self.commands.iter().rev().find(|command| command.arms() || command.disarms())?;
        last.arms().then_some(last.at_s)
    }

    /// Control statistics of the last armed period.
    pub fn control(&self) -> Control {
        let from = self.commands.iter().rposition(Command::arms).unwrap_or_default();
        let armed = &self.commands[from..];
        let until = armed.iter().position(Command::disarms).map_or(armed.len(), |last| last + 1);
        let (mut ticks, mut silences): (Vec<f64>, Vec<f64>) = Default::default();
        let mut read_s = None;
        for command in &armed[..until] {
            if command.reads() {
                ticks.extend(read_s.replace(command.at_s).map(|before| command.at_s - before));
            }
        }
        silences.extend(armed[..until].windows(2).map(|pair| pair[1].at_s - pair[0].at_s));
        let longest = silences.into_iter().fold(0.0, f64::max);
        Control { ticks: ticks.len(), longest_silence: Duration::from_secs_f64(longest) }
    }
}

/// Control of a run while the drive had torque.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Control {
    pub ticks: usize,
    /// Longest time between two commands to the drive.
    pub longest_silence: Duration,
}
