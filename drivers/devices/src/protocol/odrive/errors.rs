//! Error words of an axis and of the drive (`odrive-interface.yaml`, tools/odrive/enums.py of tag fw-v0.5.6).

use super::line::{LINE_LIMIT, push, text};
use crate::protocol::scan_line;
use crate::transport::{Command, Request, Scan};
use jointbench_instrument::FaultKind;

/// The parts of a drive that have their own error word.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// Power supply and brake resistor.
    System,
    /// State machine of the axis.
    Axis,
    /// Motor and its power stage.
    Motor,
    /// Encoder of the motor.
    Encoder,
    /// Control loops.
    Controller,
}

impl Part {
    /// Every part, the drive first.
    pub const ALL: [Part; 5] = [Part::System, Part::Axis, Part::Motor, Part::Encoder, Part::Controller];

    fn path(self) -> &'static str {
        match self {
            Part::System => "error",
            Part::Axis => "axis0.error",
            Part::Motor => "axis0.motor.error",
            Part::Encoder => "axis0.encoder.error",
            Part::Controller => "axis0.controller.error",
        }
    }

    fn bits(self) -> &'static [(u64, &'static str)] {
        match self {
            Part::System => &[
                (0x2, "DC_BUS_UNDER_VOLTAGE"),
                (0x4, "DC_BUS_OVER_VOLTAGE"),
                (0x8, "DC_BUS_OVER_REGEN_CURRENT"),
                (0x10, "DC_BUS_OVER_CURRENT"),
                (0x80, "INVALID_BRAKE_RESISTANCE"),
            ],
            Part::Axis => &[
                (0x1, "INVALID_STATE"),
                (0x40, "MOTOR_FAILED"),
                (0x100, "ENCODER_FAILED"),
                (0x200, "CONTROLLER_FAILED"),
                (0x800, "WATCHDOG_TIMER_EXPIRED"),
                (0x1000, "MIN_ENDSTOP_PRESSED"),
                (0x2000, "MAX_ENDSTOP_PRESSED"),
                (0x4000, "ESTOP_REQUESTED"),
                (0x40000, "OVER_TEMP"),
                (0x80000, "UNKNOWN_POSITION"),
            ],
            Part::Motor => &[
                (0x1, "PHASE_RESISTANCE_OUT_OF_RANGE"),
                (0x2, "PHASE_INDUCTANCE_OUT_OF_RANGE"),
                (0x8, "DRV_FAULT"),
                (0x80, "MODULATION_MAGNITUDE"),
                (0x400, "CURRENT_SENSE_SATURATION"),
                (0x1000, "CURRENT_LIMIT_VIOLATION"),
                (0x20000, "MOTOR_THERMISTOR_OVER_TEMP"),
                (0x40000, "FET_THERMISTOR_OVER_TEMP"),
                (0x400000, "I_BUS_OUT_OF_RANGE"),
                (0x1000000, "SYSTEM_LEVEL"),
            ],
            Part::Encoder => &[
                (0x2, "CPR_POLEPAIRS_MISMATCH"),
                (0x4, "NO_RESPONSE"),
                (0x40, "ABS_SPI_TIMEOUT"),
                (0x80, "ABS_SPI_COM_FAIL"),
                (0x100, "ABS_SPI_NOT_READY"),
            ],
            Part::Controller => &[
                (0x1, "OVERSPEED"),
                (0x2, "INVALID_INPUT_MODE"),
                (0x10, "INVALID_LOAD_ENCODER"),
                (0x20, "INVALID_ESTIMATE"),
                (0x80, "SPINOUT_DETECTED"),
            ],
        }
    }
}

/// An error word as far as nine characters can show it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ErrorWord {
    /// The whole word.
    Bits(u64),
    /// Nine digits: the 64-bit word of the motor was cut. Only one fact is certain: a high bit is set.
    Cut,
}

impl ErrorWord {
    /// No error is set.
    pub fn is_clear(self) -> bool {
        self == ErrorWord::Bits(0)
    }

    /// Names of the set bits; bits without a name are given in hexadecimal.
    pub fn names(self, part: Part) -> Vec<String> {
        let bits = match self {
            ErrorWord::Cut => {
                return vec![format!("{part:?}: an error above bit 26 (the reply is cut)").to_lowercase()];
            }
            ErrorWord::Bits(bits) => bits,
        };
        let known = part.bits().iter().filter(|(bit, _)| bits & bit != 0);
        let rest = part.bits().iter().fold(bits, |rest, (bit, _)| rest & !bit);
        let label = format!("{part:?}").to_lowercase();
        let mut names: Vec<String> = known.map(|(_, name)| format!("{label} {name}")).collect();
        if rest != 0 {
            names.push(format!("{label} {rest:#x}"));
        }
        names
    }
}

/// The error word of one part.
#[derive(Debug, Clone, Copy)]
pub struct ReadErrors(pub Part);

impl Command for ReadErrors {
    fn encode(&self, out: &mut Vec<u8>) {
        push(out, format_args!("r {}", self.0.path()));
    }

    fn name(&self) -> String {
        format!("r {}", self.0.path())
    }
}

impl Request for ReadErrors {
    type Reply = ErrorWord;

    fn scan(&self, received: &[u8]) -> Scan {
        scan_line(received, LINE_LIMIT)
    }

    fn decode(&self, packet: &[u8]) -> Result<ErrorWord, FaultKind> {
        let digits = text(packet)?;
        match digits.parse() {
            Ok(_) if digits.len() >= 9 => Ok(ErrorWord::Cut),
            Ok(bits) => Ok(ErrorWord::Bits(bits)),
            Err(_) => Err(FaultKind::Garbled { what: format!("`{digits}`: expected an error word") }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cut_word_is_not_decoded() {
        // The reply for the value 68719476735.
        let line = "687194767";
        let sum = line.bytes().fold(0, |sum, byte| sum ^ byte);
        let word = ReadErrors(Part::Motor).decode(format!("{line}*{sum}\r\n").as_bytes()).unwrap();
        assert_eq!(word, ErrorWord::Cut);
        assert_eq!(word.names(Part::Motor).len(), 1);
    }

    #[test]
    fn bits_have_names() {
        let names = ErrorWord::Bits(0x8_0801).names(Part::Axis);
        assert_eq!(names, ["axis INVALID_STATE", "axis WATCHDOG_TIMER_EXPIRED", "axis UNKNOWN_POSITION"]);
        assert_eq!(ErrorWord::Bits(0x400).names(Part::Controller), ["controller 0x400"]);
    }
}
