//! Instrument roles. They are narrow on purpose: a role contains only functions of every instrument of its kind.
//!
//! Calls block until the instrument has answered or its deadline has passed; no call blocks for ever. After a missing
//! or garbled reply a driver returns the fault. The caller may call [`Instrument::recover`] and try again.

use crate::units::{Amperes, Celsius, NewtonMetres, RadPerSec, Radians, Seconds, Volts};
use crate::{Clock, Fault, LatencyCounter};
use serde::{Deserialize, Serialize};
use std::path::Path;
use std::sync::Arc;

/// The instrument that answers on a port.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Identity {
    /// Manufacturer, as the instrument reports it.
    pub maker: String,
    /// Type designation.
    pub model: String,
    /// Serial number, as the instrument reports it.
    pub serial: String,
    /// Version of its firmware.
    pub firmware: String,
}

/// What every instrument of a bench can do.
pub trait Instrument: Send {
    /// The name in the bench description (`joint`, `brake_a`).
    fn name(&self) -> &str;
    /// The port at which it answers, as in the bench description.
    fn port(&self) -> &str;
    /// Asks the instrument for its identity. An instrument other than the expected one is a fault.
    fn identify(&mut self) -> Result<Identity, Fault>;
    /// Drains the link and identifies the instrument again. Sends no command.
    fn recover(&mut self) -> Result<Identity, Fault> {
        self.identify()
    }
    /// Records all traffic in a new file from now on; `None` ends the recording. An instrument without a wire records
    /// nothing.
    fn record(&mut self, _file: Option<&Path>) -> Result<(), Fault> {
        Ok(())
    }
    /// Counts the exchanges on its link. `None`: an instrument without a wire.
    fn latency_counter(&self) -> Option<Arc<LatencyCounter>> {
        None
    }
}

/// One reading of a joint, all values at one time. Each position and velocity is on the side of its encoder: motor or
/// link.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointReading {
    /// Midpoint of the reading on the bench clock.
    pub at_s: f64,
    /// Largest time difference between `at_s` and a part of the reading.
    pub uncertainty_s: f64,
    /// Angle of the motor shaft, counted over turns.
    pub motor_position: Radians,
    /// Angular velocity of the motor shaft.
    pub motor_velocity: RadPerSec,
    /// Torque-producing motor current i_q.
    pub motor_current: Amperes,
    /// `Some` if a link encoder is wired to the controller.
    pub link_position: Option<Radians>,
}

/// The state that a drive reports.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DriveHealth {
    /// The drive is armed: it follows its set-points.
    pub armed: bool,
    /// Active errors of the drive; empty if there are none.
    pub errors: Vec<String>,
    /// `Some` if the drive measures it.
    pub bus_voltage: Option<Volts>,
    /// `Some` if the drive measures the temperature of the joint or its motor.
    pub temperature: Option<Celsius>,
}

/// Controls the joint under test.
pub trait JointController: Instrument {
    /// Sets limits and watchdog, sets the set-points to zero and closes the velocity loop.
    fn arm(&mut self, speed_limit: RadPerSec, current_limit: Amperes) -> Result<(), Fault>;
    /// Motor-side velocity set-point.
    fn set_velocity(&mut self, velocity: RadPerSec) -> Result<(), Fault> {
        self.set_velocity_fed(velocity, Amperes(0.0))
    }
    /// Velocity set-point with a feed-forward motor current, which is added to the output of the velocity loop.
    fn set_velocity_fed(&mut self, velocity: RadPerSec, current: Amperes) -> Result<(), Fault>;
    /// Motor current set-point without a velocity loop: load and friction determine the motion of the joint.
    fn set_motor_current(&mut self, current: Amperes) -> Result<(), Fault>;
    /// One reading of all values of the joint.
    fn read(&mut self) -> Result<JointReading, Fault>;
    /// The state of the drive, from the drive.
    fn health(&mut self) -> Result<DriveHealth, Fault>;
    /// Switches the drive torque off. Returns when the command is sent; [`JointController::health`] shows whether it
    /// took effect.
    fn disarm(&mut self) -> Result<(), Fault>;
    /// The resolution of the readings.
    fn resolution(&self) -> JointResolution;
    /// Whether the drive accepts a feed-forward motor current in addition to a velocity.
    fn feeds_forward(&self) -> bool {
        true
    }
    /// Motor current per volt, if the drive measures it as the voltage at a shunt.
    fn amperes_per_volt(&self) -> Option<f64> {
        None
    }
    /// Interpolation of position set-points, if the drive accepts positions.
    fn setpoint_interval(&self) -> Option<SetpointInterval> {
        None
    }
    /// The memory of the drive's processor, if it is readable.
    fn servo_memory(&mut self) -> Option<&mut dyn ServoMemory> {
        None
    }
}

