//! One type for each command.

use super::line::{LINE_LIMIT, number, push, text};
use crate::protocol::scan_line;
use crate::transport::{Command, Request, Scan};
use jointbench_instrument::FaultKind;
use jointbench_instrument::roles::Identity;

/// Position and velocity of an axis, in full precision (`f`).
#[derive(Debug, Clone, Copy)]
pub struct ReadFeedback {
    /// Number of the axis, 0 or 1.
    pub axis: u8,
}

/// `%f` prints six decimals, so the reply is a whole number of 10⁻⁶ turns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Feedback {
    /// Position [10⁻⁶ turns].
    pub position_micro_turns: i64,
    /// Velocity [10⁻⁶ turns/s].
    pub velocity_micro_turns_s: i64,
}

impl Command for ReadFeedback {
    fn encode(&self, out: &mut Vec<u8>) {
        push(out, format_args!("f {}", self.axis));
    }

    fn name(&self) -> String {
        format!("f {}", self.axis)
    }
}

impl Request for ReadFeedback {
    type Reply = Feedback;

    fn scan(&self, received: &[u8]) -> Scan {
        scan_line(received, LINE_LIMIT)
    }

    fn decode(&self, packet: &[u8]) -> Result<Feedback, FaultKind> {
        let text = text(packet)?;
        let garbled = || FaultKind::Garbled { what: format!("`{text}`: expected a position and a velocity") };
        let (position, velocity) = text.split_once(' ').ok_or_else(garbled)?;
        let millionths = |text| number(text).map(|value| (value * 1e6).round() as i64);
        Ok(Feedback { position_micro_turns: millionths(position)?, velocity_micro_turns_s: millionths(velocity)? })
    }
}

/// A property as a number (`r`), cut after nine characters.
#[derive(Debug, Clone, Copy)]
pub struct ReadNumber {
    /// Path of the property, such as `vbus_voltage`.
    pub path: &'static str,
}

impl Command for ReadNumber {
    fn encode(&self, out: &mut Vec<u8>) {
        push(out, format_args!("r {}", self.path));
    }

    fn name(&self) -> String {
        format!("r {}", self.path)
    }
}

impl Request for ReadNumber {
    type Reply = f64;

    fn scan(&self, received: &[u8]) -> Scan {
        scan_line(received, LINE_LIMIT)
    }

    fn decode(&self, packet: &[u8]) -> Result<f64, FaultKind> {
        text(packet).and_then(number)
    }
}

/// Writes a property and reads it back in the same transmission. The reply is the value after the write.
#[derive(Debug, Clone, Copy)]
pub struct Set {
    /// Path of the property.
    pub path: &'static str,
    /// Value to write.
    pub value: f64,
}

impl Command for Set {
    fn encode(&self, out: &mut Vec<u8>) {
        push(out, format_args!("w {} {}", self.path, self.value));
        push(out, format_args!("r {}", self.path));
    }

    fn name(&self) -> String {
        format!("w {} {}", self.path, self.value)
    }
}

impl Request for Set {
    type Reply = f64;

    fn scan(&self, received: &[u8]) -> Scan {
        scan_line(received, LINE_LIMIT)
    }

    fn decode(&self, packet: &[u8]) -> Result<f64, FaultKind> {
        taken(text(packet)?, self.value, self.path)
    }
}

/// Velocity set-point of the joint's axis with a feed-forward torque, read back. Feeds the watchdog. Selects velocity
/// mode.
#[derive(Debug, Clone, Copy)]
pub struct SetVelocity {
    /// Velocity set-point [turns/s].
    pub turns_s: f64,
    /// Feed-forward torque (Nm).
    pub torque_nm: f64,
}

const INPUT_VELOCITY: &str = "axis0.controller.input_vel";

impl Command for SetVelocity {
    fn encode(&self, out: &mut Vec<u8>) {
        push(out, format_args!("v 0 {:.6} {:.6}", self.turns_s, self.torque_nm));
        push(out, format_args!("r {INPUT_VELOCITY}"));
    }

    fn name(&self) -> String {
        format!("v 0 {:.6} {:.6}", self.turns_s, self.torque_nm)
    }
}

impl Request for SetVelocity {
    type Reply = f64;

    fn scan(&self, received: &[u8]) -> Scan {
        scan_line(received, LINE_LIMIT)
    }

    fn decode(&self, packet: &[u8]) -> Result<f64, FaultKind> {
        taken(text(packet)?, self.turns_s, INPUT_VELOCITY)
    }
}

/// Torque set-point of the joint's axis, read back. Feeds the watchdog. Selects torque mode, in which no loop controls
/// the speed.
#[derive(Debug, Clone, Copy)]
pub struct SetTorque {
    /// Torque set-point (Nm).
    pub torque_nm: f64,
}

const INPUT_TORQUE: &str = "axis0.controller.input_torque";

impl Command for SetTorque {
    fn encode(&self, out: &mut Vec<u8>) {
        push(out, format_args!("c 0 {:.6}", self.torque_nm));
        push(out, format_args!("r {INPUT_TORQUE}"));
    }

    fn name(&self) -> String {
        format!("c 0 {:.6}", self.torque_nm)
    }
}

impl Request for SetTorque {
    type Reply = f64;

    fn scan(&self, received: &[u8]) -> Scan {
        scan_line(received, LINE_LIMIT)
    }

    fn decode(&self, packet: &[u8]) -> Result<f64, FaultKind> {
        taken(text(packet)?, self.torque_nm, INPUT_TORQUE)
    }
}

