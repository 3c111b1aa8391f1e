//! What an instrument can be for a bench. Narrow on purpose: a role holds what every instrument of its kind can do.
//!
//! Calls block until the instrument has answered or its deadline has passed; none blocks for ever. After a missed or
//! garbled reply a driver returns the fault; the caller may [`Instrument::recover`] and try again.

use crate::units::{Amperes, Celsius, NewtonMetres, RadPerSec, Radians, Seconds, Volts};
use crate::{Clock, Fault};
use serde::{Deserialize, Serialize};
use std::path::Path;
use std::sync::Arc;

/// Who answers on a port.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Identity {
    pub maker: String,
    pub model: String,
    pub serial: String,
    pub firmware: String,
}

pub trait Instrument: Send {
    /// The name in the bench description (`joint`, `brake_a`).
    fn name(&self) -> &str;
    fn port(&self) -> &str;
    fn identify(&mut self) -> Result<Identity, Fault>;
    /// Drains the link and identifies the instrument again. Nothing is commanded.
    fn recover(&mut self) -> Result<Identity, Fault> {
        self.identify()
    }
    /// Writes all traffic down in a new file from now on; `None` ends the record. Where there is no wire there is nothing to
    /// record.
    fn record(&mut self, _file: Option<&Path>) -> Result<(), Fault> {
        Ok(())
    }
}

/// One reading of a joint, taken together. Positions and velocity in output units of the encoders: motor side, link side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointReading {
    /// The middle of the reading on the bench's clock.
    pub at_s: f64,
    /// No part of it was taken further from there.
    pub uncertainty_s: f64,
    pub motor_position: Radians,
    pub motor_velocity: RadPerSec,
    pub motor_current: Amperes,
    /// Where a link encoder is wired to the controller.
    pub link_position: Option<Radians>,
}

/// The state of a drive, as it reports it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DriveHealth {
    pub armed: bool,
    pub errors: Vec<String>,
    /// Where the drive measures it.
    pub bus_voltage: Option<Volts>,
    pub temperature: Option<Celsius>,
}

/// Drives the joint under test.
pub trait JointController: Instrument {
    /// Sets limits and watchdog, zeroes the set-points and closes the velocity loop.
    fn arm(&mut self, speed_limit: RadPerSec, current_limit: Amperes) -> Result<(), Fault>;
    /// Motor-side velocity set-point.
    fn set_velocity(&mut self, velocity: RadPerSec) -> Result<(), Fault> {
        self.set_velocity_fed(velocity, Amperes(0.0))
    }
    /// The same with a motor current fed forward: added to what the velocity loop asks for.
    fn set_velocity_fed(&mut self, velocity: RadPerSec, current: Amperes) -> Result<(), Fault>;
    /// Motor current set-point, without a velocity loop: the joint goes where load and friction let it.
    fn set_motor_current(&mut self, current: Amperes) -> Result<(), Fault>;
    fn read(&mut self) -> Result<JointReading, Fault>;
    fn health(&mut self) -> Result<DriveHealth, Fault>;
    /// Drive torque off. Returns when the command is on the wire; [`JointController::health`] tells whether it took effect.
    fn disarm(&mut self) -> Result<(), Fault>;
    /// The smallest steps of the readings.
    fn resolution(&self) -> JointResolution;
    /// Whether the drive takes a motor current beside a velocity.
    fn feeds_forward(&self) -> bool {
        true
    }
    /// Motor current for each volt, where the drive reads it as the voltage at a shunt.
    fn amperes_per_volt(&self) -> Option<f64> {
        None
    }
    /// The memory of its processor, where the drive lets it be read.
    fn servo_memory(&mut self) -> Option<&mut dyn ServoMemory> {
        None
    }
}

/// Reads the memory of a drive's processor. Commands nothing.
pub trait ServoMemory: Instrument {
    fn read_byte(&mut self, address: u8) -> Result<u8, Fault>;
}

/// The smallest steps that a joint controller can report.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointResolution {
    pub motor_position: Option<Radians>,
    pub motor_velocity: Option<RadPerSec>,
    pub motor_current: Option<Amperes>,
    pub link_position: Option<Radians>,
    pub temperature: Option<Celsius>,
}

/// Feels the torque between the joint and its load.
pub trait TorqueSensor: Instrument {
    fn read(&mut self) -> Result<NewtonMetres, Fault>;
    /// Whether the sensor has another range beside the one in use.
    fn has_two_ranges(&self) -> bool {
        false
    }
    /// The same with the other range's word for the same moment, where there is one.
    fn read_both(&mut self) -> Result<(NewtonMetres, Option<NewtonMetres>), Fault> {
        Ok((self.read()?, None))
    }
    /// Full scale of the range in use; a reading beyond it is a fault, never a number.
    fn range(&self) -> NewtonMetres;
    fn resolution(&self) -> Option<NewtonMetres>;
    /// The same sensor sending by itself, where it can.
    fn as_stream(&mut self) -> Option<&mut dyn TorqueStream> {
        None
    }
}

