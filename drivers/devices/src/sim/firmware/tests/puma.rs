//! The servo board, byte for byte. Its frames are ours; memory map, interpolation and defaults are from the document.

use super::super::adam::crc;
use super::super::{Firmware, Puma};
use crate::sim::data_sheet::{Joint, Load};
use crate::sim::plant::{Hidden, Plant};

pub(super) struct Bench {
    servo: Puma,
    plant: Plant,
}

impl Bench {
    pub(super) fn new() -> Self {
        let hidden = Hidden::draw(Joint::Puma, 1, &[]).unwrap();
        Self { servo: Puma::new(), plant: Plant::new(Joint::Puma, Load::None, 1, hidden) }
    }

    pub(super) fn exchange(&mut self, bytes: &[u8]) -> Vec<u8> {
        let mut output = Vec::new();
        self.servo.receive(&mut bytes.to_vec(), &mut self.plant, &mut output);
        output
    }

    /// Command and word of the reply.
    pub(super) fn ask(&mut self, command: u8, word: i16) -> (u8, i16) {
        let [high, low] = word.to_be_bytes();
        let [crc_low, crc_high] = crc(&[9, command, high, low]).to_le_bytes();
        let reply = self.exchange(&[0xA5, 9, command, high, low, crc_low, crc_high]);
        let [0x5A, 9, command, high, low, crc_low, crc_high] = reply[..] else { panic!("{reply:02X?}") };
        assert_eq!(crc(&[9, command, high, low]).to_le_bytes(), [crc_low, crc_high]);
        (command, i16::from_be_bytes([high, low]))
    }

    /// Lets time pass with a request now and then.
    pub(super) fn wait(&mut self, seconds: f64) {
        let until_s = self.plant.now_s() + seconds;
        while self.plant.now_s() < until_s - 1e-9 {
            if (self.plant.now_s() / 0.1).fract() < 1e-3 {
                self.ask(0x00, 0);
            }
            self.servo.step(&mut self.plant);
            self.plant.advance();
        }
    }

    fn position(&mut self) -> i16 {
        self.ask(0x01, 0).1
    }
}

#[test]
fn bytes_in_and_bytes_out() {
    let mut bench = Bench::new();
    // After power-up every reply is marked until the power-up is acknowledged.
    for (request, reply) in [
        ([0xA5, 0x07, 0x01, 0x00, 0x00, 0x50, 0x90], [0x5A, 0x07, 0x41, 0x00, 0x00, 0x51, 0x44]),
        ([0xA5, 0x08, 0x09, 0x00, 0x00, 0xD2, 0x46], [0x5A, 0x08, 0x09, 0x00, 0x00, 0xD2, 0x46]),
        ([0xA5, 0x09, 0x0B, 0x00, 0x00, 0x72, 0x7A], [0x5A, 0x09, 0x0B, 0x05, 0x60, 0x71, 0x02]),
        // No arm power.
        ([0xA5, 0x0A, 0x03, 0x00, 0x64, 0xF2, 0x17], [0x5A, 0x0A, 0x83, 0x00, 0x02, 0x73, 0xD5]),
    ] {
        assert_eq!(bench.exchange(&request), reply);
    }
    let wrong = bench.exchange(&[0xA5, 0x07, 0x01, 0x00, 0x00, 0x50, 0x91]);
    assert_eq!(wrong, [0; 0], "a wrong checksum is not answered");
}

#[test]
fn the_memory_is_that_of_table_2_7() {
    let mut bench = Bench::new();
    bench.ask(0x09, 0);
    for (address, byte) in [(0x03, 0x01), (0x04, 0x00), (0x05, 0x00), (0x06, 0x20), (0x07, 0x03), (0x08, 0x6F)] {
        assert_eq!(bench.ask(0x0A, address), (0x0A, address << 8 | byte), "{address:#04X}");
    }
    assert_eq!(bench.ask(0x0A, 0x02), (0x0A, 0x0202), "the pointer of DIAGREAD itself");
    assert_eq!(bench.ask(0x0A, 0x80), (0x8A, 3), "beyond the stack");
}

#[test]
fn set_point_intervals_are_powers_of_two_with_their_scale_factor() {
    let mut bench = Bench::new();
    bench.ask(0x09, 0);
    for (ninter, eintscl) in [(1, 8), (2, 7), (16, 4), (32, 3), (64, 2), (128, 1)] {
        assert_eq!(bench.ask(0x07, ninter), (0x07, ninter));
        assert_eq!((bench.ask(0x0A, 0x06).1, bench.ask(0x0A, 0x07).1), (0x0600 | ninter, 0x0700 | eintscl));
    }
    for ninter in [0, 3, 33, 255, 256] {
        assert_eq!(bench.ask(0x07, ninter), (0x87, 3), "{ninter}");
    }
    assert_eq!(bench.ask(0x0A, 0x06), (0x0A, 0x0680), "unchanged");
}

#[test]
fn a_set_point_is_reached_in_ninter_ticks_and_every_new_one_starts_the_count_again() {
    let mut bench = Bench::new();
    bench.ask(0x09, 0);
    assert_eq!(bench.ask(0x06, 0), (0x06, 0));
    bench.wait(0.3);
    assert_eq!(bench.ask(0x00, 0).1 & 0x07, 0b101, "arm power, position servo");
    let set_point = |bench: &mut Bench| bench.ask(0x0A, 0x0D).1 & 0xFF | (bench.ask(0x0A, 0x0E).1 & 0xFF) << 8;
    let count = |bench: &mut Bench| bench.ask(0x0A, 0x50).1 & 0xFF;
    let from = set_point(&mut bench) >> 8;
    bench.ask(0x03, from + 64);
    assert_eq!(count(&mut bench), 32);
    // Half of 28 ms: half of the distance, in counts and 256ths.
    bench.wait(0.014);
    assert_eq!((set_point(&mut bench), count(&mut bench)), ((from + 32) * 256, 16));
    bench.ask(0x03, from + 64);
    assert_eq!(count(&mut bench), 32, "started again");
    bench.wait(0.028);
    assert_eq!((set_point(&mut bench), count(&mut bench)), ((from + 64) * 256, 0));
    bench.wait(0.5);
    assert!((bench.position() - 64).abs() <= 16, "the joint follows, its friction left: {}", bench.position());
}

#[test]
fn a_current_alone_ends_at_the_limit_that_was_set() {
    let mut bench = Bench::new();
    bench.ask(0x09, 0);
    bench.ask(0x08, 300);
    bench.ask(0x06, 0);
    bench.wait(0.3);
    assert_eq!(bench.ask(0x04, 301), (0x84, 3));
    assert_eq!(bench.ask(0x04, -20), (0x04, -20));
    bench.wait(0.1);
    let shunt = bench.ask(0x02, 0).1;
    assert!((shunt + 20).abs() < 25, "{shunt} counts");
    assert_eq!(bench.ask(0x05, 0), (0x05, 0));
    assert_eq!(bench.ask(0x00, 0).1 & 0x07, 0, "off, its brake on");
}
