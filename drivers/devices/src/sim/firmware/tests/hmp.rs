//! The second supply, line by line with the requests of pymeasure's client.

use super::super::Firmware;
use super::super::hmp::Hmp;
use crate::sim::data_sheet::{Joint, Load};
use crate::sim::plant::{Hidden, Plant, STEP_S};

struct Supply(Hmp, Plant);

impl Supply {
    fn exchange(&mut self, text: &str) -> String {
        let mut output = Vec::new();
        self.0.receive(&mut text.as_bytes().to_vec(), &mut self.1, &mut output);
        String::from_utf8(output).unwrap()
    }
}

#[test]
fn both_the_channel_and_the_relay_have_to_be_on() {
    let mut supply = Supply(Hmp::new(), Plant::new(Joint::JointA, Load::BrakeA, 1, Hidden::default()));
    for (request, reply) in [
        ("*IDN?\n", "ROHDE&SCHWARZ,HMP4040,100123,HW50020001/SW2.51\n"),
        ("SYST:REM\nINST:NSEL 2\nINST:NSEL?\n", "2\n"),
        ("INST OUT1\nINST?\n", "OUTPUT1\n"),
        ("VOLT 32\nVOLT?\n", "32.000\n"),
        ("VOLT? MAX\n", "32.050\n"),
        ("CURR:STEP 0.1\nCURR 0.2\nCURR UP\nCURR?\n", "0.3000\n"),
        ("CURR DOWN\nCURR?\n", "0.2000\n"),
        ("APPL 30.0, 0.3\nAPPL?\n", "30.000, 0.3000\n"),
        ("OUTPUT:SEL 1\nOUTP:SEL?\n", "1\n"),
        ("OUTP:GEN?\n", "0\n"),
        ("STAT:QUES:INST:ISUM1:COND?\n", "0\n"),
        ("OUTP:GEN 1\nOUTP:GEN?\n", "1\n"),
        ("STAT:QUES:INST:ISUM1:COND?\n", "1\n"),
        ("SYST:ERR?\n", "0,\"No error\"\n"),
        ("VOLT 45\nSYST:ERR?\n", "-222,\"Data out of range\"\n"),
        ("VOLT?\n", "30.000\n"),
    ] {
        assert_eq!(supply.exchange(request), reply, "{request}");
    }
    for _ in 0..(1.0 / STEP_S) as usize {
        supply.0.step(&mut supply.1);
        supply.1.advance();
    }
    let amperes: f64 = supply.exchange("MEAS:CURR?\n").trim().parse().unwrap();
    assert!((amperes - 0.3).abs() < 2e-3, "{amperes}");
    let both = supply.exchange("MEAS:VOLT?;:MEAS:CURR?\n");
    assert_eq!(both.trim().split(';').count(), 2, "{both}");
}
