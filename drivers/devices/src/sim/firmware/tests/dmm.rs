//! The multimeter, byte for byte.

use super::super::{Dmm, Firmware};
use crate::sim::data_sheet::{Joint, Load};
use crate::sim::plant::{Hidden, Plant};

#[test]
fn volts_come_as_scpi_writes_them_and_too_many_as_its_infinity() {
    let (mut dmm, mut plant) = (Dmm::new(), Plant::new(Joint::JointA, Load::BrakeA, 1, Hidden::default()));
    let mut exchange = |text: &str, shift_nm: f64| {
        plant.sensor_shift_nm = shift_nm;
        let mut output = Vec::new();
        dmm.receive(&mut text.as_bytes().to_vec(), &mut plant, &mut output);
        String::from_utf8(output).unwrap()
    };
    assert_eq!(exchange("*IDN?\n", 0.0), "HEWLETT-PACKARD,34401A,0,11-5-2\n");
    assert_eq!(exchange("CONF:VOLT:DC 10\nSYST:ERR?\n", 0.0), "0,\"No error\"\n");
    let reading = exchange("READ?\n", 9.0);
    assert!(reading.len() == 16 && reading.starts_with("+4.") && reading.ends_with("E+00\n"), "{reading}");
    assert_eq!(exchange("MEASure:VOLTage:DC? 10\n", 27.0), "+9.90000000E+37\n");
    assert_eq!(exchange("FETC?\n", 0.0), "", "nothing was taken yet");
    assert_eq!(exchange("SYST:ERR?\n", 0.0), "-200,\"Execution error\"\n");
    assert!(exchange("INIT;:FETC?\n", -9.0).starts_with("-4."));
    assert_eq!(exchange("CONF:VOLT:DC 2000\nSYST:ERR?\n", 0.0), "-222,\"Data out of range\"\n");
}
