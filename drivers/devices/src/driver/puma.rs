//! One axis of a Puma-type servo as the joint's controller.
//!
//! The servo accepts positions. Each velocity command is converted to a position set-point, which the servo reaches
//! `ninter` ticks later. If commands arrive faster, the joint follows smoothly with a small delay. The servo reports no
//! velocity: it is the position difference of two readings over their time difference.

use super::{Recovers, common_answers, same};
use crate::protocol::puma::{
    ArmPower, Clear, CurrentMode, DiagRead, DiagWrite, Fact, Identify, Limit, MOST_COUNTS, Numbered, Order,
    PositionMode, ReadCurrent, ReadPosition, ReadStatus, Reply, SetInterval, Stop, VOLTS_PER_COUNT, interval,
    intervals, memory,
};
use crate::transport::{Command, Link, PortSettings};
use jointbench_instrument::clock::between;
use jointbench_instrument::roles::{
    DriveHealth, Identity, Instrument, JointController, JointReading, JointResolution, ServoMemory, SetpointInterval,
};
use jointbench_instrument::units::{Amperes, RadPerSec, Radians};
use jointbench_instrument::{Clock, Fault, FaultKind};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;
use std::sync::Arc;
use std::time::Duration;

/// Longest time for the servo to switch its arm power on.
const ARMING_S: f64 = 1.0;
/// Time between the two positions of a first velocity.
const VELOCITY_SPAN_S: f64 = 0.02;
/// The servo switches arm power off after a longer time without a request, so a set-point covers at most this time.
const LONGEST_GAP_S: f64 = 0.25;

/// Connection of a Puma servo, and the scales of its axis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PumaSettings {
    /// Name in the bench description.
    pub name: String,
    /// Port and line speed.
    pub port: PortSettings,
    /// Longest time for a reply.
    pub deadline_ms: u64,
    /// Counts per turn of the motor encoder, four per line.
    pub counts_per_turn: u32,
    /// Motor current per volt at the A/D converter.
    pub amperes_per_volt: f64,
    /// Clock ticks of 0.875 ms between set-points, a power of two: at least the time between two commands of the bench.
    pub ninter: u8,
    /// Gains that the driver writes when it arms the servo.
    #[serde(default)]
    pub gains: PumaGains,
}

/// Gains that are written when the servo is armed. `None`: the servo keeps its own value.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PumaGains {
    /// Proportional gain.
    pub propgan: Option<u8>,
    /// Velocity gain.
    pub velgan: Option<u8>,
    /// Scale factor of the control output.
    pub outscl: Option<u8>,
    /// Encoder counts.
    pub postol: Option<u16>,
    /// Encoder counts.
    pub inttol: Option<u16>,
}

impl PumaGains {
    /// Addresses and bytes to write.
    fn written(self) -> impl Iterator<Item = (u8, u8)> {
        let bytes = [
            (memory::PROPORTIONAL_GAIN, self.propgan),
            (memory::VELOCITY_GAIN, self.velgan),
            (memory::OUTPUT_SCALE, self.outscl),
        ];
        let words = [(memory::POSITION_TOLERANCE, self.postol), (memory::INTEGRAL_TOLERANCE, self.inttol)];
        let of_word = |(address, word): (u8, Option<u16>)| {
            word.into_iter().flat_map(move |word| (address..).zip(word.to_le_bytes()))
        };
        let of_byte = |(address, byte): (u8, Option<u8>)| byte.map(|byte| (address, byte));
        bytes.into_iter().filter_map(of_byte).chain(words.into_iter().flat_map(of_word))
    }
}

/// The last command to the servo.
#[derive(Debug, Clone, Copy, PartialEq)]
enum LastCommand {
    Nothing,
    /// Target position, commanded velocity and time of the command.
    Position {
        counts: f64,
        velocity_rad_s: f64,
        at_s: f64,
    },
    Current,
}

