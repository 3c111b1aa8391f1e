//! The thermometer, byte for byte.

use super::super::{Adam, Firmware};
use crate::sim::data_sheet::{Joint, Load};
use crate::sim::plant::{Hidden, Plant};

fn exchange(adam: &mut Adam, pieces: &[&[u8]]) -> Vec<u8> {
    let mut plant = Plant::new(Joint::JointA, Load::BrakeA, 1, Hidden::default());
    let (mut input, mut output) = (Vec::new(), Vec::new());
    for piece in pieces {
        input.extend_from_slice(piece);
        adam.receive(&mut input, &mut plant, &mut output);
        assert!(input.len() < 256, "a frame at most");
    }
    output
}

#[test]
fn published_conversation() {
    let mut adam = Adam::new();
    let name = b"\x01\x03\x00\xD2\x00\x02\x64\x32";
    assert_eq!(exchange(&mut adam, &[name]), b"\x01\x03\x04\x40\x15\x00\x00\xFE\x37");
    assert_eq!(
        exchange(&mut adam, &[&name[..3], &name[3..]]),
        b"\x01\x03\x04\x40\x15\x00\x00\xFE\x37",
        "in two pieces"
    );
    assert_eq!(exchange(&mut adam, &[b"\x17\x01", name]), b"\x01\x03\x04\x40\x15\x00\x00\xFE\x37", "behind noise");
    let values = exchange(&mut adam, &[b"\x01\x03\x00\x00\x00\x06\xC5\xC8"]);
    assert_eq!((values.len(), &values[..3]), (17, &b"\x01\x03\x0C"[..]));
    let codes = exchange(&mut adam, &[b"\x01\x03\x00\xC8\x00\x06\x44\x36"]);
    assert_eq!(codes[3..15], [0x00, 0x23].repeat(6));
}

#[test]
fn silence_and_exceptions() {
    let mut adam = Adam::new();
    assert_eq!(exchange(&mut adam, &[b"\x01\x03\x00\x00\x00\x06\xC5\xC9"]), b"", "a wrong checksum");
    assert_eq!(exchange(&mut adam, &[b"\x02\x03\x00\x00\x00\x06\xC5\xFB"]), b"", "another slave");
    let mut beyond = b"\x01\x03\x01\x00\x00\x01".to_vec();
    beyond.extend(super::super::adam::crc(&beyond).to_le_bytes());
    assert_eq!(exchange(&mut adam, &[&beyond]), b"\x01\x83\x02\xC0\xF1");
}

#[test]
fn functions_that_it_does_not_have_are_refused_whatever_their_length() {
    let mut adam = Adam::new();
    let mut ask = |body: &[u8]| {
        let mut frame = body.to_vec();
        frame.extend(super::super::adam::crc(body).to_le_bytes());
        exchange(&mut adam, &[&frame])
    };
    assert_eq!(ask(&[1, 16, 0, 200, 0, 1, 2, 0, 0x23])[..3], [1, 0x90, 1], "write several registers");
    assert_eq!(ask(&[1, 17])[..3], [1, 0x91, 1], "report the slave's identity");
    assert_eq!(ask(&[1, 5, 0, 0, 0xFF, 0])[..3], [1, 0x85, 1], "write a coil");
    assert_eq!(ask(&[1, 3, 0, 210, 0, 2])[..3], [1, 3, 4], "and it goes on answering");
}
