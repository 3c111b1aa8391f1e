//! A Rigol DP821A, channel 1 on a brake's coil (DP800 programming guide PGH03109-1110, data sheet DSH03108-1110).

use super::dp800_channel::{Channel, Protection};
use super::dp800_commands::{COMMANDS, Command, Quantity};
use super::lines::LineFirmware;
use super::scpi::{Error, Status, Unit, number, units};
use super::supply_output::{self, CoilOutput, held, measured};
use crate::sim::plant::Plant;
use crate::sim::trouble::Trouble;

pub struct Dp800 {
    channels: [Channel; 2],
    selected: usize,
    status: Status,
    output: CoilOutput,
    trouble: Trouble,
}

impl Dp800 {
    pub fn new() -> Self {
        Self {
            channels: [Channel::new("CH1:60V/1A", 63.0, 1.05), Channel::new("CH2:8V/10A", 8.4, 10.5)],
            selected: 0,
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
            return self.common(&common.to_ascii_uppercase(), unit, plant);
        }
        let found = COMMANDS.iter().find_map(|(pattern, command)| Some((*command, pattern.matches(&header)?)));
        let (command, numbers) = found.ok_or(Error::UndefinedHeader)?;
        if self.trouble == Trouble::Refusing && !matches!(command, Command::SystemError) {
            return Err(Error::Execution);
        }
        let before = self.channels[0].wanted();
        let reply = if unit.query {
            self.query(command, unit, &numbers, plant).map(Some)
        } else {
            self.set(command, unit, &numbers).map(|()| None)
        };
        self.output.pass_on(before, self.channels[0].wanted(), plant);
        reply
    }

    fn common(&mut self, command: &str, unit: &Unit, plant: &Plant) -> Result<Option<String>, Error> {
        let text = |text: &str| Ok(Some(text.to_owned()));
        match (command, unit.query) {
            ("*IDN", true) if self.trouble == Trouble::Exchanged => {
                text("RIGOL TECHNOLOGIES,DP821A,DP8E204500999,00.01.16")
            }
            ("*IDN", true) => text("RIGOL TECHNOLOGIES,DP821A,DP8E204500123,00.01.16"),
            ("*OPT", true) => text("0,0,0,0,0"),
            ("*RST", false) => {
                let before = self.channels[0].wanted();
                self.channels = Self::new().channels;
                self.selected = 0;
                self.output.pass_on(before, None, plant);
                Ok(None)
            }
            _ => self.status.common(command, unit),
        }
    }