/// The value read back, if it equals the set value within float precision and nine characters.
fn taken(text: &str, wanted: f64, path: &str) -> Result<f64, FaultKind> {
    let found = number(text)?;
    let decimals = text.split_once('.').map_or(0, |(_, decimals)| decimals.len() as i32);
    if (found - wanted).abs() <= 1.01 * 10f64.powi(-decimals) + 1e-6 * wanted.abs() {
        return Ok(found);
    }
    Err(FaultKind::Garbled {
        what: format!("{path} reads {text} after {wanted} was set: the command was not accepted"),
    })
}

/// Keeps the drive armed (`u`), as does any set-point. No reply.
#[derive(Debug, Clone, Copy)]
pub struct FeedWatchdog;

impl Command for FeedWatchdog {
    fn encode(&self, out: &mut Vec<u8>) {
        push(out, format_args!("u 0"));
    }

    fn name(&self) -> String {
        "u 0".into()
    }
}

/// Clears the errors of both axes (`sc`). No reply.
#[derive(Debug, Clone, Copy)]
pub struct ClearErrors;

impl Command for ClearErrors {
    fn encode(&self, out: &mut Vec<u8>) {
        push(out, format_args!("sc"));
    }

    fn name(&self) -> String {
        "sc".into()
    }
}

/// Requests a state of the axis. The property always reads 0, so `axis0.current_state` shows the result. No reply.
#[derive(Debug, Clone, Copy)]
pub struct RequestState(pub f64);

impl Command for RequestState {
    fn encode(&self, out: &mut Vec<u8>) {
        push(out, format_args!("w axis0.requested_state {}", self.0));
    }

    fn name(&self) -> String {
        format!("w axis0.requested_state {}", self.0)
    }
}

/// Torque off: idle state, zero set-points, watchdog disabled. No reply.
///
/// Starts with a line end, so that the rest of an incomplete line does not absorb the first command.
#[derive(Debug, Clone, Copy)]
pub struct TorqueOff {
    /// An incomplete line was sent before: end it first.
    pub after_broken_line: bool,
}

impl Command for TorqueOff {
    fn encode(&self, out: &mut Vec<u8>) {
        if self.after_broken_line {
            out.push(b'\n');
        }
        push(out, format_args!("w axis0.requested_state 1"));
        push(out, format_args!("v 0 0 0"));
        push(out, format_args!("w axis0.config.enable_watchdog 0"));
    }

    fn name(&self) -> String {
        "w axis0.requested_state 1".into()
    }
}

/// Identity of the drive (`i`): three lines.
#[derive(Debug, Clone, Copy)]
pub struct ReadInfo;

impl Command for ReadInfo {
    fn encode(&self, out: &mut Vec<u8>) {
        push(out, format_args!("i"));
    }

    fn name(&self) -> String {
        "i".into()
    }
}

impl Request for ReadInfo {
    type Reply = Identity;

    fn scan(&self, received: &[u8]) -> Scan {
        let mut ends = received.iter().enumerate().filter(|(_, byte)| **byte == b'\n').map(|(at, _)| at);
        match ends.nth(2) {
            Some(end) => Scan::Packet { length: end + 1 },
            // An instrument with a one-line answer is another instrument: no third line will arrive.
            None if received.len() > 3 * LINE_LIMIT => Scan::Noise { skip: received.len() },
            None => Scan::Short,
        }
    }

    fn decode(&self, packet: &[u8]) -> Result<Identity, FaultKind> {
        let mut facts = packet.split_inclusive(|byte| *byte == b'\n');
        let mut fact = |label: &str| {
            let text = text(facts.next().unwrap_or_default())?;
            let value = text.strip_prefix(label).ok_or_else(|| FaultKind::WrongInstrument {
                expected: format!("`{label}` of an ODrive"),
                found: text.to_owned(),
            })?;
            Ok::<_, FaultKind>(value.to_owned())
        };
        let model = format!("ODrive {}", fact("Hardware version: ")?);
        let firmware = fact("Firmware version: ")?;
        let serial = fact("Serial number: ")?;
        Ok(Identity { maker: "ODrive Robotics".into(), model, serial, firmware })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn encoded(command: &impl Command) -> String {
        let mut out = Vec::new();
        command.encode(&mut out);
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn a_set_travels_with_its_read() {
        assert_eq!(
            encoded(&SetVelocity { turns_s: -1.5, torque_nm: 0.0 }),
            "v 0 -1.500000 0.000000*79\nr axis0.controller.input_vel*43\n"
        );
        for line in encoded(&Set { path: "axis0.motor.config.current_lim", value: 10.0 }).lines() {
            assert!(line.contains('*') && !line.contains('\r'));
        }
    }

    #[test]
    fn feedback_is_whole_millionths() {
        let reply = b"1.077135 1.482737*";
        let sum = reply[..17].iter().fold(0, |sum, byte| sum ^ byte);
        let line = format!("1.077135 1.482737*{sum}\r\n");
        let request = ReadFeedback { axis: 0 };
        assert_eq!(request.scan(line.as_bytes()), Scan::Packet { length: line.len() });
        let feedback = request.decode(line.as_bytes()).unwrap();
        assert_eq!(feedback, Feedback { position_micro_turns: 1_077_135, velocity_micro_turns_s: 1_482_737 });
    }

    #[test]
    fn nine_characters_are_enough_to_see_that_a_set_was_taken() {
        assert!(taken("-123.4560", -123.456_012, "p").is_ok());
        assert!(taken("-12.34567", -12.345_678, "p").is_ok());
        assert!(taken("0.000000", -12.345_678, "p").is_err());
        assert!(taken("8", 8.0, "p").is_ok());
        assert!(taken("1", 8.0, "p").is_err());
    }
}
