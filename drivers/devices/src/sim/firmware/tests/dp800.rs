//! The supply, byte for byte.

use super::supply::Supply;
use crate::sim::firmware::dp800::Dp800;

#[test]
fn published_conversation() {
    let mut supply = Supply::new(Dp800::new());
    for (request, reply) in [
        ("*IDN?\n", "RIGOL TECHNOLOGIES,DP821A,DP8E204500123,00.01.16\n"),
        (":SYST:ERR?\r\n", "0,\"No error\"\n"),
        (":SYST:VERS?\n", "1999.0\n"),
        (":INST?\n", "CH1\n"),
        (":OUTP? CH1\n", "OFF\n"),
        (":SOUR1:VOLT 45.000\n:SOUR1:VOLT?\n", "45.000\n"),
        ("source1:current:level:immediate:amplitude 250mA\n:CURR?\n", "0.2500\n"),
        (":INSTrument:NSELect 1; :SOURce:CURRent:LEVel:IMMediate:AMPLitude 0.6\n:SOUR1:CURR?\n", "0.6000\n"),
        (":APPL CH1,45.0,0.25\n:APPL? CH1\n", "CH1:60V/1A,45.000,0.2500\n"),
        (":OUTP:OVP:QUES? CH1\n", "NO\n"),
        (":SOUR1:VOLT?;:SOUR1:CURR?\n", "45.000;0.2500\n"),
        (":OUTP CH1,ON\n:OUTP? CH1\n", "ON\n"),
        (":OUTP:CVCC? CH1\n", "CC\n"),
        (":STAT:QUES:INST:ISUM1:COND?\n", "1\n"),
    ] {
        assert_eq!(supply.exchange(request), reply, "{request}");
    }
    assert_eq!(supply.exchange("*ESR?\n"), "128\n", "power came on, no error");
}

#[test]
fn mistakes_are_queued_and_unknown_queries_stay_unanswered() {
    let mut supply = Supply::new(Dp800::new());
    assert_eq!(supply.exchange(":SOUR1:CURR 0.1\n:SOUR1:CURR 1.2\n:SOUR1:CURR?\n"), "0.1000\n", "the old value holds");
    assert_eq!(supply.exchange(":WHAT?\n"), "");
    assert_eq!(supply.exchange(":SYST:ERR?\n"), "-222,\"Data out of range\"\n");
    assert_eq!(supply.exchange(":SYST:ERR?\n"), "-113,\"Undefined header\"\n");
    assert_eq!(supply.exchange(":SYST:ERR?\n"), "0,\"No error\"\n");
    for _ in 0..25 {
        supply.exchange(":WHAT\n");
    }
    let last = (0..20).map(|_| supply.exchange(":SYST:ERR?\n")).last().unwrap();
    assert_eq!(last, "-350,\"Queue overflow\"\n");
}

#[test]
fn a_trip_latches_until_cleared_and_switched_on_again() {
    let mut supply = Supply::new(Dp800::new());
    supply.exchange(":APPL CH1,45,0.3;:OUTP:OVP:VAL CH1,10;:OUTP:OVP CH1,ON;:OUTP CH1,ON\n");
    supply.wait(0.5);
    assert_eq!(supply.exchange(":OUTP:OVP:QUES? CH1;:OUTP? CH1\n"), "YES;OFF\n");
    assert_eq!(supply.exchange(":STAT:QUES:INST:ISUM1:COND?\n"), "4\n");
    supply.exchange(":OUTP CH1,ON\n");
    assert_eq!(supply.exchange(":OUTP? CH1\n"), "OFF\n", "not before it is cleared");
    supply.exchange(":OUTP:OVP CH1,OFF;:OUTP:OVP:CLEAR CH1;:OUTP CH1,ON\n");
    supply.wait(1.0);
    assert_eq!(supply.exchange(":OUTP? CH1\n"), "ON\n");
    let amperes: f64 = supply.exchange(":MEAS:CURR? CH1\n").trim().parse().unwrap();
    assert!((amperes - 0.3).abs() < 2e-3, "{amperes}");
}