/// The latest position, unwrapped.
#[derive(Debug, Clone, Copy, PartialEq)]
struct LastPosition {
    at_s: f64,
    counts: i64,
    velocity_rad_s: f64,
}

/// A joint that the servo of a Puma axis controls.
pub struct PumaAxis {
    settings: PumaSettings,
    link: Link,
    clock: Arc<dyn Clock>,
    identity: Option<Identity>,
    number: u8,
    armed: bool,
    last_command: LastCommand,
    last_position: Option<LastPosition>,
}

impl PumaAxis {
    /// Opens the port and identifies the servo. Sends no command.
    pub fn open(settings: PumaSettings, clock: Arc<dyn Clock>) -> Result<Self, Fault> {
        let link = Link::open(&settings.name, &settings.port, Duration::from_millis(settings.deadline_ms))?;
        let usable = settings.counts_per_turn > 0 && settings.amperes_per_volt > 0.0;
        if !usable {
            let what = "counts_per_turn and amperes_per_volt: expected numbers above 0".into();
            return Err(link.fault(FaultKind::Refused { what }));
        }
        if interval(settings.ninter).is_none() {
            let what = format!("ninter {}: expected {}", settings.ninter, intervals());
            return Err(link.fault(FaultKind::Refused { what }));
        }
        let (identity, last_command, last_position) = (None, LastCommand::Nothing, None);
        let mut axis = Self { settings, link, clock, identity, number: 0, armed: false, last_command, last_position };
        axis.identify()?;
        Ok(axis)
    }

    fn numbered<O: Order>(&mut self, order: O) -> Numbered<O> {
        self.number = self.number.wrapping_add(1);
        Numbered { number: self.number, order }
    }

    /// Sends an order in any state of the link.
    fn probe<O: Order>(&mut self, order: O) -> Result<Reply<O::Reply>, Fault> {
        let request = self.numbered(order);
        self.link.probe(&request)
    }

    /// Sends an order and reports a fault if the servo has lost its position reference.
    fn ask<O: Order>(&mut self, order: O) -> Result<O::Reply, Fault> {
        let request = self.numbered(order);
        let reply = self.ready()?.request(&request)?;
        if reply.fresh {
            self.probe(Clear)?;
            return Err(self.lost_power());
        }
        Ok(reply.value)
    }

    /// Identity of the servo, and whether its position reference is from a new power-up.
    fn facts(&mut self) -> Result<(Identity, bool), Fault> {
        let [arm, axis, serial, revision] =
            [Fact::Arm, Fact::Axis, Fact::Serial, Fact::Revision].map(|fact| self.probe(Identify(fact)));
        let (revision, fresh) = revision.map(|reply| (reply.value, reply.fresh))?;
        let identity = Identity {
            maker: "Unimation".into(),
            model: format!("Puma {:X}, axis {}", arm?.value, axis?.value),
            serial: serial?.value.to_string(),
            firmware: revision.to_string(),
        };
        Ok((identity, fresh))
    }

    fn lost_power(&mut self) -> Fault {
        (self.armed, self.last_command, self.last_position) = (false, LastCommand::Nothing, None);
        let what = "its power was interrupted: it is disarmed, and its position reference is lost";
        self.link.fault(FaultKind::Reported { what: what.into() })
    }

    fn step_rad(&self) -> f64 {
        TAU / f64::from(self.settings.counts_per_turn)
    }

    /// Reads the position once.
    fn read_position(&mut self) -> Result<LastPosition, Fault> {
        let at_s = self.clock.now_s();
        let word = self.ask(ReadPosition)?;
        let last_position = match self.last_position {
            None => LastPosition { at_s, counts: word.into(), velocity_rad_s: 0.0 },
            Some(before) => {
                let counts = before.counts + i64::from(word.wrapping_sub(before.counts as i16));
                let moved_rad = (counts - before.counts) as f64 * self.step_rad();
                let since_s = at_s - before.at_s;
                let velocity_rad_s = if since_s > 0.0 { moved_rad / since_s } else { before.velocity_rad_s };
                LastPosition { at_s, counts, velocity_rad_s }
            }
        };
        self.last_position = Some(last_position);
        Ok(last_position)
    }

