//! The second supply, line by line with the requests of pymeasure's client.

use super::supply::Supply;
use crate::sim::firmware::hmp::Hmp;

#[test]
fn both_the_channel_and_the_relay_have_to_be_on() {
    let mut supply = Supply::new(Hmp::new());
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
    supply.wait(1.0);
    let amperes: f64 = supply.exchange("MEAS:CURR?\n").trim().parse().unwrap();
    assert!((amperes - 0.3).abs() < 2e-3, "{amperes}");
    let both = supply.exchange("MEAS:VOLT?;:MEAS:CURR?\n");
    assert_eq!(both.trim().split(';').count(), 2, "{both}");
}
