//! Table 2.7 and the position loop with its variables.

use super::puma::Bench;

const READ: u8 = 0x0A;
const WRITE: u8 = 0x0C;

impl Bench {
    fn byte(&mut self, address: u8) -> u8 {
        self.ask(READ, address.into()).1 as u8
    }

    fn number(&mut self, first: u8, bytes: u8) -> i32 {
        let read: Vec<u8> = (first..first + bytes).map(|address| self.byte(address)).collect();
        let whole = read.iter().rev().fold(0, |whole: i32, byte| whole << 8 | i32::from(*byte));
        let sign = 1 << (8 * bytes - 1);
        (whole ^ sign) - sign
    }

    fn write(&mut self, address: u8, byte: u8) -> (u8, i16) {
        self.ask(WRITE, i16::from_be_bytes([address, byte]))
    }

    /// In position mode, at rest.
    fn armed() -> Self {
        let mut bench = Self::new();
        bench.ask(0x09, 0);
        bench.ask(0x06, 0);
        bench.wait(0.3);
        bench
    }

    fn step_to(&mut self, way: i16) {
        let from = self.number(0x0D, 3) >> 8;
        self.ask(0x03, from as i16 + way);
    }
}

#[test]
fn every_variable_has_the_initial_value_of_the_table() {
    let mut bench = Bench::new();
    bench.ask(0x09, 0);
    for (first, bytes, initial) in [
        (0x03, 1, 0x01),
        (0x04, 1, 0x00),
        (0x05, 1, 0x00),
        (0x06, 1, 0x20),
        (0x07, 1, 0x03),
        (0x08, 1, 0x6F),
        (0x1B, 2, 0x0D),
        (0x1D, 2, 0x0E),
        (0x41, 1, 0x00),
        (0x50, 1, 0x00),
        (0x52, 2, 0x0000),
        (0x54, 2, 0x0000),
    ] {
        assert_eq!(bench.number(first, bytes), initial, "{first:#04X}");
    }
    assert_eq!(bench.byte(0x09), 0x20, "the lower byte of 800 counts");
}

#[test]
fn the_variables_of_the_loop_follow_a_motion() {
    let mut bench = Bench::armed();
    bench.step_to(320);
    bench.wait(0.014);
    assert_eq!(bench.byte(0x50), 16, "count");
    assert_eq!(bench.number(0x0A, 3), 10 * 256, "deltae: 320 counts in 32 ticks");
    let (target, encoder, error) = (bench.number(0x0D, 3), bench.number(0x56, 3), bench.number(0x12, 3));
    assert!(error > 0 && (target - encoder - error).abs() <= 10 * 256, "{target} {encoder} {error}");
    // The feed-forward is 10 counts per tick; 20/s of the error are added.
    let expected = 10.0 * 256.0 + f64::from(error) * 20.0 * 0.875e-3;
    let force = f64::from(bench.number(0x18, 3));
    assert!((force - expected).abs() < 2.0, "u {force}, expected {expected}");
    let newest = bench.byte(0x1F).wrapping_sub(2).max(0x20);
    assert!((bench.number(newest, 2) - (encoder >> 8)).abs() <= 10, "the position buffer holds where it was");
    bench.wait(1.0);
    assert_eq!((bench.byte(0x50), bench.number(0x0A, 3)), (0, 0), "arrived");
    assert_eq!(bench.number(0x15, 3), 0, "deriv at rest");
}

#[test]
fn set_points_at_exactly_their_interval_join_without_a_stop() {
    let mut bench = Bench::armed();
    bench.ask(0x07, 16);
    for _ in 0..4 {
        bench.step_to(160);
        for tick in 1..=16 {
            bench.wait(0.875e-3);
            assert_eq!((bench.byte(0x50), bench.number(0x0A, 3)), (16 - tick, 10 * 256), "tick {tick}");
        }
    }
    bench.wait(0.875e-3);
    assert_eq!(bench.number(0x0A, 3), 0, "no further set-point");
}