/// Reads the memory of a drive's processor. Sends no command.
pub trait ServoMemory: Instrument {
    /// One byte at an address of the processor's memory.
    fn read_byte(&mut self, address: u8) -> Result<u8, Fault>;
}

/// Interpolation of a drive that accepts positions: it reaches each set-point after a number of its clock ticks.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SetpointInterval {
    /// One tick of the drive's clock (s).
    pub tick_s: f64,
    /// Ticks until a set-point is reached.
    pub ticks: u8,
}

impl SetpointInterval {
    /// Fewer ticks between two commands have to be a whole number of them. Otherwise the number of ticks changes from
    /// command to command, and the speed with it. The mean of the current at the commands is then not the mean current:
    /// on the mock bench by 4 to 15 % of the viscous friction at 5.7 ticks, and by 1 % at 11.4 ticks.
    const FREE_TICKS: f64 = 10.0;

    /// Time until a set-point is reached (s).
    pub fn duration_s(&self) -> f64 {
        f64::from(self.ticks) * self.tick_s
    }

    /// The command rate closest to a wanted one that suits the ticks (Hz).
    pub fn suitable_rate_hz(&self, wanted_hz: f64) -> f64 {
        let ticks = 1.0 / (wanted_hz * self.tick_s);
        if ticks >= Self::FREE_TICKS {
            wanted_hz
        } else {
            1.0 / (ticks.round().clamp(1.0, self.ticks.into()) * self.tick_s)
        }
    }
}

/// The resolution of the readings of a joint controller.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointResolution {
    /// One count of the motor encoder.
    pub motor_position: Option<Radians>,
    /// Smallest step of the reported velocity.
    pub motor_velocity: Option<RadPerSec>,
    /// Smallest step of the reported current.
    pub motor_current: Option<Amperes>,
    /// One count of the link encoder, at the link.
    pub link_position: Option<Radians>,
    /// Smallest step of the reported temperature.
    pub temperature: Option<Celsius>,
}

/// Measures the torque between the joint and its load.
pub trait TorqueSensor: Instrument {
    /// The torque in the range in use, positive in the sensor's positive direction.
    fn read(&mut self) -> Result<NewtonMetres, Fault>;
    /// Whether the sensor has a second range in addition to the range in use.
    fn has_two_ranges(&self) -> bool {
        false
    }
    /// Reads the torque in both ranges at the same moment, if the sensor has two.
    fn read_both(&mut self) -> Result<(NewtonMetres, Option<NewtonMetres>), Fault> {
        Ok((self.read()?, None))
    }
    /// Full scale of the range in use. A reading beyond it is a fault, never a number.
    fn range(&self) -> NewtonMetres;
    /// One count of the converter; `None` if the sensor reports none.
    fn resolution(&self) -> Option<NewtonMetres>;
    /// The same sensor as a stream, if it can send without requests.
    fn as_stream(&mut self) -> Option<&mut dyn TorqueStream> {
        None
    }
}

/// One sample of a torque stream.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TorqueSample {
    /// Counted from 0 at the start of the stream, lost samples included.
    pub number: u64,
    /// Time of the sample on the bench clock, computed from its number.
    pub at_s: f64,
    /// Largest error of [`TorqueSample::at_s`], in either direction.
    pub uncertainty_s: f64,
    /// In the range in use; `None`: beyond full scale.
    pub torque: Option<NewtonMetres>,
    /// The same sample in the sensor's other range; `None`: beyond full scale.
    pub other: Option<NewtonMetres>,
}

/// Measures torque at the rate of the sensor's own clock. Single readings are refused while a stream runs.
pub trait TorqueStream: Instrument {
    /// Starts the stream with the available period that is nearest to `period`, and returns that period.
    fn start_stream(&mut self, period: Seconds, clock: Arc<dyn Clock>) -> Result<Seconds, Fault>;
    /// The samples since the last call, in order. A gap splits them: first the samples before it, then
    /// [`crate::FaultKind::StreamGap`], then the samples after it. Any other fault ends the stream. May wait up to one
    /// period to measure the age of the newest sample.
    fn collect(&mut self) -> Result<Vec<TorqueSample>, Fault>;
    /// Ends the stream; single readings are possible again.
    fn stop_stream(&mut self) -> Result<(), Fault>;
}

