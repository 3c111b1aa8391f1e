//! Common parts of instruments that answer line by line.

use super::Firmware;
use crate::sim::plant::Plant;
use crate::sim::trouble::Trouble;

/// Firmware with line-based requests and replies; each reply ends with a line feed.
pub trait LineFirmware {
    /// Buffer limit for a line without an end.
    const LONGEST_LINE: usize;

    /// The reply to a line, which still has its line end. `None`: no reply.
    fn line(&mut self, line: &str, plant: &Plant) -> Option<String>;

    fn step(&mut self, _plant: &mut Plant) {}

    fn trouble(&mut self) -> &mut Trouble;

    /// The state after power-up. The present trouble continues.
    fn restart(&mut self, plant: &mut Plant);
}

/// Removes the whole lines from `input` and keeps at most `longest` bytes of an incomplete line.
pub fn answer_lines(
    input: &mut Vec<u8>,
    longest: usize,
    output: &mut Vec<u8>,
    mut answer: impl FnMut(&str) -> Option<String>,
) {
    while let Some(end) = input.iter().position(|byte| *byte == b'\n') {
        let line: Vec<u8> = input.drain(..=end).collect();
        if let Some(reply) = answer(&String::from_utf8_lossy(&line)) {
            output.extend(reply.bytes().chain([b'\n']));
        }
    }
    input.truncate(longest);
}

impl<F: LineFirmware> Firmware for F {
    fn receive(&mut self, input: &mut Vec<u8>, plant: &mut Plant, output: &mut Vec<u8>) {
        answer_lines(input, F::LONGEST_LINE, output, |line| self.line(line, plant));
    }

    fn step(&mut self, plant: &mut Plant) {
        LineFirmware::step(self, plant);
    }

    fn apply_trouble(&mut self, trouble: Trouble) {
        *self.trouble() = trouble;
    }

    fn power_cycle(&mut self, plant: &mut Plant) {
        let trouble = *self.trouble();
        self.restart(plant);
        *self.trouble() = trouble;
    }
}
