//! An ODrive as the joint's controller. Axis 0 drives the motor; the encoder input of axis 1 may read the link encoder.

use super::{Recovers, common_answers, same};
use crate::protocol::odrive::{
    CLOSED_LOOP, ClearErrors, FeedWatchdog, Feedback, IDLE, Part, ReadErrors, ReadFeedback, ReadInfo, ReadNumber,
    RequestState, Set, SetTorque, SetVelocity, TorqueOff,
};
use crate::transport::{Link, PortSettings};
use jointbench_instrument::clock::between;
use jointbench_instrument::roles::{DriveHealth, Identity, Instrument, JointController, JointReading, JointResolution};
use jointbench_instrument::units::{Amperes, Celsius, RadPerSec, Radians, Volts};
use jointbench_instrument::{Clock, Fault, FaultKind};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;
use std::sync::Arc;
use std::time::Duration;

/// Replies have a resolution of 10⁻⁶ turns.
const MICRO_TURN_RAD: f64 = TAU * 1e-6;
/// The drive disarms by itself after this time without a set-point.
const WATCHDOG_S: f64 = 0.25;
/// Longest time for the drive to close its loop.
const ARMING_S: f64 = 0.5;
/// Period of the drive's control loop (8 kHz). A reply contains the encoder estimate of its last cycle.
const ESTIMATES_EVERY_S: f64 = 125e-6;
const VELOCITY_MODE: f64 = 2.0;
/// Set-points are applied directly, without the ramp of the drive.
const PASSTHROUGH: f64 = 1.0;

/// Source of the temperature that the drive reports.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Thermistor {
    /// In the joint (`axis0.motor.motor_thermistor`).
    Motor,
    /// On the drive's power stage (`axis0.motor.fet_thermistor`).
    PowerStage,
}

/// Connection of an ODrive, and its wiring.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OdriveSettings {
    /// Name in the bench description.
    pub name: String,
    /// Port and line speed.
    pub port: PortSettings,
    /// Longest time for a reply.
    pub deadline_ms: u64,
    /// The link encoder is wired to the encoder input of axis 1.
    pub link_encoder: bool,
    /// `None`: the drive measures no temperature.
    pub thermistor: Option<Thermistor>,
}

/// Set-point in the units of the drive.
#[derive(Debug, Clone, Copy, PartialEq)]
enum SetPoint {
    Velocity { turns_s: f64, torque_nm: f64 },
    Torque(f64),
}

/// A joint whose motor an ODrive (firmware 0.5) controls.
pub struct OdriveJoint {
    settings: OdriveSettings,
    link: Link,
    clock: Arc<dyn Clock>,
    identity: Option<Identity>,
    /// The confirmed set-point of the drive, with its time on the bench clock.
    held: Option<(SetPoint, f64)>,
    /// Torque per ampere in the drive's configuration, read when it is armed.
    torque_constant_nm_per_a: f64,
    armed: bool,
}

impl OdriveJoint {
    /// Opens the port and identifies the drive. Sends no command.
    pub fn open(settings: OdriveSettings, clock: Arc<dyn Clock>) -> Result<Self, Fault> {
        let link = Link::open(&settings.name, &settings.port, Duration::from_millis(settings.deadline_ms))?;
        let mut joint =
            Self { settings, link, clock, identity: None, held: None, torque_constant_nm_per_a: 0.0, armed: false };
        joint.identify()?;
        Ok(joint)
    }

    fn set(&mut self, path: &'static str, value: f64) -> Result<(), Fault> {
        self.link.request(&Set { path, value }).map(|_| ())
    }

