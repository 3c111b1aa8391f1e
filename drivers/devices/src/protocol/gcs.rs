//! PI GCS 2.0 (General Command Set) of the C-887 hexapod controller.
//!
//! Set commands have no reply, so each is sent together with a query of the error register. Every line of a reply
//! except the last ends with a space before its line feed.

use super::identity;
use crate::transport::{Command, Request, Scan, shown};
use jointbench_instrument::FaultKind;
use jointbench_instrument::roles::Identity;

const REPLY_LIMIT: usize = 2048;
/// Names of the axes: shifts X, Y, Z, then rotations U, V, W about them.
pub(crate) const AXES: [char; 6] = ['X', 'Y', 'Z', 'U', 'V', 'W'];

/// A reply is complete at a line feed without a space before it.
fn scan_reply(received: &[u8]) -> Scan {
    let ends = |at: &usize| received[*at] == b'\n' && (*at == 0 || received[at - 1] != b' ');
    match (0..received.len()).find(ends) {
        Some(end) => Scan::Packet { length: end + 1 },
        None if received.len() > REPLY_LIMIT => Scan::Noise { skip: received.len() },
        None => Scan::Short,
    }
}

fn text(packet: &[u8]) -> Result<&str, FaultKind> {
    let text = std::str::from_utf8(packet).ok().filter(|text| text.is_ascii());
    text.map(str::trim_end).ok_or_else(|| FaultKind::Garbled { what: format!("{}: expected ASCII", shown(packet)) })
}

macro_rules! query {
    ($request:ty, |$this:ident| $query:expr, $reply:ty, |$text:ident| $decode:expr) => {
        impl Command for $request {
            fn encode(&self, out: &mut Vec<u8>) {
                out.extend_from_slice(self.name().as_bytes());
                out.push(b'\n');
            }

            fn name(&self) -> String {
                let $this = self;
                $query.into()
            }
        }

        impl Request for $request {
            type Reply = $reply;

            fn scan(&self, received: &[u8]) -> Scan {
                scan_reply(received)
            }

            fn decode(&self, packet: &[u8]) -> Result<$reply, FaultKind> {
                let $text = text(packet)?;
                $decode
            }
        }
    };
}

/// Maker, model, serial number and firmware (`*IDN?`).
#[derive(Debug, Clone, Copy)]
pub struct Identify;

query!(Identify, |_this| "*IDN?", Identity, |text| identity(text));

/// The error since the last query; the query clears it.
#[derive(Debug, Clone, Copy)]
pub struct QueryError;

query!(QueryError, |_this| "ERR?", u32, |text| code(text));

fn code(text: &str) -> Result<u32, FaultKind> {
    text.parse().map_err(|_| FaultKind::Garbled { what: format!("`{text}`: expected an error code") })
}

