//! The stage, byte for byte.

use super::super::gcs::HELP;
use super::super::{Firmware, Gcs};
use crate::sim::data_sheet::{Joint, Load};
use crate::sim::plant::{Hidden, Plant, STEP_S};

struct Stage(Gcs, Plant);

impl Stage {
    fn new() -> Self {
        Self(Gcs::new(), Plant::new(Joint::JointA, Load::BrakeA, 1, Hidden::default()))
    }

    fn exchange(&mut self, bytes: &[u8]) -> Vec<u8> {
        let mut output = Vec::new();
        self.0.receive(&mut bytes.to_vec(), &mut self.1, &mut output);
        output
    }

    fn wait(&mut self, seconds: f64) {
        for _ in 0..(seconds / STEP_S) as usize {
            self.0.step(&mut self.1);
            self.1.advance();
        }
    }

    fn check(&mut self, request: &str, reply: &str) {
        let answer = String::from_utf8(self.exchange(format!("{request}\n").as_bytes())).unwrap();
        assert_eq!(answer, reply, "{request}");
    }
}

#[test]
fn published_conversation() {
    let mut stage = Stage::new();
    stage.check("*IDN?", "(c)2015 Physik Instrumente (PI) GmbH & Co. KG, C-887, 0, 2.7.0.1\n");
    stage.check("CSV?", "2.0\n");
    stage.check("SAI?", "X \nY \nZ \nU \nV \nW\n");
    stage.check("MOV X 0.5", "");
    stage.check("ERR?", "5\n");
    stage.check("ERR?", "0\n");
    stage.check("FRF", "");
    assert_eq!(stage.exchange(&[7]), [0xB0, b'\n']);
    stage.check("MOV X 0.5\nERR?", "1005\n");
    stage.wait(8.5);
    assert_eq!(stage.exchange(&[7]), [0xB1, b'\n']);
    stage.check("FRF?", "X=1 \nY=1 \nZ=1 \nU=1 \nV=1 \nW=1\n");
    stage.check("MOV X 0.5 U 0.2", "");
    stage.check("MOV? X", "X=0.500000\n");
    stage.check("MVR Z -0.010\nMOV? Z", "Z=-0.010000\n");
    stage.check("SVO? X", "X=1\n");
    stage.check("VLS 2.0\nVLS?", "2.000000\n");
    stage.check("VMO? X 1 U 0.5", "1\n");
    stage.check("ONT? X", "X=0\n");
    stage.check("CST? X", "X=NOSTAGE\n");
    assert_eq!(stage.exchange(&[5]), b"3F\n");
    stage.wait(0.6);
    assert_eq!(stage.exchange(b"PO\x05S? "), b"0\n", "in the middle of a line");
    let help = String::from_utf8(stage.exchange(b"HLP?\n")).unwrap();
    assert!(help.ends_with(" \nend of help\n") && help.contains(" \nMOV {"), "{help}");
}

#[test]
fn every_query_that_the_help_names_is_answered() {
    let mut stage = Stage::new();
    for query in HELP.iter().filter_map(|line| line.split(' ').next()).filter(|word| word.ends_with('?')) {
        let request = if query == "VMO?" { "VMO? X 0".to_owned() } else { query.to_owned() };
        assert!(!stage.exchange(format!("{request}\n").as_bytes()).is_empty(), "{query}");
        stage.check("ERR?", "0\n");
    }
    stage.check("XYZ?\nERR?", "2\n");
}

#[test]
fn a_move_is_taken_as_a_whole_or_not_at_all() {
    let mut stage = Stage::new();
    stage.check("FRF", "");
    stage.wait(8.5);
    for (request, code) in [
        ("MOV X 1 Y 30", "7\n"),
        ("MOV X 1 Q 1", "15\n"),
        ("MOV X 1 X 2", "22\n"),
        ("MOV X", "24\n"),
        ("MOV X one", "25\n"),
        ("MVO X 1", "2\n"),
        ("VLS 1000", "8\n"),
    ] {
        stage.check(&format!("{request}\nERR?"), code);
        stage.check("MOV? X", "X=0.000000\n");
    }
    stage.check("TMX? X", "X=22.5000\n");
    stage.check("MOV X 10 Z 5", "");
    stage.wait(2.0);
    assert_eq!(stage.exchange(&[0x18]), b"");
    stage.check("ERR?", "10\n");
    let target = String::from_utf8(stage.exchange(b"MOV? X\n")).unwrap();
    assert!((3.9..4.1).contains(&target.trim()[2..].parse::<f64>().unwrap()), "{target}");
    stage.check("FRF", "");
    stage.wait(1.0);
    stage.exchange(&[0x18]);
    stage.check("FRF? X", "X=0\n");
}