    /// Verifies that the servo's memory contains the written byte.
    fn check(&mut self, address: u8, wanted: u8) -> Result<(), Fault> {
        let held = self.ask(DiagRead(address))?;
        if held == wanted {
            return Ok(());
        }
        let name = memory::at(address).map_or("memory", |variable| variable.name);
        let what = format!(
            "{name} at {address:#04X} = {wanted}, but its memory contains {held}: write a whole number that it accepts"
        );
        Err(self.link.fault(FaultKind::Refused { what }))
    }

    /// Converter counts of a current. A current beyond the range of the converter is refused.
    fn converter_counts(&self, current: Amperes) -> Result<i16, Fault> {
        let counts = (current.0 / self.settings.amperes_per_volt / VOLTS_PER_COUNT).round();
        if counts.abs() <= f64::from(MOST_COUNTS) {
            return Ok(counts as i16);
        }
        let most_a = f64::from(MOST_COUNTS) * VOLTS_PER_COUNT * self.settings.amperes_per_volt;
        let what = format!("{current}: the range of the servo's converter is {most_a:.1} A");
        Err(self.link.fault(FaultKind::Refused { what }))
    }
}

impl Recovers for PumaAxis {
    fn link(&mut self) -> &mut Link {
        &mut self.link
    }

    fn drain_and_identify(&mut self) -> Result<Identity, Fault> {
        let mut wake = Vec::new();
        self.numbered(ReadStatus).encode(&mut wake);
        self.link.drain(&wake, true)?;
        let (found, fresh) = self.facts()?;
        let was_known = self.identity.is_some();
        let identity = same(&mut self.link, &mut self.identity, found)?;
        if fresh {
            self.probe(Clear)?;
            if was_known {
                return Err(self.lost_power());
            }
        }
        if self.armed && !self.probe(ReadStatus)?.value.is_armed() {
            (self.armed, self.last_command) = (false, LastCommand::Nothing);
            let what = "the servo disarmed and switched arm power off".into();
            return Err(self.link.fault(FaultKind::Reported { what }));
        }
        Ok(identity)
    }
}

impl Instrument for PumaAxis {
    common_answers!();

    fn identify(&mut self) -> Result<Identity, Fault> {
        self.ready()?;
        let (found, _) = self.facts()?;
        same(&mut self.link, &mut self.identity, found)
    }
}

impl JointController for PumaAxis {
    /// The servo has no speed limit: the guard of the bench must monitor the speed.
    fn arm(&mut self, _speed_limit: RadPerSec, current_limit: Amperes) -> Result<(), Fault> {
        let ninter = self.settings.ninter;
        let limit = self.converter_counts(current_limit)?;
        self.armed = false;
        self.ask(Stop)?;
        self.ask(Clear)?;
        self.ask(SetInterval(ninter))?;
        self.check(memory::INTERVAL, ninter)?;
        for (address, byte) in self.settings.gains.written() {
            self.ask(DiagWrite { address, byte })?;
            self.check(address, byte)?;
        }
        self.ask(Limit(limit))?;
        self.ask(ArmPower)?;
        let deadline_s = self.clock.now_s() + ARMING_S;
        while !self.ask(ReadStatus)?.is_armed() {
            let errors = self.ask(ReadStatus)?.errors();
            if !errors.is_empty() || self.clock.now_s() >= deadline_s {
                let what = format!("arm power is not on after {ARMING_S} s: {}", errors.join(", "));
                return Err(self.link.fault(FaultKind::Refused { what }));
            }
            self.clock.sleep_until_s(self.clock.now_s() + 1e-2);
        }
        self.last_command = LastCommand::Nothing;
        self.armed = true;
        self.set_velocity(RadPerSec(0.0))
    }

