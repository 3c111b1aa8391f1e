//! The counter, byte for byte.

use super::super::{Encoder, Firmware, Qsb};
use crate::sim::data_sheet::{Joint, Load};
use crate::sim::plant::{Hidden, Plant, STEP_S};

struct Counter(Qsb, Plant);

impl Counter {
    fn new(encoder: Encoder) -> Self {
        Self(Qsb::new(encoder), Plant::new(Joint::JointA, Load::BrakeA, 1, Hidden::default()))
    }

    fn exchange(&mut self, text: &str) -> String {
        let mut output = Vec::new();
        self.0.receive(&mut text.as_bytes().to_vec(), &mut self.1, &mut output);
        self.0.unasked(&mut output);
        String::from_utf8(output).unwrap()
    }

    fn wait(&mut self, seconds: f64) {
        for _ in 0..(seconds / STEP_S).round() as usize {
            self.0.step(&mut self.1);
            self.1.advance();
        }
    }
}

#[test]
fn published_conversation() {
    let mut counter = Counter::new(Encoder::S1);
    // The factory format has no stamp. A line end closes each command; a pair of line ends counts as one.
    assert_eq!(counter.exchange("R15\r\n"), "r 15 0000000B !\r\n");
    assert_eq!(counter.exchange("R03\r"), "r 03 0000004F !\r\n");
    assert_eq!(counter.exchange("W15F\r"), "w 15 0000000F 00000000 !\r\n");
    counter.wait(1.0);
    for (request, reply) in [
        ("W0000\r", "w 00 00000000 00000200 !\r\n"),
        ("W0303\r", "w 03 00000003 00000200 !\r\n"),
        ("W083FFF\r", "w 08 00003FFF 00000200 !\r\n"),
        ("W04100\r", "w 04 00000100 00000200 !\r\n"),
        ("W04000\r", "w 04 00000000 00000200 !\r\n"),
        ("W092\r", "w 09 00000002 00000200 !\r\n"),
        ("r0e\r", "x 0E 00000000 00000200 !\r\n"),
        ("R0X\x08E\r", "r 0E 00000000 00000200 !\r\n"),
        ("W05FF\r", "x 05 000000FF 00000200 !\r\n"),
        ("W097\r", "e 09 00000007 00000200 !\r\n"),
        ("W0D1\r", "w 0D 00000001 00000000 !\r\n"),
    ] {
        assert_eq!(counter.exchange(request), reply, "{request}");
    }
}

#[test]
fn a_stream_runs_on_its_grid_until_the_register_is_read() {
    let mut counter = Counter::new(Encoder::S1);
    counter.exchange("W151\rW0303\rW0B0\rW0C1\r");
    assert_eq!(counter.exchange("S0E\r"), "s0E00000000!\n");
    counter.wait(0.5);
    let lines = counter.exchange("");
    assert!((255..=257).contains(&lines.lines().count()), "{} reports in half a second", lines.lines().count());
    assert!(lines.lines().all(|line| line.starts_with("s0E")));
    assert_eq!(counter.exchange("R0E\r"), "r0E00000000!\n");
    counter.wait(0.1);
    assert_eq!(counter.exchange(""), "");
}

#[test]
fn what_was_not_saved_is_lost_with_the_power() {
    let mut counter = Counter::new(Encoder::S2);
    counter.exchange("W0303\rW093\rW163\rW08FF\r");
    counter.0.power_cycle(&mut counter.1);
    assert_eq!(counter.exchange(""), "QSB-D  0E!\r\n");
    assert_eq!(counter.exchange("R03\r"), "r 03 00000003 !\r\n", "saved");
    assert_eq!(counter.exchange("R08\r"), "r 08 000001F3 !\r\n", "not saved");
    assert_eq!(counter.exchange("R06\r"), "r 06 0000000C !\r\n", "power was lost");
    assert_eq!(counter.exchange("R01\r"), "r 01 00000001 !\r\n", "the ring's periods are consistent");
}
