//! A 34401A-class multimeter on the analogue output of the torque sensor's small range, 10 V for 20 Nm.

use super::lines::LineFirmware;
use super::scpi::{Error, Pattern, Status, number, units};
use crate::sim::plant::{Plant, Signal};
use crate::sim::trouble::Trouble;
use std::sync::LazyLock;

const NM_PER_V: f64 = 2.0;
const NOISE_V: f64 = 1e-4;
/// A range ends 20 % above its nominal value. SCPI has a number for values beyond.
const OVER_RANGE: f64 = 1.2;
const OVERLOAD: f64 = 9.9e37;
const RANGES_V: [f64; 5] = [0.1, 1.0, 10.0, 100.0, 1000.0];

#[derive(Debug, Clone, Copy)]
enum Command {
    Error,
    Configure,
    Measure,
    Read,
    Initiate,
    Fetch,
}

static COMMANDS: LazyLock<[(Pattern, Command); 6]> = LazyLock::new(|| {
    [
        (":SYSTem:ERRor[:NEXT]", Command::Error),
        (":CONFigure[:VOLTage][:DC]", Command::Configure),
        (":MEASure[:VOLTage][:DC]", Command::Measure),
        (":READ", Command::Read),
        (":INITiate[:IMMediate]", Command::Initiate),
        (":FETCh", Command::Fetch),
    ]
    .map(|(pattern, command)| (Pattern::new(pattern), command))
});

pub struct Dmm {
    range_v: f64,
    taken_v: Option<f64>,
    status: Status,
    trouble: Trouble,
}

impl Dmm {
    pub fn new() -> Self {
        Self { range_v: 10.0, taken_v: None, status: Status::power_on(), trouble: Trouble::None }
    }

    fn reading(&self, plant: &Plant) -> f64 {
        let volts = plant.sensor_torque_nm() / NM_PER_V + NOISE_V * plant.noise_of(Signal::Multimeter);
        if volts.abs() > OVER_RANGE * self.range_v { OVERLOAD.copysign(volts) } else { volts }
    }

    fn range(&mut self, parameters: &[String]) -> Result<(), Error> {
        let asked_v = parameters.first().map_or(Ok(10.0), |text| number(text, "V", (0.0, 1000.0)))?;
        self.range_v = *RANGES_V.iter().find(|range_v| asked_v <= **range_v).ok_or(Error::OutOfRange)?;
        Ok(())
    }

    fn execute(
        &mut self,
        header: &[&str],
        query: bool,
        parameters: &[String],
        plant: &Plant,
    ) -> Result<Option<String>, Error> {
        let serial = if self.trouble == Trouble::Exchanged { "999" } else { "0" };
        match (header, query) {
            (["*IDN"], true) => return Ok(Some(format!("HEWLETT-PACKARD,34401A,{serial},11-5-2"))),
            (["*OPC"], true) => return Ok(Some("1".into())),
            (["*ESR"], true) => return Ok(Some(std::mem::take(&mut self.status.events).to_string())),
            (["*CLS"], false) => {
                self.status.clear();
                return Ok(None);
            }
            (["*RST"], false) => {
                (self.range_v, self.taken_v) = (10.0, None);
                return Ok(None);
            }
            _ => {}
        }
        let found = COMMANDS.iter().find(|(pattern, _)| pattern.matches(header).is_some());
        let command = found.ok_or(Error::UndefinedHeader)?.1;
        if self.trouble == Trouble::Refusing && !matches!(command, Command::Error) {
            return Err(Error::Execution);
        }
        match (command, query) {
            (Command::Error, true) => return Ok(Some(self.status.pop())),
            (Command::Configure, false) => self.range(parameters)?,
            (Command::Initiate, false) => self.taken_v = Some(self.reading(plant)),
            (Command::Measure, true) => {
                self.range(parameters)?;
                return Ok(Some(exponential(self.reading(plant))));
            }
            (Command::Read, true) => return Ok(Some(exponential(self.reading(plant)))),
            (Command::Fetch, true) => return Ok(Some(exponential(self.taken_v.ok_or(Error::Execution)?))),
            _ => return Err(Error::UndefinedHeader),
        }
        Ok(None)
    }
}

/// `+1.23456789E+00`.
fn exponential(value: f64) -> String {
    let text = format!("{value:+.8E}");
    let (digits, exponent) = text.split_once('E').unwrap_or((&text, "0"));
    format!("{digits}E{:+03}", exponent.parse::<i32>().unwrap_or(0))
}

impl LineFirmware for Dmm {
    const LONGEST_LINE: usize = 512;

    fn line(&mut self, line: &str, plant: &Plant) -> Option<String> {
        let mut replies = Vec::new();
        for unit in units(line.trim()) {
            let header: Vec<&str> = unit.header.iter().map(String::as_str).collect();
            match self.execute(&header, unit.query, &unit.parameters, plant) {
                Ok(reply) => replies.extend(reply),
                Err(error) => self.status.push(error),
            }
        }
        (!replies.is_empty()).then(|| replies.join(";"))
    }

    fn trouble(&mut self) -> &mut Trouble {
        &mut self.trouble
    }

    fn restart(&mut self, _plant: &mut Plant) {
        *self = Self::new();
    }
}
