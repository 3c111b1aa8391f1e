//! The torque sensor, byte for byte.

use super::super::Firmware;
use super::super::lorenz::{
    ADDRESS, BROADCAST, Lorenz, NACK, STX, UNKNOWN_COMMAND, WRITE_ONCE, WRONG_CHECKSUM, WRONG_PARAMETER, WRONG_SIZE,
    checks, send,
};
use crate::sim::data_sheet::{Joint, Load};
use crate::sim::plant::{Hidden, Plant};

struct Sensor(Lorenz, Plant);

impl Sensor {
    fn new() -> Self {
        Self(Lorenz::new(), Plant::new(Joint::JointA, Load::BrakeA, 1, Hidden::default()))
    }

    fn exchange(&mut self, bytes: &[u8]) -> Vec<u8> {
        let mut output = Vec::new();
        self.0.receive(&mut bytes.to_vec(), &mut self.1, &mut output);
        output
    }

    fn wait(&mut self, steps: usize) -> Vec<u8> {
        let mut output = Vec::new();
        for _ in 0..steps {
            self.0.step(&mut self.1);
            self.1.advance();
        }
        self.0.unasked(&mut output);
        output
    }
}

#[test]
fn telegrams_are_answered_or_refused() {
    let mut sensor = Sensor::new();
    let hello = [0x02, 0x40, 0xFF, 0x01, 0x01, 0x01, 0x42, 0x43];
    assert_eq!(sensor.exchange(&[0x02, 0x40, 0x01, 0xFF, 0x00, 0x40, 0x02, 0x02]), hello);
    assert_eq!(sensor.exchange(&[0x02, 0x02, 0x40, 0x01, 0xFF, 0x00, 0x40, 0x02, 0x02]), hello, "two leading STX");
    let refused = |code: u8| {
        let mut telegram = Vec::new();
        send(&mut telegram, 0xFF, (NACK, vec![code]));
        telegram
    };
    let ask = |command: u8, to: u8, parameters: &[u8]| {
        let mut body = vec![command, to, 0xFF, parameters.len() as u8];
        body.extend(parameters);
        body.extend(checks(&body));
        let stuffed = body.into_iter().flat_map(|byte| std::iter::repeat_n(byte, 1 + usize::from(byte == STX)));
        [vec![STX], stuffed.collect()].concat()
    };
    assert_eq!(sensor.exchange(&[0x02, 0x41, 0x01, 0xFF, 0x00, 0x41, 0x07]), refused(WRONG_CHECKSUM));
    assert_eq!(sensor.exchange(&ask(0x77, ADDRESS, &[])), refused(UNKNOWN_COMMAND));
    assert_eq!(sensor.exchange(&ask(0x44, ADDRESS, &[])), refused(WRONG_SIZE));
    assert_eq!(sensor.exchange(&ask(0x44, ADDRESS, &[77])), refused(WRONG_PARAMETER));
    assert_eq!(sensor.exchange(&ask(0x46, ADDRESS, &[0; 33])), refused(WRITE_ONCE));
    assert_eq!(sensor.exchange(&ask(0x40, 0x07, &[])), [0u8; 0], "another address");
    assert_eq!(sensor.exchange(&ask(0x45, BROADCAST, &[1])), [0u8; 0], "heard by all, answered by none");
    let reading = sensor.exchange(&ask(0x41, ADDRESS, &[]));
    assert_eq!(reading[9..14], [0x61, 0xA8, 0x61, 0xA8, 1], "check signal: 25000 on both channels");
    assert_eq!(sensor.exchange(&ask(0x5A, ADDRESS, &[3, 1, 0, 0, b'C'])), refused(WRONG_PARAMETER), "too fast");
}

#[test]
fn a_stream_keeps_its_grid_and_ends_at_stx() {
    let mut sensor = Sensor::new();
    let ack = [0x02, 0x06, 0xFF, 0x01, 0x00, 0x06, 0x12];
    let start = [0x02, 0x5A, 0x01, 0xFF, 0x05, 0x03, 0x05, 0x00, 0x00, 0x43, 0xAA, 0xB2];
    assert_eq!(sensor.exchange(&start)[..5], ack[..5]);
    // 8 steps per millisecond.
    let frames = sensor.wait(8 * 300 + 1);
    assert_eq!(frames.len(), 5 * 300);
    assert!(frames.chunks(5).enumerate().all(|(i, frame)| usize::from(frame[0]) == i % 256));
    assert_eq!(sensor.exchange(&[STX]), [0u8; 0]);
    assert_eq!(sensor.wait(80), [0u8; 0]);
}
