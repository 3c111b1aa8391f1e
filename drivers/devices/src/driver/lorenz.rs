//! A rotating torque sensor with two ranges behind a Lorenz telegram interface.

use super::lorenz_stream::Stream;
use super::{Recovers, common_answers, same};
use crate::protocol::lorenz::{Hello, NOMINAL_COUNTS, ReadConfig, ReadRaw, ReadStatusShort, StopStream, nack_text};
use crate::transport::{Command, Link, PortSettings};
use jointbench_instrument::roles::{Identity, Instrument, TorqueSensor, TorqueStream};
use jointbench_instrument::units::NewtonMetres;
use jointbench_instrument::{Fault, FaultKind};
use serde::{Deserialize, Serialize};
use std::time::Duration;

/// Configuration block of the stator: type and serial number.
const STATOR_HEADER: u8 = 0;

/// One of the two channels of a dual-range sensor.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Range {
    /// Channel A: the full range of the shaft.
    Coarse,
    /// Channel B: the small range.
    Fine,
}

/// Connection of a Lorenz sensor, and the range in use.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LorenzSettings {
    /// Name in the bench description (role or own name).
    pub name: String,
    /// Port and line speed.
    pub port: PortSettings,
    /// Longest time for a reply.
    pub deadline_ms: u64,
    /// Range whose torque is reported; the other one is read with it.
    pub range: Range,
    /// Nominal torque of the channel that [`LorenzSettings::range`] selects.
    pub nominal_nm: f64,
}

/// A Lorenz torque sensor: single readings and the stream of both ranges.
pub struct LorenzSensor {
    pub(super) settings: LorenzSettings,
    pub(super) link: Link,
    pub(super) stream: Option<Stream>,
    identity: Option<Identity>,
    /// Full scale of the coarse and the fine range, after the rotor was read.
    nominals_nm: Option<[f64; 2]>,
}

impl LorenzSensor {
    /// Opens the port, ends a stream that may run, and identifies the sensor.
    pub fn open(settings: LorenzSettings) -> Result<Self, Fault> {
        let link = Link::open(&settings.name, &settings.port, Duration::from_millis(settings.deadline_ms))?;
        let mut sensor = Self { settings, link, stream: None, identity: None, nominals_nm: None };
        sensor.ready()?;
        Ok(sensor)
    }

    fn read_identity(&mut self) -> Result<Identity, Fault> {
        self.link.probe(&Hello)?;
        let header = self.link.probe(&ReadConfig { block: STATOR_HEADER })?;
        let status = self.link.probe(&ReadStatusShort)?;
        if status != 0 {
            return Err(self.link.fault(FaultKind::Reported { what: nack_text(status) }));
        }
        let found = Identity {
            maker: "Lorenz Messtechnik".into(),
            model: format!("stator type {:06X}", header.number::<3>(1)),
            serial: header.number::<4>(4).to_string(),
            firmware: String::new(),
        };
        same(&mut self.link, &mut self.identity, found)
    }

    fn nm_per_count(&self) -> f64 {
        self.settings.nominal_nm / f64::from(NOMINAL_COUNTS)
    }

    /// Counts of the coarse and the fine range at the same moment.
    fn counts(&mut self) -> Result<[i16; 2], Fault> {
        if self.stream.is_some() {
            let what = "a single reading is not possible while the stream runs: collect samples, or stop the stream";
            return Err(self.link.fault(FaultKind::Refused { what: what.into() }));
        }
        let reading = self.ready()?.request(&ReadRaw)?;
        if reading.check_signal {
            let what = "the 100 % check signal is active: unload the shaft and switch it off";
            return Err(self.link.fault(FaultKind::Reported { what: what.into() }));
        }
        Ok(reading.calibrated)
    }

    fn torque(&self, counts: i16, nominal_nm: f64) -> Result<NewtonMetres, Fault> {
        if counts.unsigned_abs() >= NOMINAL_COUNTS.unsigned_abs() {
            let what = format!("{counts} counts, beyond ±{nominal_nm} Nm; use the larger range");
            return Err(self.link.fault(FaultKind::Saturated { what }));
        }
        Ok(NewtonMetres(f64::from(counts) / f64::from(NOMINAL_COUNTS) * nominal_nm))
    }
}

impl Range {
    /// Indices of the range in use and of the other range.
    pub(super) fn in_use_and_other(self) -> [usize; 2] {
        match self {
            Range::Coarse => [0, 1],
            Range::Fine => [1, 0],
        }
    }
}

impl Recovers for LorenzSensor {
    fn link(&mut self) -> &mut Link {
        &mut self.link
    }

    fn drain_and_identify(&mut self) -> Result<Identity, Fault> {
        self.stream = None;
        let mut stop = Vec::new();
        StopStream.encode(&mut stop);
        self.link.drain(&stop, false)?;
        self.read_identity()
    }
}

impl Instrument for LorenzSensor {
    common_answers!();

    /// Also ends a running stream.
    fn identify(&mut self) -> Result<Identity, Fault> {
        self.stop_stream()?;
        self.ready()?;
        self.read_identity()
    }
}

impl TorqueSensor for LorenzSensor {
    fn read(&mut self) -> Result<NewtonMetres, Fault> {
        let counts = self.counts()?;
        let [used, _] = self.settings.range.in_use_and_other();
        self.torque(counts[used], self.settings.nominal_nm)
    }

    fn has_two_ranges(&self) -> bool {
        true
    }

    fn read_both(&mut self) -> Result<(NewtonMetres, Option<NewtonMetres>), Fault> {
        let nominals_nm = match self.nominals_nm {
            Some(nominals_nm) => nominals_nm,
            None => self.nominals()?,
        };
        self.nominals_nm = Some(nominals_nm);
        let counts = self.counts()?;
        let [used, other] = self.settings.range.in_use_and_other();
        Ok((self.torque(counts[used], nominals_nm[used])?, Some(self.torque(counts[other], nominals_nm[other])?)))
    }

    fn range(&self) -> NewtonMetres {
        NewtonMetres(self.settings.nominal_nm)
    }

    fn resolution(&self) -> Option<NewtonMetres> {
        Some(NewtonMetres(self.nm_per_count()))
    }

    fn as_stream(&mut self) -> Option<&mut dyn TorqueStream> {
        Some(self)
    }
}