/// One sample of a torque stream.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TorqueSample {
    /// Counted from 0 at the start of the stream; lost samples count.
    pub number: u64,
    /// When it was taken, on the bench's clock, as its number tells.
    pub at_s: f64,
    /// How far [`TorqueSample::at_s`] may be off, either way.
    pub uncertainty_s: f64,
    /// In the range in use; `None`: beyond it.
    pub torque: Option<NewtonMetres>,
    /// The sensor's other range's word for the same moment; `None`: beyond that.
    pub other: Option<NewtonMetres>,
}

/// Feels torque at the pace of its own clock. While a stream runs single readings are refused.
pub trait TorqueStream: Instrument {
    /// Starts at the period nearest to `period` that the sensor has, and returns it.
    fn start_stream(&mut self, period: Seconds, clock: Arc<dyn Clock>) -> Result<Seconds, Fault>;
    /// The samples since the last call, in order. After those before a gap comes [`crate::FaultKind::StreamGap`], then
    /// those behind it. Any other fault ends the stream. May wait for up to a period, to see how old the newest sample is.
    fn collect(&mut self) -> Result<Vec<TorqueSample>, Fault>;
    fn stop_stream(&mut self) -> Result<(), Fault>;
}

/// How a supply holds its output.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Regulation {
    ConstantCurrent,
    ConstantVoltage,
    Unregulated,
    Off,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SupplyReading {
    pub current: Amperes,
    pub voltage: Volts,
    pub regulation: Regulation,
}

/// Feeds the coil of a brake.
pub trait CurrentSource: Instrument {
    /// Output off, current zero, compliance voltage set and read back, then output on.
    fn prepare(&mut self, compliance: Volts) -> Result<(), Fault>;
    fn set_current(&mut self, current: Amperes) -> Result<(), Fault>;
    fn read(&mut self) -> Result<SupplyReading, Fault>;
    /// Output off. The coil current decays with its own time constant.
    fn output_off(&mut self) -> Result<(), Fault>;
    /// The same for a supply that answers no more: the command is on the wire when this returns, and nothing is waited for.
    fn command_off(&mut self) -> Result<(), Fault>;
    fn resolution(&self) -> Option<Amperes>;
}

/// One reading of a counter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CounterReading {
    /// Moment of the reading on the bench's clock.
    pub at_s: f64,
    /// How far it may be off, either way.
    pub uncertainty_s: f64,
    pub position: Radians,
    /// The counter's own time stamp, in its own units.
    pub stamp: u32,
}

/// Counts the periods of an incremental encoder.
pub trait PositionCounter: Instrument {
    /// The position is 0 here.
    fn zero(&mut self) -> Result<(), Fault>;
    /// Looks for the encoder's index while the shaft turns: begins with the first call, and tells by `true`, once, that it was
    /// passed. From there on the position is 0 at the index; readings before it mean nothing.
    fn seek_index(&mut self) -> Result<bool, Fault>;
    fn read(&mut self) -> Result<CounterReading, Fault>;
    fn resolution(&self) -> Radians;
    /// `None`: nobody has wired the encoder's own status to this counter.
    fn status(&mut self) -> Option<&mut dyn EncoderStatus>;
}

/// Takes the power of one of a bench's instruments away and gives it back.
pub trait PowerSwitch: Send {
    /// Returns when it is back; the instrument may need a moment more until it answers, and says that its state is lost.
    fn cycle(&mut self, instrument: &str) -> Result<(), Fault>;
}

/// Tells whether a magnetic encoder's sensor sits well enough on its ring to count its periods.
pub trait EncoderStatus: Instrument {
    fn periods_are_consistent(&mut self) -> Result<bool, Fault>;
}

/// Feels temperatures.
pub trait Thermometer: Instrument {
    /// One for each channel that is in use, in the order of the bench description.
    fn read(&mut self) -> Result<Vec<Celsius>, Fault>;
    fn resolution(&self) -> Celsius;
}

/// Where a six-axis stage stands: shifts along x, y, z, then rotations about them.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Pose {
    pub shift_m: [f64; 3],
    pub rotation_rad: [f64; 3],
}

/// Holds a sensor in a pose.
pub trait AlignmentStage: Instrument {
    /// Begins to find the axes' zeros, which takes seconds. Without it no pose can be taken.
    fn reference(&mut self) -> Result<(), Fault>;
    fn is_referenced(&mut self) -> Result<bool, Fault>;
    /// Sets off; a pose that cannot be reached is refused, and nothing moves.
    fn move_to(&mut self, pose: Pose) -> Result<(), Fault>;
    fn pose(&mut self) -> Result<Pose, Fault>;
    /// On target, and settled.
    fn is_settled(&mut self) -> Result<bool, Fault>;
    /// At once, also in the middle of a reference move.
    fn stop(&mut self) -> Result<(), Fault>;
}
