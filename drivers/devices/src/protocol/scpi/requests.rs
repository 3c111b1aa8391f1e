//! One type for each command.

use super::dialect::Dialect;
use crate::protocol::{identity, scan_line};
use crate::transport::{Address, Command, Request, Scan, shown};
use jointbench_instrument::FaultKind;
use jointbench_instrument::roles::Identity;

const LINE_LIMIT: usize = 1024;
/// Entries that an error queue can hold; reading stops after this number.
pub const ERROR_QUEUE_DEPTH: usize = 20;

/// Line end of a request: `\n` on the network and USB, `\r\n` on RS-232.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Terminator {
    /// Line feed.
    Lf,
    /// Carriage return and line feed.
    CrLf,
}

impl Terminator {
    /// The line end for this kind of connection.
    pub(crate) fn for_address(address: &Address) -> Self {
        match address {
            Address::Serial(_) | Address::Usb(_) | Address::Inside(_) => Terminator::CrLf,
            Address::Tcp(_) => Terminator::Lf,
        }
    }

    /// Appends every line of the text.
    fn push(self, out: &mut Vec<u8>, text: &str) {
        for line in text.split('\n') {
            out.extend_from_slice(line.as_bytes());
            out.extend_from_slice(match self {
                Terminator::Lf => b"\n",
                Terminator::CrLf => b"\r\n",
            });
        }
    }
}

fn text(line: &[u8]) -> Result<&str, FaultKind> {
    let garbled = || FaultKind::Garbled { what: format!("{}: expected an ASCII line", shown(line)) };
    if line.is_ascii() { std::str::from_utf8(line).map(str::trim).map_err(|_| garbled()) } else { Err(garbled()) }
}

fn number(text: &str) -> Result<f64, FaultKind> {
    match text.parse::<f64>() {
        // 9.91E37 is SCPI's "not a number", 9.9E37 its infinity.
        Ok(value) if value.is_finite() && value.abs() < 9.9e36 => Ok(value),
        _ => Err(FaultKind::Garbled { what: format!("`{text}`: expected a number") }),
    }
}

/// Numbers in one reply.
fn numbers(text: &str) -> Result<Vec<f64>, FaultKind> {
    text.split([',', ';']).map(|field| number(field.trim())).collect()
}

/// One entry of an error queue: `None` when it is empty.
fn error_entry(text: &str) -> Result<Option<String>, FaultKind> {
    let code = text.split(',').next().unwrap_or_default().trim().trim_start_matches('+');
    match code.parse::<i32>() {
        Ok(0) => Ok(None),
        Ok(_) => Ok(Some(text.to_owned())),
        Err(_) => Err(FaultKind::Garbled { what: format!("`{text}`: expected an error queue entry") }),
    }
}

macro_rules! query {
    ($request:ty, |$this:ident| $query:expr, $reply:ty, |$text:ident| $decode:expr) => {
        query!($request, |$this| $query, $reply, |_this, $text| $decode);
    };
    ($request:ty, |$this:ident| $query:expr, $reply:ty, |$asked:ident, $text:ident| $decode:expr) => {
        impl Command for $request {
            fn encode(&self, out: &mut Vec<u8>) {
                self.0.push(out, &self.name());
            }

            fn name(&self) -> String {
                let $this = self;
                $query.into()
            }
        }

        impl Request for $request {
            type Reply = $reply;

            fn scan(&self, received: &[u8]) -> Scan {
                scan_line(received, LINE_LIMIT)
            }

            fn decode(&self, packet: &[u8]) -> Result<$reply, FaultKind> {
                let ($asked, $text) = (self, text(packet)?);
                $decode
            }
        }
    };
}

/// Maker, model, serial number and firmware (`*IDN?`).
#[derive(Debug, Clone, Copy)]
pub struct Identify(pub Terminator);

query!(Identify, |_this| "*IDN?", Identity, |text| identity(text));

/// The oldest entry of the error queue.
#[derive(Debug, Clone, Copy)]
pub struct QueryError(pub Terminator);

query!(QueryError, |_this| ":SYST:ERR?", Option<String>, |text| error_entry(text));