    /// Every set-point is read back. An unchanged set-point is sent again only as often as the watchdog needs it.
    fn hold(&mut self, wanted: SetPoint) -> Result<(), Fault> {
        let (first, second) = match wanted {
            SetPoint::Velocity { turns_s, torque_nm } => (turns_s, torque_nm),
            SetPoint::Torque(torque_nm) => (torque_nm, 0.0),
        };
        if !(first.is_finite() && second.is_finite()) {
            let what = format!("set-point {wanted:?}: expected finite numbers");
            return Err(self.link.fault(FaultKind::Refused { what }));
        }
        let now_s = self.clock.now_s();
        self.ready()?;
        if self.held.is_some_and(|(held, since_s)| held == wanted && now_s - since_s < WATCHDOG_S / 4.0) {
            return Ok(());
        }
        self.held = None;
        match wanted {
            SetPoint::Velocity { turns_s, torque_nm } => self.link.request(&SetVelocity { turns_s, torque_nm })?,
            SetPoint::Torque(torque_nm) => self.link.request(&SetTorque { torque_nm })?,
        };
        self.held = Some((wanted, now_s));
        Ok(())
    }

    fn errors(&mut self) -> Result<Vec<String>, Fault> {
        let link = self.ready()?;
        let mut errors = Vec::new();
        for part in Part::ALL {
            errors.extend(link.request(&ReadErrors(part))?.names(part));
        }
        Ok(errors)
    }

    fn state(&mut self) -> Result<f64, Fault> {
        self.ready()?.request(&ReadNumber { path: "axis0.current_state" })
    }

    /// Waits on the bench's clock until the axis is in `state`.
    fn reach(&mut self, state: f64, request: &str) -> Result<(), Fault> {
        let deadline_s = self.clock.now_s() + ARMING_S;
        while self.state()? != state {
            let errors = self.errors()?;
            let refused = if !errors.is_empty() && state != IDLE {
                format!("{request}: {}", errors.join(", "))
            } else if self.clock.now_s() >= deadline_s {
                format!("{request}: not completed after {ARMING_S} s")
            } else {
                self.clock.sleep_until_s(self.clock.now_s() + 1e-3);
                continue;
            };
            return Err(self.link.fault(FaultKind::Refused { what: refused }));
        }
        Ok(())
    }
}

impl Recovers for OdriveJoint {
    fn link(&mut self) -> &mut Link {
        &mut self.link
    }

    fn drain_and_identify(&mut self) -> Result<Identity, Fault> {
        self.held = None;
        // Ends an incomplete line; its error reply is discarded with the rest.
        self.link.drain(b"\n", true)?;
        let found = self.link.probe(&ReadInfo)?;
        let identity = same(&mut self.link, &mut self.identity, found)?;
        // After a power-up positions have another zero, so readings from before and after must not be mixed.
        if self.armed && self.link.probe(&ReadNumber { path: "axis0.current_state" })? != CLOSED_LOOP {
            self.armed = false;
            let what = "the drive disarmed: interrupted by its supply or its watchdog".into();
            return Err(self.link.fault(FaultKind::Reported { what }));
        }
        Ok(identity)
    }
}

impl Instrument for OdriveJoint {
    common_answers!();

    fn identify(&mut self) -> Result<Identity, Fault> {
        let found = self.ready()?.request(&ReadInfo)?;
        same(&mut self.link, &mut self.identity, found)
    }
}

impl JointController for OdriveJoint {
    /// The speed limit becomes the drive's `vel_limit`, which trips at 1.2 times its value in every mode and reduces
    /// the torque in torque mode. At the bench limit it does not affect measurements.
    fn arm(&mut self, speed_limit: RadPerSec, current_limit: Amperes) -> Result<(), Fault> {
        if self.state()? != IDLE {
            self.disarm()?;
            self.reach(IDLE, "stand down")?;
        }
        self.set("axis0.controller.config.control_mode", VELOCITY_MODE)?;
        self.set("axis0.controller.config.input_mode", PASSTHROUGH)?;
        self.set("axis0.controller.config.vel_limit", speed_limit.0 / TAU)?;
        self.set("axis0.motor.config.current_lim", current_limit.0)?;
        self.torque_constant_nm_per_a =
            self.link.request(&ReadNumber { path: "axis0.motor.config.torque_constant" })?;
        // Set-points survive a disarm, so an old one would move the joint immediately.
        self.set("axis0.controller.input_torque", 0.0)?;
        self.set_velocity(RadPerSec(0.0))?;
        self.set("axis0.config.watchdog_timeout", WATCHDOG_S)?;
        self.link.send(&FeedWatchdog)?;
        self.set("axis0.config.enable_watchdog", 1.0)?;
        self.link.send(&ClearErrors)?;
        let errors = self.errors()?;
        if !errors.is_empty() {
            return Err(self.link.fault(FaultKind::Reported { what: errors.join(", ") }));
        }
        self.link.send(&RequestState(CLOSED_LOOP))?;
        self.reach(CLOSED_LOOP, "close the velocity loop")?;
        self.armed = true;
        Ok(())
    }