/// How a supply regulates its output.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Regulation {
    /// The output holds the set current.
    ConstantCurrent,
    /// The output has reached the compliance voltage, so that the current is below its set value.
    ConstantVoltage,
    /// Neither is held.
    Unregulated,
    /// The output is off.
    Off,
}

/// One reading of a supply.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SupplyReading {
    /// Current through the coil.
    pub current: Amperes,
    /// Voltage at the output.
    pub voltage: Volts,
    /// How the supply regulates its output.
    pub regulation: Regulation,
}

/// Supplies the coil of a brake.
pub trait CurrentSource: Instrument {
    /// Output off, current zero, compliance voltage set and read back, then output on.
    fn prepare(&mut self, compliance: Volts) -> Result<(), Fault>;
    /// Sets the current of the output, at least 0.
    fn set_current(&mut self, current: Amperes) -> Result<(), Fault>;
    /// Current, voltage and regulation, from the supply.
    fn read(&mut self) -> Result<SupplyReading, Fault>;
    /// Output off. The coil current decays with its own time constant.
    fn output_off(&mut self) -> Result<(), Fault>;
    /// Switches off a supply that no longer answers. Returns when the command is sent, without waiting for a reply.
    fn command_off(&mut self) -> Result<(), Fault>;
    /// Smallest step of the current; `None` if the supply states none.
    fn resolution(&self) -> Option<Amperes>;
}

/// One reading of a counter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CounterReading {
    /// Time of the reading on the bench clock.
    pub at_s: f64,
    /// Largest error of `at_s`, in either direction.
    pub uncertainty_s: f64,
    /// Angle from the counter's zero.
    pub position: Radians,
}

/// Counts the periods of an incremental encoder.
pub trait PositionCounter: Instrument {
    /// Sets the position to 0 at the present angle.
    fn zero(&mut self) -> Result<(), Fault>;
    /// Searches the index of the encoder while the shaft rotates. The first call starts the search. One call returns
    /// `true` when the index was passed. From then on the position is 0 at the index; earlier readings have no meaning.
    fn seek_index(&mut self) -> Result<bool, Fault>;
    /// The position with its time.
    fn read(&mut self) -> Result<CounterReading, Fault>;
    /// Angle of one count.
    fn resolution(&self) -> Radians;
    /// `None`: the encoder's own status is not wired to this counter.
    fn status(&mut self) -> Option<&mut dyn EncoderStatus>;
}

/// Switches the power of one instrument of a bench off and on again.
pub trait PowerSwitch: Send {
    /// Returns when the power is on again. The instrument may need more time to answer, and reports that its state is
    /// lost.
    fn cycle(&mut self, instrument: &str) -> Result<(), Fault>;
}

/// Reports whether the sensor of a magnetic encoder is aligned well enough with its ring to count the periods.
pub trait EncoderStatus: Instrument {
    /// The status output of the encoder. `true`: its sensor detects the periods of the ring consistently.
    fn periods_are_consistent(&mut self) -> Result<bool, Fault>;
}

/// Measures temperatures.
pub trait Thermometer: Instrument {
    /// One temperature per channel in use, in the order of the bench description.
    fn read(&mut self) -> Result<Vec<Celsius>, Fault>;
    /// Smallest step of a reading.
    fn resolution(&self) -> Celsius;
}

/// Position of a six-axis stage: shifts along x, y, z, then rotations about them.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Pose {
    /// Shift along x, y and z.
    pub shift_m: [f64; 3],
    /// Rotation about x, y and z.
    pub rotation_rad: [f64; 3],
}

/// Holds a sensor in a pose.
pub trait AlignmentStage: Instrument {
    /// Starts the search for the zeros of the axes, which takes seconds. A stage that is not referenced accepts no
    /// pose.
    fn reference(&mut self) -> Result<(), Fault>;
    /// The zeros of all axes are known.
    fn is_referenced(&mut self) -> Result<bool, Fault>;
    /// Starts the motion. A pose out of reach is refused, and nothing moves.
    fn move_to(&mut self, pose: Pose) -> Result<(), Fault>;
    /// The measured pose.
    fn pose(&mut self) -> Result<Pose, Fault>;
    /// On target and settled.
    fn is_settled(&mut self) -> Result<bool, Fault>;
    /// Stops immediately, also during a reference move.
    fn stop(&mut self) -> Result<(), Fault>;
}