#[test]
fn the_command_buffer_holds_the_last_four_commands() {
    let mut bench = Bench::armed();
    bench.step_to(5);
    let next = bench.byte(0x43);
    assert!((0x44..=0x4F).contains(&next) && (next - 0x44).is_multiple_of(3), "{next:#04X}");
    let held: Vec<u8> = (0x44..=0x4F).step_by(3).map(|address| bench.byte(address)).collect();
    assert!(held.contains(&READ), "{held:02X?}");
    // Two frames at once: while the first is carried out, the second waits.
    let frame = |word: [u8; 2]| {
        let content = [1, READ, word[0], word[1]];
        [&[0xA5][..], &content, &super::super::adam::crc(&content).to_le_bytes()].concat()
    };
    let replies = bench.exchange(&[frame([0, 0x41]), frame([0, 0x41])].concat());
    assert_eq!((replies[4], replies[11]), (1, 0), "pending");
}

#[test]
fn the_velocity_gain_is_at_0x04_and_0x5c_is_unused() {
    let noise = |address: Option<u8>| {
        let mut bench = Bench::armed();
        if let Some(address) = address {
            assert_eq!(bench.write(address, 128).0, WRITE);
            assert_eq!(bench.byte(address), 128);
        }
        bench.step_to(640);
        (0..32)
            .map(|_| {
                bench.wait(0.875e-3);
                bench.number(0x18, 3)
            })
            .collect::<Vec<i32>>()
    };
    let plain = noise(None);
    assert_eq!(noise(Some(0x5C)), plain, "where the manual has it, nothing reads it");
    assert_ne!(noise(Some(0x04)), plain);
}

#[test]
fn gains_act_on_the_loop() {
    let left = |writes: &[(u8, u8)]| {
        let mut bench = Bench::armed();
        writes.iter().for_each(|(address, byte)| assert_eq!(bench.write(*address, *byte).0, WRITE));
        bench.step_to(16);
        bench.wait(0.15);
        bench.number(0x12, 3).abs() >> 8
    };
    let [soft, plain, stiff] = [left(&[(0x05, 1)]), left(&[]), left(&[(0x03, 4)])];
    assert!(stiff < plain && plain < soft, "{stiff} {plain} {soft} counts");
    assert_eq!(left(&[(0x03, 4), (0x05, 2)]), plain, "four times the gain over two squared");
}

#[test]
fn integral_action_within_its_band_removes_what_friction_leaves() {
    let left = |inttol: u8| {
        let mut bench = Bench::armed();
        bench.write(0x54, inttol);
        bench.step_to(16);
        bench.wait(3.0);
        (bench.number(0x12, 3).abs() >> 8, bench.number(0x10, 2))
    };
    let [(plain, none), (within, offset)] = [left(0), left(64)];
    assert!(plain > 0 && none == 0, "{plain} counts of error, dcoffset {none}");
    assert!(within == 0 && offset != 0, "{within} counts of error, dcoffset {offset}");
}

#[test]
fn in_position_means_within_the_tolerance_band() {
    let mut bench = Bench::armed();
    let in_position = |bench: &mut Bench| bench.ask(0x00, 0).1 & 0x08 != 0;
    bench.step_to(16);
    bench.wait(1.0);
    let left = bench.number(0x12, 3).abs() >> 8;
    assert!(left > 0 && !in_position(&mut bench), "{left} counts of error, a band of none");
    bench.write(0x52, left as u8 + 1);
    assert!(in_position(&mut bench));
    bench.step_to(64);
    assert!(!in_position(&mut bench), "on its way");
    bench.ask(0x05, 0);
    assert!(!in_position(&mut bench), "no position mode");
}

#[test]
fn what_the_program_uses_itself_is_not_written() {
    let mut bench = Bench::new();
    bench.ask(0x09, 0);
    for address in [0x00, 0x06, 0x08, 0x0A, 0x20, 0x56, 0x7E] {
        assert_eq!(bench.write(address, 1), (0x80 | WRITE, 3), "{address:#04X}");
    }
    assert_eq!(bench.write(0x54, 7).0, WRITE);
    assert_eq!((bench.byte(0x54), bench.byte(0x55)), (7, 0));
}