/// A number (`:SOUR1:CURR?`).
#[derive(Debug, Clone, Copy)]
pub struct QueryNumber(pub Terminator, pub &'static str);

query!(QueryNumber, |this| this.1, f64, |text| number(text));

/// Whether a switch is on (`:OUTP? CH1`).
#[derive(Debug, Clone, Copy)]
pub struct QueryFlag(pub Terminator, pub &'static str);

query!(QueryFlag, |this| this.1, bool, |text| match text {
    "ON" | "1" => Ok(true),
    "OFF" | "0" => Ok(false),
    _ => Err(FaultKind::Garbled { what: format!("`{text}`: expected ON or OFF") }),
});

/// Measured voltage and current at the output of the supply.
#[derive(Debug, Clone, Copy)]
pub struct ReadMeasured(pub Terminator, pub Dialect);

/// Reply to [`ReadMeasured`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measured {
    /// Voltage at the output.
    pub voltage_v: f64,
    /// Current through the output.
    pub current_a: f64,
}

query!(ReadMeasured, |this| this.1.measured(), Measured, |_this, text| {
    // Some makers add the power.
    let ([voltage_v, current_a] | [voltage_v, current_a, _]) = numbers(text)?[..] else {
        return Err(FaultKind::Garbled { what: format!("`{text}`: expected voltage and current") });
    };
    Ok(Measured { voltage_v, current_a })
});

/// Condition of channel 1: regulation of the output, and tripped protections.
#[derive(Debug, Clone, Copy)]
pub struct ReadCondition(pub Terminator, pub Dialect);

/// Reply to [`ReadCondition`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Condition {
    /// The output regulates its current.
    pub constant_current: bool,
    /// The output regulates its voltage.
    pub constant_voltage: bool,
    /// The over-voltage protection has switched the output off.
    pub over_voltage_trip: bool,
    /// The over-current protection has switched the output off.
    pub over_current_trip: bool,
}

query!(ReadCondition, |this| this.1.condition(), Condition, |this, text| {
    let bits = match (this.1, &numbers(text)?[..]) {
        (Dialect::Dp800 | Dialect::Hmp, [bits]) | (Dialect::Kepco, [1.0, bits]) => *bits as u32,
        (Dialect::Kepco, [0.0, _]) => 0,
        _ => return Err(FaultKind::Garbled { what: format!("`{text}`: expected a condition register") }),
    };
    let [constant_current, constant_voltage, over_voltage_trip, over_current_trip] =
        this.1.condition_bits().map(|bit| bits & bit != 0);
    Ok(Condition { constant_current, constant_voltage, over_voltage_trip, over_current_trip })
});

/// Takes a reading of a multimeter. `None`: overload.
#[derive(Debug, Clone, Copy)]
pub struct ReadVoltage(pub Terminator);

query!(ReadVoltage, |_this| "READ?", Option<f64>, |text| match text.parse::<f64>() {
    // 9.9E37 with either sign; 9.91E37 is SCPI's "not a number".
    Ok(value) if (value.abs() - 9.9e37).abs() < 5e34 => Ok(None),
    _ => number(text).map(Some),
});