    /// The channel that a `CH1` parameter, a `SOUR1` suffix or the selection names, and the parameters after it.
    fn channel<'a>(&self, unit: &'a Unit, numbers: &[u32]) -> Result<(usize, &'a [String]), Error> {
        let index = |number: u32| match number {
            1 | 2 => Ok(number as usize - 1),
            _ => Err(Error::OutOfRange),
        };
        if let Some((first, rest)) = unit.parameters.split_first()
            && let Some(number) = first.to_ascii_uppercase().strip_prefix("CH")
        {
            return Ok((index(number.parse().map_err(|_| Error::DataType)?)?, rest));
        }
        let index = numbers.first().map_or(Ok(self.selected), |number| index(*number))?;
        Ok((index, &unit.parameters))
    }

    fn set(&mut self, command: Command, unit: &Unit, numbers: &[u32]) -> Result<(), Error> {
        let (index, parameters) = self.channel(unit, numbers)?;
        let first = || parameters.first().ok_or(Error::Missing);
        let Channel { most_v, most_a, .. } = self.channels[index];
        let volts = |text: &str| number(text, "V", (0.0, most_v)).map(|v| (v * 1e3).round() / 1e3);
        let amperes = |text: &str| number(text, "A", (0.0, most_a)).map(|a| (a * 1e4).round() / 1e4);
        let channel = &mut self.channels[index];
        match command {
            Command::SystemControl => {}
            Command::SelectName => self.selected = index,
            Command::SelectNumber => match first()?.as_str() {
                "1" => self.selected = 0,
                "2" => self.selected = 1,
                _ => return Err(Error::OutOfRange),
            },
            Command::Voltage => channel.voltage_v = volts(first()?)?,
            Command::Current => channel.current_a = amperes(first()?)?,
            Command::Apply => {
                let voltage_v = volts(first()?)?;
                if let Some(text) = parameters.get(1) {
                    channel.current_a = amperes(text)?;
                }
                channel.voltage_v = voltage_v;
            }
            Command::Output => {
                let on = switch(first()?)?;
                if on && (channel.over_voltage.tripped || channel.over_current.tripped) {
                    return Err(Error::IllegalValue);
                }
                channel.on = on;
            }
            Command::ProtectionValue(quantity) => {
                let (unit, most) = if quantity == Quantity::Voltage { ("V", most_v) } else { ("A", most_a) };
                channel.protection(quantity).value = number(first()?, unit, (0.0, 1.05 * most))?;
            }
            Command::ProtectionState(quantity) => channel.protection(quantity).enabled = switch(first()?)?,
            Command::ProtectionClear(quantity) => channel.protection(quantity).tripped = false,
            _ => return Err(Error::UndefinedHeader),
        }
        Ok(())
    }

    fn query(&mut self, command: Command, unit: &Unit, numbers: &[u32], plant: &Plant) -> Result<String, Error> {
        let (index, parameters) = self.channel(unit, numbers)?;
        let measured = measured(self.free_v(index), plant);
        let tripped = |protection: Protection| if protection.tripped { "YES" } else { "NO" }.to_owned();
        let on_off = |on| if on { "ON" } else { "OFF" }.to_owned();
        let selected = self.selected;
        let channel = &mut self.channels[index];
        let limit = |value: f64, most: f64| match parameters.first().map(|p| p.to_ascii_uppercase()).as_deref() {
            None => Ok(value),
            Some("MIN" | "MINIMUM") => Ok(0.0),
            Some("MAX" | "MAXIMUM") => Ok(most),
            Some(_) => Err(Error::NotAllowed),
        };
        Ok(match command {
            Command::SystemError => self.status.pop(),
            Command::SystemVersion => "1999.0".into(),
            Command::SelectNumber => (selected + 1).to_string(),
            Command::SelectName => format!("CH{}", selected + 1),
            Command::Voltage => format!("{:.3}", limit(channel.voltage_v, channel.most_v)?),
            Command::Current => format!("{:.4}", limit(channel.current_a, channel.most_a)?),
            Command::Apply => format!("{},{:.3},{:.4}", channel.label, channel.voltage_v, channel.current_a),
            Command::Output => on_off(channel.on),
            Command::Mode => match held(channel.on, index == 0, plant) {
                1 => "CC".into(),
                2 => "CV".into(),
                _ => "UR".into(),
            },
            Command::ProtectionValue(quantity) => format!("{:.3}", channel.protection(quantity).value),
            Command::ProtectionState(quantity) => on_off(channel.protection(quantity).enabled),
            Command::ProtectionTripped(quantity) => tripped(*channel.protection(quantity)),
            Command::Measure(Some(Quantity::Current)) => format!("{:.4}", measured.1),
            Command::Measure(_) => format!("{:.4}", measured.0),
            Command::MeasurePower => format!("{:.4}", measured.0 * measured.1),
            Command::MeasureAll => format!("{:.4},{:.4},{:.4}", measured.0, measured.1, measured.0 * measured.1),
            Command::Condition => {
                // Here the suffix of ISUMmary names the channel.
                let trips = u32::from(channel.over_voltage.tripped) << 2 | u32::from(channel.over_current.tripped) << 3;
                (held(channel.on, index == 0, plant) | trips).to_string()
            }
            _ => return Err(Error::UndefinedHeader),
        })
    }

    /// Voltage of channel 2, which is not wired.
    fn free_v(&self, index: usize) -> Option<f64> {
        (index > 0).then(|| if self.channels[index].on { self.channels[index].voltage_v } else { 0.0 })
    }
}

fn switch(text: &str) -> Result<bool, Error> {
    supply_output::switch(text).ok_or(Error::IllegalValue)
}

impl LineFirmware for Dp800 {
    /// Longer than the lines of any client.
    const LONGEST_LINE: usize = 1024;

    fn line(&mut self, line: &str, plant: &Plant) -> Option<String> {
        let mut replies = Vec::new();
        for unit in units(line.trim()) {
            match self.execute(&unit, plant) {
                Ok(Some(reply)) => replies.push(reply),
                Ok(None) => {}
                Err(error) => self.status.push(error),
            }
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
