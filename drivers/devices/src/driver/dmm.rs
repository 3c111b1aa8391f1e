//! A SCPI multimeter on the analogue output of a torque sensor, for a sensor without a digital interface.

use super::{Recovers, common_answers, same};
use crate::protocol::scpi::{ClearStatus, Identify, ReadVoltage, Set, Terminator};
use crate::transport::{Command, Link, PortSettings};
use jointbench_instrument::roles::{Identity, Instrument, TorqueSensor};
use jointbench_instrument::units::NewtonMetres;
use jointbench_instrument::{Fault, FaultKind};
use serde::{Deserialize, Serialize};
use std::time::Duration;

/// Output voltage at the nominal torque. Voltages beyond it are invalid.
const NOMINAL_V: f64 = 10.0;
/// 6½ digits in the 10 V range.
const STEP_V: f64 = 1e-5;

/// Connection of a multimeter, and the scale of the sensor's analogue output.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DmmSettings {
    /// Name in the bench description (role or own name).
    pub name: String,
    /// Port and line speed.
    pub port: PortSettings,
    /// Longest time for a reply.
    pub deadline_ms: u64,
    /// Torque at 10 V.
    pub nominal_nm: f64,
}

/// Torque of a sensor whose analogue output a SCPI multimeter measures.
pub struct DmmTorqueSensor {
    settings: DmmSettings,
    link: Link,
    line_end: Terminator,
    identity: Option<Identity>,
}

impl DmmTorqueSensor {
    /// Opens the port, identifies the multimeter and sets it to DC volts, range 10 V.
    pub fn open(settings: DmmSettings) -> Result<Self, Fault> {
        let link = Link::open(&settings.name, &settings.port, Duration::from_millis(settings.deadline_ms))?;
        let line_end = Terminator::for_address(&settings.port.address);
        let mut sensor = Self { settings, link, line_end, identity: None };
        sensor.ready()?;
        Ok(sensor)
    }
}

impl Recovers for DmmTorqueSensor {
    fn link(&mut self) -> &mut Link {
        &mut self.link
    }

    fn drain_and_identify(&mut self) -> Result<Identity, Fault> {
        let mut clear = b"\n".to_vec();
        ClearStatus(self.line_end).encode(&mut clear);
        self.link.drain(&clear, false)?;
        let found = self.link.probe(&Identify(self.line_end))?;
        let identity = same(&mut self.link, &mut self.identity, found)?;
        // Configured on every identification, because earlier settings are unknown or lost with the power.
        self.link.probe(&Set(self.line_end, "CONF:VOLT:DC 10".into(), "\n"))?;
        Ok(identity)
    }
}

impl Instrument for DmmTorqueSensor {
    common_answers!();

    fn identify(&mut self) -> Result<Identity, Fault> {
        let line_end = self.line_end;
        let found = self.ready()?.request(&Identify(line_end))?;
        same(&mut self.link, &mut self.identity, found)
    }
}

impl TorqueSensor for DmmTorqueSensor {
    fn read(&mut self) -> Result<NewtonMetres, Fault> {
        let line_end = self.line_end;
        match self.ready()?.request(&ReadVoltage(line_end))? {
            Some(volts) if volts.abs() < NOMINAL_V => Ok(NewtonMetres(volts / NOMINAL_V * self.settings.nominal_nm)),
            beyond => {
                let shown = beyond.map_or("overload".into(), |volts| format!("{volts} V"));
                let what = format!(
                    "{shown}: the output range of the sensor is ±{NOMINAL_V} V, ±{} Nm",
                    self.settings.nominal_nm
                );
                Err(self.link.fault(FaultKind::Saturated { what }))
            }
        }
    }

    fn range(&self) -> NewtonMetres {
        NewtonMetres(self.settings.nominal_nm)
    }

    fn resolution(&self) -> Option<NewtonMetres> {
        Some(NewtonMetres(STEP_V / NOMINAL_V * self.settings.nominal_nm))
    }
}