/// A command, what separates it from the next one, and a query whether it was accepted.
#[derive(Debug, Clone)]
pub struct Set(pub Terminator, pub String, pub &'static str);

impl Command for Set {
    fn encode(&self, out: &mut Vec<u8>) {
        self.0.push(out, &format!("{}{}:SYST:ERR?", self.1, self.2));
    }

    fn name(&self) -> String {
        self.1.clone()
    }
}

impl Request for Set {
    type Reply = ();

    fn scan(&self, received: &[u8]) -> Scan {
        scan_line(received, LINE_LIMIT)
    }

    fn decode(&self, packet: &[u8]) -> Result<(), FaultKind> {
        match error_entry(text(packet)?)? {
            None => Ok(()),
            Some(entry) => Err(FaultKind::Refused { what: format!("{}: {entry}", self.1) }),
        }
    }
}

/// Current zero and output off, without waiting. No reply.
#[derive(Debug, Clone, Copy)]
pub struct SwitchOff(pub Terminator, pub Dialect);

impl Command for SwitchOff {
    fn encode(&self, out: &mut Vec<u8>) {
        let ([current, _], off) = (self.1.current(), self.1.output(false));
        self.0.push(out, &format!("{off}{}{current} 0", self.1.separator()));
    }

    fn name(&self) -> String {
        self.1.output(false).into()
    }
}

/// Empties the error queue and the status registers. No reply.
#[derive(Debug, Clone, Copy)]
pub struct ClearStatus(pub Terminator);

impl Command for ClearStatus {
    fn encode(&self, out: &mut Vec<u8>) {
        self.0.push(out, "*CLS");
    }

    fn name(&self) -> String {
        "*CLS".into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn published_replies() {
        let lf = Terminator::Lf;
        let identity = Identify(lf).decode(b"RIGOL TECHNOLOGIES,DP821A,DP8E204500123,00.01.16\n").unwrap();
        assert_eq!((identity.model.as_str(), identity.serial.as_str()), ("DP821A", "DP8E204500123"));
        assert_eq!(QueryError(lf).decode(b"0,\"No error\"\n"), Ok(None));
        assert_eq!(QueryError(lf).decode(b"+0,\"No error\"\r\n"), Ok(None));
        assert_eq!(QueryError(lf).decode(b"  0,\"No error\"\n"), Ok(None));
        assert_eq!(QueryNumber(lf, ":SOUR1:CURR?").decode(b"   0\n"), Ok(0.0));
        assert_eq!(QueryFlag(lf, ":OUTP? CH1").decode(b"\t 1 \r\n"), Ok(true));
        assert_eq!(ReadVoltage(lf).decode(b"  +4.5E+00 \n"), Ok(Some(4.5)));
        assert_eq!(QueryNumber(lf, ":SOUR1:VOLT?").decode(b"45.000\n"), Ok(45.0));
        assert_eq!(QueryFlag(lf, ":OUTP? CH1").decode(b"ON\n"), Ok(true));
        let measured = Ok(Measured { voltage_v: 12.987, current_a: 0.2498 });
        assert_eq!(ReadMeasured(lf, Dialect::Dp800).decode(b"12.9870,0.2498,3.2441\n"), measured);
        assert_eq!(ReadMeasured(lf, Dialect::Hmp).decode(b"12.987;0.2498\n"), measured);
        assert!(ReadCondition(lf, Dialect::Dp800).decode(b"1\n").unwrap().constant_current);
        assert!(ReadCondition(lf, Dialect::Hmp).decode(b"513\n").unwrap().over_voltage_trip);
    }

    #[test]
    fn published_identities_of_a_kepco() {
        for text in ["KEPCO,BOP 50-20,E1234,2.66\n", "KEPCO,BOP1KW 50-20 ,E156884, 2.01\r\n"] {
            let identity = Identify(Terminator::Lf).decode(text.as_bytes()).unwrap();
            assert_eq!(Dialect::of(&identity), Some(Dialect::Kepco), "{text}");
        }
        let other = Identify(Terminator::Lf).decode(b"KEPCO,EL 5K-600-200,A104503,3.87\n").unwrap();
        assert_eq!(Dialect::of(&other), None);
    }

    #[test]
    fn a_kepco_gets_and_answers_one_line() {
        let (end, kepco) = (Terminator::CrLf, Dialect::Kepco);
        let mut out = Vec::new();
        Set(end, "CURR 0.25".into(), kepco.separator()).encode(&mut out);
        SwitchOff(end, kepco).encode(&mut out);
        assert_eq!(out, b"CURR 0.25;:SYST:ERR?\r\nSYST:REM 1;:CURR 0;:OUTP 0;CURR 0\r\n");
        let measured = Ok(Measured { voltage_v: 12.99, current_a: 0.25 });
        assert_eq!(ReadMeasured(end, kepco).decode(b"1.299E1;2.5E-1\r\n"), measured);
        let condition = |reply: &[u8]| ReadCondition(end, kepco).decode(reply);
        assert!(condition(b"1;1024\r\n").unwrap().constant_current);
        assert!(condition(b"1;256\r\n").unwrap().constant_voltage);
        assert!(!condition(b"0;1024\r\n").unwrap().constant_current, "the output is off");
        assert!(condition(b"1024\r\n").is_err());
    }

    #[test]
    fn an_overload_is_no_number_and_no_garbage() {
        let read = ReadVoltage(Terminator::Lf);
        assert_eq!(read.decode(b"+4.50012345E+00\n"), Ok(Some(4.500_123_45)));
        assert_eq!(read.decode(b"-9.90000000E+37\n"), Ok(None));
        assert!(matches!(read.decode(b"+9.91000000E+37\n"), Err(FaultKind::Garbled { .. })));
    }

    #[test]
    fn any_entry_but_zero_is_a_failure() {
        let set = Set(Terminator::CrLf, ":SOUR1:CURR 9".into(), "\n");
        let mut out = Vec::new();
        set.encode(&mut out);
        assert_eq!(out, b":SOUR1:CURR 9\r\n:SYST:ERR?\r\n");
        assert!(matches!(set.decode(b"-222,\"Data out of range\"\n"), Err(FaultKind::Refused { .. })));
        assert!(matches!(set.decode(b"171,\"of the maker's own\"\n"), Err(FaultKind::Refused { .. })));
        assert!(matches!(set.decode(b"rubbish\n"), Err(FaultKind::Garbled { .. })));
        assert_eq!(set.decode(b"0,\"No error\"\n"), Ok(()));
    }

    #[test]
    fn what_is_no_number_is_no_reading() {
        for reply in ["9.91E37\n", "nan\n", "inf\n", "\n", "1.0V\n"] {
            assert!(QueryNumber(Terminator::Lf, ":MEAS:CURR? CH1").decode(reply.as_bytes()).is_err(), "{reply}");
        }
    }
}