    fn set_velocity_fed(&mut self, velocity: RadPerSec, current: Amperes) -> Result<(), Fault> {
        if !velocity.0.is_finite() || current.0 != 0.0 {
            let what = format!("{velocity} with {current} fed forward: this servo takes positions, or a current alone");
            return Err(self.link.fault(FaultKind::Refused { what }));
        }
        let at_s = self.clock.now_s();
        // After current mode the motion starts from the present position.
        let (from, since_s, before_rad_s) = match self.last_command {
            LastCommand::Position { counts, velocity_rad_s, at_s: commanded_s } => {
                (counts, at_s - commanded_s, velocity_rad_s)
            }
            LastCommand::Nothing | LastCommand::Current => (self.read_position()?.counts as f64, 0.0, velocity.0),
        };
        let mean_rad_s = 0.5 * (before_rad_s + velocity.0);
        let counts = from + mean_rad_s * since_s.min(LONGEST_GAP_S) / self.step_rad();
        // The word wraps like the encoder counter.
        self.ask(PositionMode(counts.round() as i64 as i16))?;
        self.last_command = LastCommand::Position { counts, velocity_rad_s: velocity.0, at_s };
        Ok(())
    }

    fn set_motor_current(&mut self, current: Amperes) -> Result<(), Fault> {
        let counts = self.converter_counts(current)?;
        self.last_command = LastCommand::Current;
        self.ask(CurrentMode(counts))
    }

    fn read(&mut self) -> Result<JointReading, Fault> {
        if self.last_position.is_none() {
            self.read_position()?;
            self.clock.sleep_until_s(self.clock.now_s() + VELOCITY_SPAN_S);
        }
        let asked_s = self.clock.now_s();
        let LastPosition { counts, velocity_rad_s, .. } = self.read_position()?;
        let volts = self.ask(ReadCurrent)?;
        let (at_s, uncertainty_s) = between(asked_s, self.clock.now_s());
        Ok(JointReading {
            at_s,
            uncertainty_s,
            motor_position: Radians(counts as f64 * self.step_rad()),
            motor_velocity: RadPerSec(velocity_rad_s),
            motor_current: Amperes(volts.0 * self.settings.amperes_per_volt),
            link_position: None,
        })
    }

    fn health(&mut self) -> Result<DriveHealth, Fault> {
        let status = self.ask(ReadStatus)?;
        Ok(DriveHealth { armed: status.is_armed(), errors: status.errors(), bus_voltage: None, temperature: None })
    }

    fn disarm(&mut self) -> Result<(), Fault> {
        (self.armed, self.last_command) = (false, LastCommand::Nothing);
        let stop = self.numbered(Stop);
        if self.link.is_trusted() { self.link.request(&stop).map(drop) } else { self.link.send(&stop) }
    }

    fn resolution(&self) -> JointResolution {
        JointResolution {
            motor_position: Some(Radians(self.step_rad())),
            motor_velocity: None,
            motor_current: Some(Amperes(VOLTS_PER_COUNT * self.settings.amperes_per_volt)),
            link_position: None,
            temperature: None,
        }
    }

    /// The servo accepts positions, or a current alone.
    fn feeds_forward(&self) -> bool {
        false
    }

    fn amperes_per_volt(&self) -> Option<f64> {
        Some(self.settings.amperes_per_volt)
    }

    fn setpoint_interval(&self) -> Option<SetpointInterval> {
        interval(self.settings.ninter)
    }

    fn servo_memory(&mut self) -> Option<&mut dyn ServoMemory> {
        Some(self)
    }
}

impl ServoMemory for PumaAxis {
    fn read_byte(&mut self, address: u8) -> Result<u8, Fault> {
        self.ask(DiagRead(address))
    }
}
