//! An Advantech ADAM-4015 with up to six resistance thermometers, over Modbus RTU.

use super::{Recovers, common_answers, same};
use crate::protocol::modbus::ReadRegisters;
use crate::transport::{Link, PortSettings};
use jointbench_instrument::roles::{Identity, Instrument, Thermometer};
use jointbench_instrument::units::Celsius;
use jointbench_instrument::{Fault, FaultKind};
use serde::{Deserialize, Serialize};
use std::time::Duration;

const CHANNELS: u8 = 6;
const VALUES: u16 = 0;
const TYPE_CODES: u16 = 200;
const MODULE_NAME: u16 = 210;
const ADAM_4015: u16 = 0x4015;

/// Connection of an Advantech ADAM-4015 (Modbus RTU).
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AdamSettings {
    /// Name in the bench description (role or own name).
    pub name: String,
    /// Port and line speed.
    pub port: PortSettings,
    /// Longest time for a reply.
    pub deadline_ms: u64,
    /// Address of the module; several modules may share one line.
    pub slave: u8,
    /// Channels in use, 0 to 5.
    pub channels: Vec<u8>,
}

/// Six platinum resistance thermometers behind an ADAM-4015 module.
pub struct AdamThermometer {
    settings: AdamSettings,
    link: Link,
    identity: Option<Identity>,
    /// Lowest and highest temperature of each channel in use.
    ranges_c: Vec<(f64, f64)>,
}

impl AdamThermometer {
    /// Opens the port, identifies the module and reads the configuration of its channels. Changes no setting.
    pub fn open(settings: AdamSettings) -> Result<Self, Fault> {
        let link = Link::open(&settings.name, &settings.port, Duration::from_millis(settings.deadline_ms))?;
        if let Some(channel) = settings.channels.iter().find(|channel| **channel >= CHANNELS) {
            let what = format!("channel {channel}: expected 0 to {}", CHANNELS - 1);
            return Err(link.fault(FaultKind::Refused { what }));
        }
        let mut thermometer = Self { settings, link, identity: None, ranges_c: Vec::new() };
        thermometer.ready()?;
        Ok(thermometer)
    }

    fn registers(&self, first: u16, count: u8) -> ReadRegisters {
        ReadRegisters { slave: self.settings.slave, first, count }
    }

    /// Identifies the module and reads the configuration of its channels.
    fn read_identity(&mut self) -> Result<Identity, Fault> {
        let name = self.link.probe(&self.registers(MODULE_NAME, 2))?;
        if name[0] != ADAM_4015 {
            let (expected, found) = ("ADAM 4015".into(), format!("module {:04X}", name[0]));
            return Err(self.link.fault(FaultKind::WrongInstrument { expected, found }));
        }
        let found = Identity {
            maker: "Advantech".into(),
            model: format!("ADAM-{:04X}", name[0]),
            // A module has no serial number.
            serial: format!("slave {}", self.settings.slave),
            firmware: String::new(),
        };
        let identity = same(&mut self.link, &mut self.identity, found)?;
        let codes = self.link.probe(&self.registers(TYPE_CODES, CHANNELS))?;
        let range = |channel: &u8| {
            let code = codes[usize::from(*channel)];
            range_c(code).ok_or_else(|| {
                let what = format!("channel {channel} has type code {code:02X}, which is no resistance thermometer");
                self.link.fault(FaultKind::Reported { what })
            })
        };
        self.ranges_c = self.settings.channels.iter().map(range).collect::<Result<_, _>>()?;
        Ok(identity)
    }
}

/// The temperatures of the readings 0 and 65535, by type code (ADAM-4000 manual, table 5.2).
fn range_c(code: u16) -> Option<(f64, f64)> {
    Some(match code {
        0x20 | 0x25 => (-50.0, 150.0),
        0x21 | 0x26 => (0.0, 100.0),
        0x22 | 0x27 => (0.0, 200.0),
        0x23 | 0x28 => (0.0, 400.0),
        0x24 | 0x29 => (-200.0, 200.0),
        0x2A => (-40.0, 160.0),
        0x2B => (-30.0, 120.0),
        0x2C => (-80.0, 100.0),
        0x2D | 0x30 | 0x31 => (0.0, 100.0),
        0x33 => (-50.0, 200.0),
        _ => return None,
    })
}

impl Recovers for AdamThermometer {
    fn link(&mut self) -> &mut Link {
        &mut self.link
    }

    fn drain_and_identify(&mut self) -> Result<Identity, Fault> {
        // Silence ends a frame, so nothing has to be sent.
        self.link.drain(b"", false)?;
        self.read_identity()
    }
}

impl Instrument for AdamThermometer {
    common_answers!();

    fn identify(&mut self) -> Result<Identity, Fault> {
        if self.link.is_trusted() { self.read_identity() } else { self.resume() }
    }
}

impl Thermometer for AdamThermometer {
    fn read(&mut self) -> Result<Vec<Celsius>, Fault> {
        let request = self.registers(VALUES, CHANNELS);
        let values = self.ready()?.request(&request)?;
        let temperature = |(channel, (low_c, high_c)): (&u8, &(f64, f64))| match values[usize::from(*channel)] {
            // A broken wire reads as the end of the range.
            0 | u16::MAX => {
                let what =
                    format!("channel {channel} is at the end of {low_c} to {high_c} °C: a broken sensor, or too hot");
                Err(self.link.fault(FaultKind::Saturated { what }))
            }
            raw => Ok(Celsius(low_c + (high_c - low_c) * f64::from(raw) / f64::from(u16::MAX))),
        };
        self.settings.channels.iter().zip(&self.ranges_c).map(temperature).collect()
    }

    fn resolution(&self) -> Celsius {
        let widest_c = self.ranges_c.iter().map(|(low_c, high_c)| high_c - low_c).fold(0.0, f64::max);
        Celsius(widest_c / f64::from(u16::MAX))
    }
}