/// One number for each of the six axes.
#[derive(Debug, Clone, Copy)]
pub struct QueryAxes(pub &'static str);

query!(QueryAxes, |this| this.0, [f64; 6], |text| {
    let garbled = || FaultKind::Garbled { what: format!("`{}`: expected a number for each axis", text.escape_debug()) };
    let mut values = [f64::NAN; 6];
    let mut lines = text.split(" \n");
    for (axis, value) in AXES.iter().zip(&mut values) {
        let number = lines.next().and_then(|line| line.strip_prefix(*axis)?.strip_prefix('=')?.parse::<f64>().ok());
        *value = number.filter(|number| number.is_finite()).ok_or_else(garbled)?;
    }
    if lines.next().is_some() { Err(garbled()) } else { Ok(values) }
});

/// Whether a pose is within reach.
#[derive(Debug, Clone, Copy)]
pub struct QueryReachable(pub [f64; 6]);

query!(QueryReachable, |this| format!("VMO? {}", pairs(this.0)), bool, |text| match text {
    "1" => Ok(true),
    "0" => Ok(false),
    _ => Err(FaultKind::Garbled { what: format!("`{text}`: expected 0 or 1") }),
});

/// A command followed by a query whether it was accepted.
#[derive(Debug, Clone)]
pub struct Set(pub String);

impl Set {
    /// Moves to a pose in mm and degrees; all axes arrive together.
    pub fn move_to(axes: [f64; 6]) -> Self {
        Self(format!("MOV {}", pairs(axes)))
    }
}

fn pairs(axes: [f64; 6]) -> String {
    AXES.iter().zip(axes).map(|(axis, value)| format!("{axis} {value:.6}")).collect::<Vec<_>>().join(" ")
}

impl Command for Set {
    fn encode(&self, out: &mut Vec<u8>) {
        out.extend_from_slice(format!("{}\nERR?\n", self.0).as_bytes());
    }

    fn name(&self) -> String {
        self.0.clone()
    }
}

impl Request for Set {
    type Reply = ();

    fn scan(&self, received: &[u8]) -> Scan {
        scan_reply(received)
    }

    fn decode(&self, packet: &[u8]) -> Result<(), FaultKind> {
        match code(text(packet)?)? {
            0 => Ok(()),
            code => Err(FaultKind::Refused { what: format!("{}: {}", self.0, error_text(code)) }),
        }
    }
}

/// Stops everything immediately, even in the middle of another command. No reply; sets error 10.
#[derive(Debug, Clone, Copy)]
pub struct StopAll;

impl Command for StopAll {
    fn encode(&self, out: &mut Vec<u8>) {
        out.push(0x18);
    }

    fn name(&self) -> String {
        "#24".into()
    }
}

/// The controller's texts for the codes that occur on a bench.
pub(crate) fn error_text(code: u32) -> String {
    let text = match code {
        1 => "parameter syntax error",
        2 => "unknown command",
        5 => "the axes are not referenced, or the servo is off",
        7 => "position out of limits; nothing has moved",
        8 => "velocity out of limits",
        10 => "the controller was stopped by a command",
        15 => "invalid axis",
        17 => "parameter out of range",
        24 => "wrong number of parameters",
        27 => "beyond a soft limit",
        53 => "not allowed while moving",
        63 => "initialisation in progress",
        1005 => "busy with a reference move",
        1024 => "position error too large: the servo is off",
        1090 => "too many connections",
        _ => return format!("error {code}"),
    };
    format!("error {code}: {text}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn published_replies() {
        let idn = b"(c)2015 Physik Instrumente (PI) GmbH & Co. KG, C-887, 0, 2.7.0.1\n";
        assert_eq!(Identify.scan(idn), Scan::Packet { length: idn.len() });
        assert_eq!(Identify.decode(idn).unwrap().model, "C-887");
        assert_eq!(QueryError.decode(b"0\n"), Ok(0));
        let pos = b"X=0.499998 \nY=-0.000002 \nZ=0.000000 \nU=0.200000 \nV=0.000000 \nW=0.000000\n";
        let query = QueryAxes("POS?");
        for cut in 0..pos.len() {
            assert_eq!(query.scan(&pos[..cut]), Scan::Short, "{cut} bytes");
        }
        assert_eq!(query.scan(pos), Scan::Packet { length: pos.len() });
        assert_eq!(query.decode(pos), Ok([0.499_998, -0.000_002, 0.0, 0.2, 0.0, 0.0]));
        assert_eq!(QueryReachable([0.0; 6]).decode(b"1\n"), Ok(true));
    }

    #[test]
    fn a_move_asks_whether_it_was_taken() {
        let mut out = Vec::new();
        let set = Set::move_to([0.5, 0.0, 0.0, 0.2, 0.0, 0.0]);
        set.encode(&mut out);
        let expected = "MOV X 0.500000 Y 0.000000 Z 0.000000 U 0.200000 V 0.000000 W 0.000000\nERR?\n";
        assert_eq!(String::from_utf8(out).unwrap(), expected);
        assert_eq!(set.decode(b"0\n"), Ok(()));
        assert!(matches!(set.decode(b"7\n"), Err(FaultKind::Refused { what }) if what.contains("nothing has moved")));
    }

    #[test]
    fn half_a_pose_is_none() {
        for reply in ["X=1.0\n", "X=1 \nY=2 \nZ=3 \nV=0 \nU=0 \nW=0\n", "X=1 \nY=2 \nZ=3 \nU=nan \nV=0 \nW=0\n"] {
            assert!(matches!(QueryAxes("POS?").decode(reply.as_bytes()), Err(FaultKind::Garbled { .. })), "{reply}");
        }
    }
}
