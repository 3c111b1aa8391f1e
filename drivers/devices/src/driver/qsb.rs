//! An incremental encoder behind a US Digital QSB counter.

use super::{Recovers, common_answers, same};
use crate::protocol::qsb::{ReadRegister, Register, StopStreams, Version, WriteRegister};
use crate::transport::{Command, Link, PortSettings};
use jointbench_instrument::clock::between;
use jointbench_instrument::roles::{CounterReading, EncoderStatus, Identity, Instrument, PositionCounter};
use jointbench_instrument::units::Radians;
use jointbench_instrument::{Clock, Fault, FaultKind};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;
use std::sync::Arc;
use std::time::Duration;

/// Four counts per period, free-running over 32 bits, index ignored. The factory setting wraps at 500 counts.
const FREE_RUNNING_X4: u32 = 0x03;
/// The same, but each passage of the index sets the count to 0.
const ZERO_AT_INDEX: u32 = FREE_RUNNING_X4 | 0x60;
const DOWNWARDS: u32 = 1 << 8;
const CLEAR_COUNT: u32 = 2;
const CLEAR_STATUS: u32 = 3;
const POWER_WAS_LOST: u32 = 1 << 2;
const INDEX_WAS_PASSED: u32 = 1 << 4;

/// Connection of a US Digital QSB, and its encoder.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct QsbSettings {
    /// Name in the bench description (role or own name).
    pub name: String,
    /// Port and line speed.
    pub port: PortSettings,
    /// Longest time for a reply.
    pub deadline_ms: u64,
    /// After the quadrature factor of four: 16384 for 14 bits.
    pub counts_per_turn: u32,
    /// The counter counts in the opposite direction.
    #[serde(default)]
    pub reversed: bool,
    /// Digital input that is wired to the encoder's status output. High: the periods are consistent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub status_input: Option<u8>,
}

/// An incremental encoder, counted by a QSB.
pub struct QsbCounter {
    settings: QsbSettings,
    link: Link,
    clock: Arc<dyn Clock>,
    identity: Option<Identity>,
    configured: bool,
    seeks_index: bool,
    /// The last raw count, and the count without the wraps at 32 bits.
    last: u32,
    total: i64,
}

impl QsbCounter {
    /// Opens the port, identifies the counter and configures its counting mode. The count is kept.
    pub fn open(settings: QsbSettings, clock: Arc<dyn Clock>) -> Result<Self, Fault> {
        let link = Link::open(&settings.name, &settings.port, Duration::from_millis(settings.deadline_ms))?;
        if settings.counts_per_turn == 0 {
            let what = "counts_per_turn = 0: expected the counts of one turn, four for each line".into();
            return Err(link.fault(FaultKind::Refused { what }));
        }
        let (identity, configured, seeks_index) = (None, false, false);
        let mut counter = Self { settings, link, clock, identity, configured, seeks_index, last: 0, total: 0 };
        counter.ready()?;
        Ok(counter)
    }

    fn configure(&mut self) -> Result<(), Fault> {
        let direction = if self.settings.reversed { DOWNWARDS } else { 0 };
        for (register, value) in [
            (Register::Mode, 0),
            (Register::CounterMode, FREE_RUNNING_X4),
            (Register::Direction, direction),
            (Register::Clear, CLEAR_STATUS),
        ] {
            self.link.probe(&WriteRegister(register, value))?;
        }
        let value = self.link.probe(&ReadRegister(Register::Encoder))?;
        self.count_from(value);
        (self.configured, self.seeks_index) = (true, false);
        Ok(())
    }

    /// Identity of the counter, and whether it still has its position reference.
    fn read_identity(&mut self) -> Result<Identity, Fault> {
        let version = Version::from(self.link.probe(&ReadRegister(Register::Version))?);
        let found = Identity {
            maker: "US Digital".into(),
            model: format!("QSB-{}", version.variant),
            serial: format!("{:05X}", version.serial),
            firmware: version.firmware.to_string(),
        };
        let identity = same(&mut self.link, &mut self.identity, found)?;
        let lost = self.link.probe(&ReadRegister(Register::Status))? & POWER_WAS_LOST != 0;
        if self.configured && !lost {
            return Ok(identity);
        }
        let had_counted = std::mem::take(&mut self.configured);
        self.configure()?;
        if had_counted {
            let what = "its power was interrupted: it counts from 0, and its position reference is lost";
            return Err(self.link.fault(FaultKind::Reported { what: what.into() }));
        }
        Ok(identity)
    }

    fn count_from(&mut self, value: u32) {
        (self.last, self.total) = (value, i64::from(value as i32));
    }

    fn read_register(&mut self, register: Register) -> Result<u32, Fault> {
        self.ready()?.request(&ReadRegister(register))
    }
}

impl Recovers for QsbCounter {
    fn link(&mut self) -> &mut Link {
        &mut self.link
    }

    fn drain_and_identify(&mut self) -> Result<Identity, Fault> {
        let mut request = Vec::new();
        StopStreams.encode(&mut request);
        self.link.drain(&request, true)?;
        self.read_identity()
    }
}

impl Instrument for QsbCounter {
    common_answers!();

    fn identify(&mut self) -> Result<Identity, Fault> {
        if self.link.is_trusted() { self.read_identity() } else { self.resume() }
    }
}

impl PositionCounter for QsbCounter {
    fn zero(&mut self) -> Result<(), Fault> {
        self.ready()?.request(&WriteRegister(Register::Clear, CLEAR_COUNT))?;
        (self.last, self.total) = (0, 0);
        Ok(())
    }

    fn seek_index(&mut self) -> Result<bool, Fault> {
        if !self.seeks_index {
            self.ready()?.request(&WriteRegister(Register::Clear, CLEAR_STATUS))?;
            self.ready()?.request(&WriteRegister(Register::CounterMode, ZERO_AT_INDEX))?;
            self.seeks_index = true;
            return Ok(false);
        }
        if self.read_register(Register::Status)? & INDEX_WAS_PASSED == 0 {
            return Ok(false);
        }
        self.ready()?.request(&WriteRegister(Register::CounterMode, FREE_RUNNING_X4))?;
        self.seeks_index = false;
        let value = self.read_register(Register::Encoder)?;
        self.count_from(value);
        Ok(true)
    }

    fn read(&mut self) -> Result<CounterReading, Fault> {
        self.ready()?;
        let asked_s = self.clock.now_s();
        let value = self.read_register(Register::Encoder)?;
        let (at_s, uncertainty_s) = between(asked_s, self.clock.now_s());
        // Differences are correct across the wrap at 32 bits.
        self.total += i64::from(value.wrapping_sub(self.last) as i32);
        self.last = value;
        let turns = self.total as f64 / f64::from(self.settings.counts_per_turn);
        Ok(CounterReading { at_s, uncertainty_s, position: Radians(TAU * turns) })
    }

    fn resolution(&self) -> Radians {
        Radians(TAU / f64::from(self.settings.counts_per_turn))
    }

    fn status(&mut self) -> Option<&mut dyn EncoderStatus> {
        self.settings.status_input?;
        Some(self)
    }
}

impl EncoderStatus for QsbCounter {
    fn periods_are_consistent(&mut self) -> Result<bool, Fault> {
        let Some(input) = self.settings.status_input else {
            let what = "status_input is missing: enter the digital input that is wired to the status output of the \
                        encoder";
            return Err(self.link.fault(FaultKind::Refused { what: what.into() }));
        };
        let inputs = self.read_register(Register::DigitalInputs)?;
        Ok(inputs.checked_shr(input.into()).unwrap_or(0) & 1 == 1)
    }
}
