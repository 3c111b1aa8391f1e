//! A Rohde & Schwarz HMP4040, channel 1 on a brake's coil. The command set is the one that pymeasure's client uses; the
//! condition registers are assumed.

use super::dp800_channel::Channel;
use super::lines::LineFirmware;
use super::scpi::{Error, Pattern, Status, Unit, number, units};
use super::supply_output::{CoilOutput, held, measured, switch};
use crate::sim::plant::{CoilSupply, Plant};
use crate::sim::trouble::Trouble;
use std::sync::LazyLock;

const MOST_V: f64 = 32.05;
const MOST_A: f64 = 10.01;
/// Resolution of set values (assumed).
const STEP_V: f64 = 1e-3;
const STEP_A: f64 = 2e-4;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Command {
    SystemError,
    SystemVersion,
    SystemControl,
    SelectNumber,
    SelectName,
    Voltage,
    Current,
    VoltageStep,
    CurrentStep,
    Apply,
    Select,
    General,
    MeasureVoltage,
    MeasureCurrent,
    Condition,
}

static COMMANDS: LazyLock<Vec<(Pattern, Command)>> = LazyLock::new(|| {
    let table = [
        (":SYSTem:ERRor[:NEXT]", Command::SystemError),
        (":SYSTem:VERSion", Command::SystemVersion),
        (":SYSTem:BEEPer[:IMMediate]", Command::SystemControl),
        (":SYSTem:REMote", Command::SystemControl),
        (":SYSTem:LOCal", Command::SystemControl),
        (":SYSTem:MIX", Command::SystemControl),
        (":SYSTem:RWLock", Command::SystemControl),
        (":INSTrument:NSELect", Command::SelectNumber),
        (":INSTrument[:SELect]", Command::SelectName),
        ("[:SOURce]:VOLTage[:LEVel][:IMMediate][:AMPLitude]", Command::Voltage),
        ("[:SOURce]:CURRent[:LEVel][:IMMediate][:AMPLitude]", Command::Current),
        ("[:SOURce]:VOLTage:STEP[:INCRement]", Command::VoltageStep),
        ("[:SOURce]:CURRent:STEP[:INCRement]", Command::CurrentStep),
        (":APPLy", Command::Apply),
        (":OUTPut:SELect", Command::Select),
        (":OUTPut:GENeral", Command::General),
        // The old name of the channel's own switch.
        (":OUTPut[:STATe]", Command::Select),
        (":MEASure[:SCALar]:VOLTage[:DC]", Command::MeasureVoltage),
        (":MEASure[:SCALar][:VOLTage][:DC]", Command::MeasureVoltage),
        (":MEASure[:SCALar]:CURRent[:DC]", Command::MeasureCurrent),
        (":STATus:QUEStionable:INSTrument:ISUMmary#:CONDition", Command::Condition),
    ];
    table.into_iter().map(|(pattern, command)| (Pattern::new(pattern), command)).collect()
});

pub struct Hmp {
    channels: [Channel; 4],
    /// Step sizes of `UP` and `DOWN`, volts then amperes.
    steps: [f64; 2],
    selected: usize,
    /// The relay for all channels.
    general: bool,
    status: Status,
    output: CoilOutput,
    trouble: Trouble,
}

impl Hmp {
    pub fn new() -> Self {
        Self {
            channels: std::array::from_fn(|_| Channel::new("", MOST_V, MOST_A)),
            steps: [1.0, 0.1],
            selected: 0,
            general: false,
            status: Status::power_on(),
            output: CoilOutput::default(),
            trouble: Trouble::None,
        }
    }

    fn wanted(&self) -> Option<CoilSupply> {
        self.channels[0].wanted().filter(|_| self.general)
    }

    fn execute(&mut self, unit: &Unit, plant: &Plant) -> Result<Option<String>, Error> {
        let header: Vec<&str> = unit.header.iter().map(String::as_str).collect();
        if let [common] = header[..]
            && common.starts_with('*')
        {
            return match (common.to_ascii_uppercase().as_str(), unit.query) {
                ("*IDN", true) => {
                    let serial = if self.trouble == Trouble::Exchanged { "100999" } else { "100123" };
                    Ok(Some(format!("ROHDE&SCHWARZ,HMP4040,{serial},HW50020001/SW2.51")))
                }
                ("*RST", false) => {
                    let status = std::mem::replace(&mut self.status, Status::power_on());
                    let output = std::mem::take(&mut self.output);
                    *self = Self { status, output, trouble: self.trouble, ..Self::new() };
                    Ok(None)
                }
                (other, _) => self.status.common(other, unit),
            };
        }
        let found =
            COMMANDS.iter().find_map(|(pattern, command)| pattern.matches(&header).map(|numbers| (*command, numbers)));
        let (command, numbers) = found.ok_or(Error::UndefinedHeader)?;
        if self.trouble == Trouble::Refusing && command != Command::SystemError {
            return Err(Error::Execution);
        }
        if unit.query {
            self.query(command, unit, &numbers, plant).map(Some)
        } else {
            self.set(command, unit).map(|()| None)
        }
    }

