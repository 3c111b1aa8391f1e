//! The third supply, line by line with the requests of its manual.

use super::supply::Supply;
use crate::sim::firmware::kepco::Kepco;

#[test]
fn commands_are_accepted_after_remote_control_only() {
    let mut supply = Supply::new(Kepco::new());
    for (request, reply) in [
        ("*IDN?\n", "KEPCO,BOP 100-2,E100123,2.66\r\n"),
        ("CURR 0.3;:SYST:ERR?\n", "-200,\"Execution error\"\r\n"),
        ("SYST:REM 1\nFUNC:MODE CURR\nFUNC:MODE?\n", "1\r\n"),
        ("VOLT 30;:CURR 0.3;CURR?;VOLT?\n", "3.0000E-1;3.0000E1\r\n"),
        ("OUTP?;:STAT:OPER:COND?\n", "0;1024\r\n"),
        ("OUTP ON\nOUTP?;:STAT:OPER:COND?\n", "1;1024\r\n"),
        ("VOLT 101;:SYST:ERR?\n", "-222,\"Data out of range\"\r\n"),
        ("SYST:ERR?\n", "0,\"No error\"\r\n"),
    ] {
        assert_eq!(supply.exchange(request), reply, "{request}");
    }
    supply.wait(1.0);
    let amperes: f64 = supply.exchange("MEAS:CURR?\n").trim().parse().unwrap();
    assert!((amperes - 0.3).abs() < 2e-3, "{amperes}");
    assert_eq!(supply.exchange("OUTP OFF\nOUTP?;:CURR?\n"), "0;3.0000E-1\r\n", "the set value is kept");
}
