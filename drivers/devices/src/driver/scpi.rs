//! A Rigol DP800, R&S HMP or Kepco BOP supply as the current source of a brake's coil: channel 1, current regulated.

use super::{Recovers, common_answers, same};
use crate::protocol::scpi::{
    ClearStatus, Dialect, ERROR_QUEUE_DEPTH, Identify, QueryError, QueryFlag, QueryNumber, ReadCondition, ReadMeasured,
    Set, SwitchOff, Terminator,
};
use crate::transport::{Command, Link, PortSettings};
use jointbench_instrument::roles::{CurrentSource, Identity, Instrument, Regulation, SupplyReading};
use jointbench_instrument::units::{Amperes, Volts};
use jointbench_instrument::{Fault, FaultKind};
use serde::{Deserialize, Serialize};
use std::time::Duration;

/// Connection of a supply; the model is taken from its identity.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ScpiSettings {
    /// Name in the bench description (role or own name).
    pub name: String,
    /// Port and line speed.
    pub port: PortSettings,
    /// Longest time for a reply.
    pub deadline_ms: u64,
}

/// Channel 1 of a supply, which feeds the coil of a brake.
pub struct ScpiSource {
    settings: ScpiSettings,
    link: Link,
    line_end: Terminator,
    /// Determined from the identity.
    dialect: Dialect,
    identity: Option<Identity>,
    /// The output was switched on and not switched off since.
    on: bool,
}

impl ScpiSource {
    /// Opens the port and identifies the supply. Sends no command.
    pub fn open(settings: ScpiSettings) -> Result<Self, Fault> {
        let link = Link::open(&settings.name, &settings.port, Duration::from_millis(settings.deadline_ms))?;
        let line_end = Terminator::for_address(&settings.port.address);
        let mut source = Self { settings, link, line_end, dialect: Dialect::Dp800, identity: None, on: false };
        source.ready()?;
        Ok(source)
    }

    /// Sends a command and reads the error queue. Reports all its entries and empties it.
    fn set(&mut self, command: String) -> Result<(), Fault> {
        let line_end = self.line_end;
        self.ready()?;
        let set = Set(line_end, command, self.dialect.separator());
        let Err(mut fault) = self.link.request(&set) else { return Ok(()) };
        if let FaultKind::Refused { what } = &mut fault.kind {
            for _ in 0..ERROR_QUEUE_DEPTH {
                match self.link.probe(&QueryError(line_end)) {
                    Ok(Some(entry)) => *what = format!("{what}; {entry}"),
                    _ => break,
                }
            }
        }
        Err(fault)
    }

    fn set_and_read_back(&mut self, [header, query]: [&'static str; 2], value: f64, step: f64) -> Result<(), Fault> {
        if !value.is_finite() || value < 0.0 {
            let what = format!("{header} {value}: expected a finite number from 0 upwards");
            return Err(self.link.fault(FaultKind::Refused { what }));
        }
        self.set(format!("{header} {value:.4}"))?;
        let held = self.link.request(&QueryNumber(self.line_end, query))?;
        if (held - value).abs() > 0.51 * step + 1e-9 {
            let what = format!("{query} reads {held} after {value} was set: the command was not accepted");
            return Err(self.link.fault(FaultKind::Reported { what }));
        }
        Ok(())
    }

    /// A supply that is off without a trip or a command has lost its state, or is another supply.
    fn still_on(&mut self, on: bool) -> Result<(), Fault> {
        if std::mem::replace(&mut self.on, on) && !on {
            let found = self.link.probe(&Identify(self.line_end))?;
            same(&mut self.link, &mut self.identity, found)?;
            let what = "the output is off without a command: mains power of the supply was interrupted".into();
            return Err(self.link.fault(FaultKind::Reported { what }));
        }
        Ok(())
    }

    fn output(&mut self, on: bool) -> Result<(), Fault> {
        self.set(self.dialect.output(on).into())?;
        self.read_back(on)
    }

    fn read_back(&mut self, on: bool) -> Result<(), Fault> {
        if self.is_on()? != on {
            let what = format!("the output does not go {}", if on { "on" } else { "off" });
            return Err(self.link.fault(FaultKind::Reported { what }));
        }
        Ok(())
    }

    fn is_on(&mut self) -> Result<bool, Fault> {
        for query in self.dialect.output_queries() {
            if !self.link.probe(&QueryFlag(self.line_end, query))? {
                return Ok(false);
            }
        }
        Ok(true)
    }
}

impl Recovers for ScpiSource {
    fn link(&mut self) -> &mut Link {
        &mut self.link
    }