    fn set(&mut self, command: Command, unit: &Unit) -> Result<(), Error> {
        let first = || unit.parameters.first().map(String::as_str).ok_or(Error::Missing);
        let [step_v, step_a] = self.steps;
        let channel = &mut self.channels[self.selected];
        match command {
            Command::SystemControl => {}
            Command::SelectNumber => self.selected = index(first()?)?,
            Command::SelectName => {
                let name = first()?.to_ascii_uppercase();
                let number =
                    name.strip_prefix("OUTPUT").or_else(|| name.strip_prefix("OUT")).ok_or(Error::IllegalValue)?;
                self.selected = index(number)?;
            }
            Command::Voltage => channel.voltage_v = level(first()?, "V", channel.voltage_v, step_v, MOST_V, STEP_V)?,
            Command::Current => channel.current_a = level(first()?, "A", channel.current_a, step_a, MOST_A, STEP_A)?,
            Command::VoltageStep => self.steps[0] = number(first()?, "V", (0.0, MOST_V))?,
            Command::CurrentStep => self.steps[1] = number(first()?, "A", (0.0, MOST_A))?,
            Command::Apply => {
                let voltage_v = level(first()?, "V", channel.voltage_v, step_v, MOST_V, STEP_V)?;
                if let Some(text) = unit.parameters.get(1) {
                    channel.current_a = level(text, "A", channel.current_a, step_a, MOST_A, STEP_A)?;
                }
                channel.voltage_v = voltage_v;
            }
            Command::Select => channel.on = switch(first()?).ok_or(Error::IllegalValue)?,
            Command::General => self.general = switch(first()?).ok_or(Error::IllegalValue)?,
            _ => return Err(Error::UndefinedHeader),
        }
        Ok(())
    }

    fn query(&mut self, command: Command, unit: &Unit, numbers: &[u32], plant: &Plant) -> Result<String, Error> {
        if command == Command::SystemError {
            return Ok(self.status.pop());
        }
        let channel = &self.channels[self.selected];
        let limit = |value: f64, most: f64| match unit.parameters.first().map(|p| p.to_ascii_uppercase()).as_deref() {
            None => Ok(value),
            Some("MIN" | "MINIMUM") => Ok(0.0),
            Some("MAX" | "MAXIMUM") => Ok(most),
            Some(_) => Err(Error::NotAllowed),
        };
        let flag = |on: bool| u8::from(on).to_string();
        let free_v =
            |index: usize| (index > 0).then(|| if self.is_on(index) { self.channels[index].voltage_v } else { 0.0 });
        Ok(match command {
            Command::SystemVersion => "1995.0".into(),
            Command::SelectNumber => (self.selected + 1).to_string(),
            Command::SelectName => format!("OUTPUT{}", self.selected + 1),
            Command::Voltage => format!("{:.3}", limit(channel.voltage_v, MOST_V)?),
            Command::Current => format!("{:.4}", limit(channel.current_a, MOST_A)?),
            Command::VoltageStep => format!("{:.3}", self.steps[0]),
            Command::CurrentStep => format!("{:.4}", self.steps[1]),
            Command::Apply => format!("{:.3}, {:.4}", channel.voltage_v, channel.current_a),
            Command::Select => flag(channel.on),
            Command::General => flag(self.general),
            Command::MeasureVoltage => format!("{:.3}", measured(free_v(self.selected), plant).0),
            Command::MeasureCurrent => format!("{:.4}", measured(free_v(self.selected), plant).1),
            Command::Condition => {
                let index = index(&numbers.first().ok_or(Error::UndefinedHeader)?.to_string())?;
                held(self.is_on(index), index == 0, plant).to_string()
            }
            _ => return Err(Error::UndefinedHeader),
        })
    }

    fn is_on(&self, index: usize) -> bool {
        self.channels[index].on && self.general
    }
}

fn index(text: &str) -> Result<usize, Error> {
    match text.parse() {
        Ok(number @ 1..=4) => Ok(number - 1),
        Ok(_) => Err(Error::OutOfRange),
        Err(_) => Err(Error::DataType),
    }
}

/// A set value, absolute or by a step.
fn level(text: &str, unit: &str, now: f64, step: f64, most: f64, grain: f64) -> Result<f64, Error> {
    let wanted = match text.to_ascii_uppercase().as_str() {
        "UP" => (now + step).min(most),
        "DOWN" => (now - step).max(0.0),
        _ => number(text, unit, (0.0, most))?,
    };
    Ok((wanted / grain).round() * grain)
}

impl LineFirmware for Hmp {
    /// Longer than the lines of any client.
    const LONGEST_LINE: usize = 1024;

    fn line(&mut self, line: &str, plant: &Plant) -> Option<String> {
        let mut replies = Vec::new();
        for unit in units(line.trim()) {
            let before = self.wanted();
            match self.execute(&unit, plant) {
                Ok(Some(reply)) => replies.push(reply),
                Ok(None) => {}
                Err(error) => self.status.push(error),
            }
            self.output.pass_on(before, self.wanted(), plant);
        }
        (!replies.is_empty()).then(|| replies.join(";"))
    }

    fn step(&mut self, plant: &mut Plant) {
        self.output.step(&mut self.channels[0], plant);
    }

    fn trouble(&mut self) -> &mut Trouble {
        &mut self.trouble
    }

    fn restart(&mut self, plant: &mut Plant) {
        *self = Self::new();
        plant.inputs.coil = None;
    }
}
