//! The instruments' own parsers with random input: no panic, bounded memory, and the next valid request is answered.

use super::super::{Adam, Dmm, Dp800, Encoder, Firmware, Gcs, Hmp, Kepco, Lorenz, Odrive, Puma, Qsb};
use crate::sim::data_sheet::{Joint, Load};
use crate::sim::plant::{Hidden, Plant};
use proptest::collection::vec;
use proptest::prelude::*;

/// More than any of them keeps of an incomplete request.
const KEPT: usize = 2048;

fn pieces() -> impl Strategy<Value = Vec<Vec<u8>>> {
    let meant = prop::sample::select(b"\x02\x02\x41\x01\xFF\x5A\n\r!*;:?, frvwcpqtue0123456789.-einfa".to_vec());
    vec(vec(prop_oneof![any::<u8>(), meant], 0..400), 1..12)
}

/// Sends garbage in pieces, then `end`, then `request`; returns the reply to `request`.
fn ask(firmware: &mut dyn Firmware, garbage: &[Vec<u8>], end: &[u8], request: &[u8]) -> Vec<u8> {
    let mut plant = Plant::new(Joint::JointA, Load::BrakeA, 1, Hidden::default());
    let (mut input, mut output) = (Vec::new(), Vec::new());
    for piece in garbage.iter().map(Vec::as_slice).chain([end]) {
        input.extend_from_slice(piece);
        firmware.receive(&mut input, &mut plant, &mut output);
        assert!(input.len() <= KEPT, "{} bytes kept", input.len());
        firmware.step(&mut plant);
        plant.advance();
    }
    output.clear();
    input.extend_from_slice(request);
    firmware.receive(&mut input, &mut plant, &mut output);
    output
}

proptest! {
    #[test]
    fn a_drive_is_back_after_one_line_end(garbage in pieces()) {
        let mut drive = Odrive::new(Joint::JointA);
        let reply = ask(&mut drive, &garbage, b"\n", b"r axis0.current_state\n");
        // Garbage may contain a command to reboot.
        prop_assert!(drive.is_booting() || reply == b"1\r\n" || reply == b"8\r\n", "{}", reply.escape_ascii());
    }

    #[test]
    fn a_supply_is_back_after_one_line_end(garbage in pieces()) {
        let reply = ask(&mut Dp800::new(), &garbage, b"\n", b"*IDN?\n");
        prop_assert!(reply.starts_with(b"RIGOL"), "{}", reply.escape_ascii());
        let reply = ask(&mut Hmp::new(), &garbage, b"\n", b"*IDN?\n");
        prop_assert!(reply.starts_with(b"ROHDE"), "{}", reply.escape_ascii());
        let reply = ask(&mut Kepco::new(), &garbage, b"\n", b"*IDN?\n");
        prop_assert!(reply.starts_with(b"KEPCO"), "{}", reply.escape_ascii());
    }

    #[test]
    fn the_others_are_back_after_one_line_end_or_one_frame(garbage in pieces()) {
        // Garbage may change the format of a counter's replies, but the counter still replies.
        let reply = ask(&mut Qsb::new(Encoder::S2), &garbage, b"\r", b"R06\r");
        prop_assert!(reply.starts_with(b"r"), "{}", reply.escape_ascii());
        let reply = ask(&mut Gcs::new(), &garbage, b"\n", b"CSV?\n");
        prop_assert_eq!(reply, b"2.0\n");
        let reply = ask(&mut Dmm::new(), &garbage, b"\n", b"*OPC?\n");
        prop_assert_eq!(reply, b"1\n");
        let reply = ask(&mut Adam::new(), &garbage, &[0; 8], b"\x01\x03\x00\xD2\x00\x02\x64\x32");
        prop_assert_eq!(reply, b"\x01\x03\x04\x40\x15\x00\x00\xFE\x37");
    }

    #[test]
    fn a_servo_is_back_after_one_frame(garbage in pieces()) {
        // Garbage may have begun a frame that includes the first of these bytes.
        let ask = |servo: &mut Puma| ask(servo, &garbage, &[0; 7], &[0xA5, 0x09, 0x0B, 0x00, 0x00, 0x72, 0x7A]);
        let reply = ask(&mut Puma::new());
        prop_assert!(reply.starts_with(&[0x5A, 0x09]) && reply[3..5] == [0x05, 0x60], "{:02X?}", reply);
    }

    #[test]
    fn a_sensor_is_back_after_the_start_of_a_telegram(garbage in pieces()) {
        let hello = [0x02, 0x40, 0x01, 0xFF, 0x00, 0x40, 0x02, 0x02];
        // A telegram of garbage may absorb the first request; the second one is received.
        let reply = ask(&mut Lorenz::new(), &garbage, &[&[0x02; 3][..], &[0x00; 300], &hello].concat(), &hello);
        prop_assert_eq!(reply, [0x02, 0x40, 0xFF, 0x01, 0x01, 0x01, 0x42, 0x43]);
    }
}
