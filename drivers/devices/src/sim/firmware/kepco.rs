//! A Kepco BOP 100-2 at RS-232, on a brake's coil (operator manual of the card BIT 4886). It is bipolar, but the coil
//! takes positive currents only. The error of a command in local mode is assumed.

use super::dp800_channel::Channel;
use super::lines::LineFirmware;
use super::scpi::{Error, Pattern, Status, Unit, number, units};
use super::supply_output::{CoilOutput, held, measured, switch};
use crate::sim::plant::Plant;
use crate::sim::trouble::Trouble;
use std::sync::LazyLock;

const MOST_V: f64 = 100.0;
const MOST_A: f64 = 2.0;
/// Bits of the operation condition register.
const CONSTANT_VOLTAGE: u32 = 1 << 8;
const CONSTANT_CURRENT: u32 = 1 << 10;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Command {
    SystemError,
    Remote,
    Mode,
    Voltage,
    Current,
    Output,
    MeasureVoltage,
    MeasureCurrent,
    Condition,
}

static COMMANDS: LazyLock<Vec<(Pattern, Command)>> = LazyLock::new(|| {
    let table = [
        (":SYSTem:ERRor[:NEXT]", Command::SystemError),
        (":SYSTem:REMote", Command::Remote),
        ("[:SOURce]:FUNCtion:MODE", Command::Mode),
        ("[:SOURce]:VOLTage[:LEVel][:IMMediate][:AMPLitude]", Command::Voltage),
        ("[:SOURce]:CURRent[:LEVel][:IMMediate][:AMPLitude]", Command::Current),
        (":OUTPut[:STATe]", Command::Output),
        (":MEASure[:SCALar][:VOLTage][:DC]", Command::MeasureVoltage),
        (":MEASure[:SCALar]:CURRent[:DC]", Command::MeasureCurrent),
        (":STATus:OPERation:CONDition", Command::Condition),
    ];
    table.into_iter().map(|(pattern, command)| (Pattern::new(pattern), command)).collect()
});

pub struct Kepco {
    channel: Channel,
    /// The current is regulated and the voltage is the limit; otherwise the other way round.
    regulates_current: bool,
    /// Commands are accepted, not only queries.
    remote: bool,
    status: Status,
    output: CoilOutput,
    trouble: Trouble,
}

impl Kepco {
    pub fn new() -> Self {
        Self {
            channel: Channel::new("", MOST_V, MOST_A),
            regulates_current: false,
            remote: false,
            status: Status::power_on(),
            output: CoilOutput::default(),
            trouble: Trouble::None,
        }
    }

    fn execute(&mut self, unit: &Unit, plant: &Plant) -> Result<Option<String>, Error> {
        let header: Vec<&str> = unit.header.iter().map(String::as_str).collect();
        if let [common] = header[..]
            && common.starts_with('*')
        {
            return match (common.to_ascii_uppercase().as_str(), unit.query) {
                ("*IDN", true) => {
                    let serial = if self.trouble == Trouble::Exchanged { "E100999" } else { "E100123" };
                    Ok(Some(format!("KEPCO,BOP 100-2,{serial},2.66")))
                }
                ("*RST", false) => {
                    self.channel = Self::new().channel;
                    self.regulates_current = false;
                    Ok(None)
                }
                (other, _) => self.status.common(other, unit),
            };
        }
        let found = COMMANDS.iter().find(|(pattern, _)| pattern.matches(&header).is_some());
        let (_, command) = found.ok_or(Error::UndefinedHeader)?;
        if self.trouble == Trouble::Refusing && *command != Command::SystemError {
            return Err(Error::Execution);
        }
        if unit.query { self.query(*command, plant).map(Some) } else { self.set(*command, unit).map(|()| None) }
    }

    fn set(&mut self, command: Command, unit: &Unit) -> Result<(), Error> {
        let first = unit.parameters.first().ok_or(Error::Missing)?;
        if command == Command::Remote {
            self.remote = switch(first).ok_or(Error::IllegalValue)?;
            return Ok(());
        }
        if !self.remote {
            return Err(Error::Execution);
        }
        match command {
            Command::Mode => {
                self.regulates_current = match first.to_ascii_uppercase().as_str() {
                    "CURR" | "CURRENT" => true,
                    "VOLT" | "VOLTAGE" => false,
                    _ => return Err(Error::IllegalValue),
                }
            }
            Command::Voltage => self.channel.voltage_v = number(first, "V", (0.0, MOST_V))?,
            Command::Current => self.channel.current_a = number(first, "A", (0.0, MOST_A))?,
            Command::Output => self.channel.on = switch(first).ok_or(Error::IllegalValue)?,
            _ => return Err(Error::UndefinedHeader),
        }
        Ok(())
    }

    /// Set values are kept while the output is off.
    fn query(&mut self, command: Command, plant: &Plant) -> Result<String, Error> {
        Ok(match command {
            Command::SystemError => self.status.pop(),
            Command::Mode => u8::from(self.regulates_current).to_string(),
            Command::Voltage => format!("{:.4E}", self.channel.voltage_v),
            Command::Current => format!("{:.4E}", self.channel.current_a),
            Command::Output => u8::from(self.channel.on).to_string(),
            Command::MeasureVoltage => format!("{:.4E}", measured(None, plant).0),
            Command::MeasureCurrent => format!("{:.4E}", measured(None, plant).1),
            Command::Condition => match held(self.channel.on, true, plant) {
                1 => CONSTANT_CURRENT,
                0 if self.regulates_current => CONSTANT_CURRENT,
                _ => CONSTANT_VOLTAGE,
            }
            .to_string(),
            Command::Remote => return Err(Error::UndefinedHeader),
        })
    }
}

impl LineFirmware for Kepco {
    const LONGEST_LINE: usize = 127;

    fn line(&mut self, line: &str, plant: &Plant) -> Option<String> {
        let mut replies = Vec::new();
        for unit in units(line.trim()) {
            let before = self.channel.wanted();
            match self.execute(&unit, plant) {
                Ok(Some(reply)) => replies.push(reply),
                Ok(None) => {}
                Err(error) => self.status.push(error),
            }
            self.output.pass_on(before, self.channel.wanted(), plant);
        }
        (!replies.is_empty()).then(|| replies.join(";") + "\r")
    }

    fn step(&mut self, plant: &mut Plant) {
        self.output.step(&mut self.channel, plant);
    }

    fn trouble(&mut self) -> &mut Trouble {
        &mut self.trouble
    }

    fn restart(&mut self, plant: &mut Plant) {
        *self = Self::new();
        plant.inputs.coil = None;
    }
}
