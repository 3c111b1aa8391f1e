//! The drive, byte for byte as recorded from the vendor's own parser.

use super::super::Firmware;
use super::super::odrive::Odrive;
use crate::sim::data_sheet::{Joint, Load};
use crate::sim::plant::{Hidden, Plant, STEP_S};

struct Drive(Odrive, Plant);

impl Drive {
    fn new() -> Self {
        Self(Odrive::new(Joint::JointA), Plant::new(Joint::JointA, Load::BrakeA, 1, Hidden::default()))
    }

    fn exchange(&mut self, text: &str) -> String {
        self.exchange_bytes(text.as_bytes())
    }

    fn exchange_bytes(&mut self, bytes: &[u8]) -> String {
        let mut output = Vec::new();
        self.0.receive(&mut bytes.to_vec(), &mut self.1, &mut output);
        String::from_utf8(output).unwrap()
    }

    fn wait(&mut self, seconds: f64) {
        for _ in 0..(seconds / STEP_S) as usize {
            self.0.step(&mut self.1);
            self.1.advance();
        }
    }
}

#[test]
fn recorded_replies() {
    let mut drive = Drive::new();
    for (request, reply) in [
        ("f 0\n", "0.000000 0.000000\r\n"),
        ("f0!f  0\r", "0.000000 0.000000\r\n0.000000 0.000000\r\n"),
        ("r\n", "invalid command format\r\n"),
        ("r axis0\n", "invalid property\r\n"),
        ("f 5\n", "invalid motor 5\r\n"),
        ("v 5 1\n", "invalid motor 5\r\n"),
        ("vel 0 1\n", "invalid command format\r\n"),
        ("\n", "unknown command\r\n"),
        ("f 0\r\n", "0.000000 0.000000\r\nunknown command\r\n"),
        (" f 0\n", "unknown command\r\n"),
        ("w vbus_voltage 1\n", "not implemented\r\n"),
        ("w axis0.controller.input_vel x\n", "not implemented\r\n"),
        ("v 0 1 junk\n", ""),
        ("r axis0.controller.input_vel ; read it\n", "1.000000\r\n"),
        ("r fw_version_minor*78\n", "5*53\r\n"),
        ("r fw_version_minor*79\n", ""),
        ("esl 0 100\n", "encoder set to 100\r\n"),
        ("s?\n", ""),
    ] {
        assert_eq!(drive.exchange(request), reply, "{request:?}");
    }
}

#[test]
fn values_are_cut_after_nine_characters() {
    let mut drive = Drive::new();
    drive.0.config.vel_limit = -123.456;
    assert_eq!(drive.exchange("r axis0.controller.config.vel_limit\n"), "-123.4560\r\n");
    // The nearest float is 123456.7890625.
    drive.0.config.vel_limit = 123_456.79;
    assert_eq!(drive.exchange("r axis0.controller.config.vel_limit\n"), "123456.78\r\n");
    drive.0.motor_error = 68_719_476_735;
    assert_eq!(drive.exchange("r axis0.motor.error\n"), "687194767\r\n");
    assert_eq!(drive.exchange("w axis0.controller.input_vel nan\nr axis0.controller.input_vel\n"), "nan\r\n");
    assert_eq!(drive.exchange("r axis0.motor.config.torque_lim\n"), "inf\r\n");
}

#[test]
fn some_commands_leave_traces() {
    let mut drive = Drive::new();
    drive.exchange("q 0 1 7 3\n");
    assert_eq!(drive.exchange("r axis0.controller.config.vel_limit\n"), "7.000000\r\n");
    drive.exchange("t 0 1\n");
    assert_eq!(drive.exchange("r axis0.controller.config.input_mode\n"), "5\r\n");
    drive.exchange("w axis0.controller.input_torque 0.5\nw axis0.controller.input_vel\n");
    assert_eq!(drive.exchange("r axis0.controller.input_vel\n"), "0.500000\r\n", "what the buffer still held");
}

#[test]
fn a_fast_joint_trips_and_a_reboot_is_silent() {
    let mut drive = Drive::new();
    drive.exchange("w axis0.controller.config.vel_limit 10\nv 0 9\nw axis0.requested_state 8\n");
    drive.wait(0.5);
    assert_eq!(drive.exchange("r axis0.current_state\n"), "8\r\n");
    drive.exchange("w axis0.controller.config.vel_limit 2\n");
    drive.wait(0.01);
    let state = drive.exchange("r axis0.current_state\nr axis0.error\nr axis0.controller.error\n");
    assert_eq!(state, "1\r\n512\r\n1\r\n", "idle, controller failed, overspeed");
    drive.exchange("w axis0.requested_state 8\n");
    assert_eq!(drive.exchange("r axis0.current_state\n"), "1\r\n", "not with errors");
    drive.exchange("sr\n");
    drive.wait(0.9);
    assert_eq!(drive.exchange("r axis0.error\n"), "");
    drive.wait(0.2);
    assert_eq!(drive.exchange("r axis0.error\n"), "0\r\n");
}

#[test]
fn garbage_is_survived() {
    let mut drive = Drive::new();
    let mut input: Vec<u8> = (0..64_000u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 13) as u8).collect();
    drive.0.receive(&mut input, &mut drive.1, &mut Vec::new());
    assert!(input.len() <= 257);
    input.push(b'\n');
    drive.0.receive(&mut input, &mut drive.1, &mut Vec::new());
    assert_eq!(drive.exchange("r fw_version_minor\n"), "5\r\n");
    assert_eq!(drive.exchange_bytes(&[vec![b'r'; 300], b"\n".to_vec()].concat()), "", "an overlong line is dropped");
}