    fn drain_and_identify(&mut self) -> Result<Identity, Fault> {
        // An unknown query is never answered, so reading again does not help: drain, clear, identify.
        let mut clear = b"\n".to_vec();
        ClearStatus(self.line_end).encode(&mut clear);
        self.link.drain(&clear, false)?;
        let found = self.link.probe(&Identify(self.line_end))?;
        let Some(dialect) = Dialect::of(&found) else {
            let (expected, found) =
                ("Rigol DP8xx, R&S HMP or Kepco BOP".into(), format!("{} {}", found.maker, found.model));
            return Err(self.link.fault(FaultKind::WrongInstrument { expected, found }));
        };
        self.dialect = dialect;
        let identity = same(&mut self.link, &mut self.identity, found)?;
        let on = self.on && self.is_on()?;
        self.still_on(on)?;
        Ok(identity)
    }
}

impl Instrument for ScpiSource {
    common_answers!();

    fn identify(&mut self) -> Result<Identity, Fault> {
        let line_end = self.line_end;
        let found = self.ready()?.request(&Identify(line_end))?;
        same(&mut self.link, &mut self.identity, found)
    }
}

impl CurrentSource for ScpiSource {
    fn prepare(&mut self, compliance: Volts) -> Result<(), Fault> {
        self.on = false;
        self.set(self.dialect.remote().into())?;
        self.output(false)?;
        if let Some(mode) = self.dialect.current_mode() {
            self.set(mode.into())?;
        }
        self.set_current(Amperes(0.0))?;
        self.set_and_read_back(self.dialect.voltage(), compliance.0, self.dialect.voltage_step_v())?;
        self.output(true)?;
        self.on = true;
        Ok(())
    }

    fn set_current(&mut self, current: Amperes) -> Result<(), Fault> {
        self.set_and_read_back(self.dialect.current(), current.0, self.dialect.current_step_a())
    }

    fn read(&mut self) -> Result<SupplyReading, Fault> {
        let (line_end, dialect) = (self.line_end, self.dialect);
        let link = self.ready()?;
        let measured = link.request(&ReadMeasured(line_end, dialect))?;
        let condition = link.request(&ReadCondition(line_end, dialect))?;
        if condition.over_voltage_trip || condition.over_current_trip {
            let what = if condition.over_voltage_trip { "over-voltage" } else { "over-current" };
            return Err(link.fault(FaultKind::Reported { what: format!("{what} protection has tripped") }));
        }
        let regulation = match (condition.constant_current, condition.constant_voltage) {
            (true, false) => Regulation::ConstantCurrent,
            (false, true) => Regulation::ConstantVoltage,
            (true, true) => Regulation::Unregulated,
            (false, false) => Regulation::Off,
        };
        let on = regulation != Regulation::Off || self.is_on()?;
        self.still_on(self.on && on)?;
        Ok(SupplyReading { current: Amperes(measured.current_a), voltage: Volts(measured.voltage_v), regulation })
    }

    fn output_off(&mut self) -> Result<(), Fault> {
        // The command is sent first, in any state of the link. Then its effect is verified.
        self.command_off()?;
        match self.output(false) {
            // The supply that answers feeds the coil, even if it is another one. It may have another dialect.
            Err(Fault { kind: FaultKind::WrongInstrument { .. }, .. }) => {
                self.command_off()?;
                self.read_back(false)
            }
            result => result,
        }
    }

    fn command_off(&mut self) -> Result<(), Fault> {
        self.on = false;
        self.link.send(&SwitchOff(self.line_end, self.dialect))
    }

    fn resolution(&self) -> Option<Amperes> {
        Some(Amperes(self.dialect.current_step_a()))
    }
}