    fn set_velocity_fed(&mut self, velocity: RadPerSec, current: Amperes) -> Result<(), Fault> {
        let torque_nm = current.0 * self.torque_constant_nm_per_a;
        self.hold(SetPoint::Velocity { turns_s: velocity.0 / TAU, torque_nm })
    }

    fn set_motor_current(&mut self, current: Amperes) -> Result<(), Fault> {
        self.hold(SetPoint::Torque(current.0 * self.torque_constant_nm_per_a))
    }

    fn read(&mut self) -> Result<JointReading, Fault> {
        let link_encoder = self.settings.link_encoder;
        self.ready()?;
        let asked_s = self.clock.now_s();
        let link = &mut self.link;
        let Feedback { position_micro_turns, velocity_micro_turns_s } = link.request(&ReadFeedback { axis: 0 })?;
        let link_position = match link_encoder {
            true => Some(link.request(&ReadFeedback { axis: 1 })?.position_micro_turns),
            false => None,
        };
        let current_a = link.request(&ReadNumber { path: "axis0.motor.current_control.Iq_measured" })?;
        let (at_s, uncertainty_s) = between(asked_s, self.clock.now_s());
        Ok(JointReading {
            at_s,
            uncertainty_s: uncertainty_s + ESTIMATES_EVERY_S,
            motor_position: Radians(position_micro_turns as f64 * MICRO_TURN_RAD),
            motor_velocity: RadPerSec(velocity_micro_turns_s as f64 * MICRO_TURN_RAD),
            motor_current: Amperes(current_a),
            link_position: link_position.map(|micro_turns| Radians(micro_turns as f64 * MICRO_TURN_RAD)),
        })
    }

    fn health(&mut self) -> Result<DriveHealth, Fault> {
        let armed = self.state()? == CLOSED_LOOP;
        let errors = self.errors()?;
        let bus_voltage = Some(Volts(self.link.request(&ReadNumber { path: "vbus_voltage" })?));
        let path = self.settings.thermistor.map(|thermistor| match thermistor {
            Thermistor::Motor => "axis0.motor.motor_thermistor.temperature",
            Thermistor::PowerStage => "axis0.motor.fet_thermistor.temperature",
        });
        let temperature = path.map(|path| self.link.request(&ReadNumber { path })).transpose()?.map(Celsius);
        Ok(DriveHealth { armed, errors, bus_voltage, temperature })
    }

    fn disarm(&mut self) -> Result<(), Fault> {
        self.held = None;
        self.armed = false;
        self.link.send(&TorqueOff { after_broken_line: !self.link.is_trusted() })
    }

    fn resolution(&self) -> JointResolution {
        JointResolution {
            motor_position: Some(Radians(MICRO_TURN_RAD)),
            motor_velocity: Some(RadPerSec(MICRO_TURN_RAD)),
            motor_current: Some(Amperes(1e-6)),
            link_position: self.settings.link_encoder.then_some(Radians(MICRO_TURN_RAD)),
            temperature: self.settings.thermistor.map(|_| Celsius(1e-6)),
        }
    }
}
