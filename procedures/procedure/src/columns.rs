//! The columns of a run table: those that a bench can fill, and one row of them.

use crate::column_names::{MOTOR_CURRENT_SETPOINT, OTHER_RANGE};
use crate::encoder_columns::{self, Encoders};
use crate::plan::Plan;
use jointbench_instrument::bench::JointConstants;
use jointbench_instrument::roles::{DriveHealth, JointReading, Pose};
use jointbench_instrument::skew::{BRAKE_SKEW, THERMOMETER_SKEW, TORQUE_SKEW};
use jointbench_instrument::{Bench, Channel, Kind, Trace};

/// Resolution of time in the table: finer than any serial instrument, and exact to store.
const TIME_STEP_S: f64 = 1e-6;
/// Resolution of commanded and stored velocity set-points.
pub(crate) const VELOCITY_STEP_RAD_S: f64 = 1e-4;

/// The torque of one tick.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TickTorque {
    pub nm: f64,
    /// Largest absolute value, if it is a mean of several samples.
    pub peak_nm: f64,
    /// In the sensor's other range, if the plan requires it.
    pub other_nm: Option<f64>,
    /// Delay of the reading against that of the joint.
    pub skew_s: f64,
}

/// The brake's current of one tick.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TickBrake {
    pub measured_a: f64,
    /// Delay of the reading against that of the joint; negative if it is held.
    pub skew_s: f64,
    pub commanded_a: f64,
}

/// Measured and commanded values of one tick. Slow quantities hold their last reading.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TickValues {
    pub time_s: f64,
    pub joint: JointReading,
    pub torque: Option<TickTorque>,
    pub temperature_c: Option<f64>,
    /// Delay of the thermometer reading against the row; negative if it is held.
    pub thermometer_skew_s: f64,
    pub brake: Option<TickBrake>,
    pub velocity_setpoint_rad_s: f64,
    /// For a run of encoders.
    pub encoders: Option<Encoders>,
    /// Pose of the sensor on the stage.
    pub pose: Option<Pose>,
    /// Commanded motor current, alone or as feedforward.
    pub motor_current_setpoint_a: f64,
}

/// The columns that this bench can fill. A missing instrument has no column.
///
/// At most thirteen: time_s, motor_position_rad, motor_velocity_rad_s, motor_current_a, link_position_rad,
/// link_torque_nm, torque_skew_s (delay of its reading against the row), temperature_c, brake_current_a,
/// brake_torque_command_nm, velocity_setpoint_rad_s, segment, repeat.
///
/// A thermometer adds thermometer_1_c, thermometer_2_c, … in the channel order of the bench description, and
/// thermometer_skew_s. For a joint without a temperature reading, the first of them is temperature_c instead.
///
/// If the torque sensor streams, a row has the mean of the samples since the previous row, and the mean of their
/// times.
///
/// A run that checks the torque sensor has other_range_torque_nm after torque_skew_s: the same torque in its other
/// range.
///
/// A brake run names its columns after the brake: brake_torque_nm is the sensor reading against the commanded
/// direction (positive while the brake brakes). position_rad and velocity_rad_s are those of the brake shaft, which
/// is the link. brake_current_skew_s is the delay of the current reading. brake_current_command_a replaces the torque
/// command, which does not exist there.
#[derive(Debug, Clone)]
pub(crate) struct Columns {
    channels: Vec<Channel>,
    brake_nm_per_a: f64,
    /// Set for a brake run: the last commanded direction of the shaft.
    brake_direction: Option<f64>,
    /// Motor turns for each turn of the shaft whose velocity is also recorded.
    velocity_gear_ratio: Option<f64>,
    /// The plan commands motor current, which is recorded in motor_current_setpoint_a.
    commands_current: bool,
    /// Thermometer channels that replace the joint's temperature: 0 or 1.
    replacing: usize,
    row: Vec<f64>,
}

impl Columns {
    /// `moves_stage`: the plan moves the stage. `streams`: the torque sensor streams. `thermometers`: number of
    /// channels of the thermometer.
    pub fn of(
        plan: &Plan,
        moves_stage: bool,
        streams: bool,
        bench: &Bench,
        reading: &JointReading,
        health: &DriveHealth,
        thermometers: usize,
    ) -> Self {
        let is_brake = plan.kind == Kind::Brake;
        let replacing = usize::from(health.temperature.is_none() && thermometers > 0);
        let brake_nm_per_a = if is_brake { 1.0 } else { nominal_brake_nm_per_a(&bench.constants) };
        let velocity_name = velocity_name(plan.kind);
        let mut channels = joint_channels(bench, reading, is_brake);
        channels.extend(torque_channels(plan, bench, streams));
        channels.extend(temperature_channels(bench, health, thermometers, replacing));
        channels.extend(brake_channels(bench, is_brake, brake_nm_per_a));
        channels.push(channel("velocity_setpoint_rad_s", Some(VELOCITY_STEP_RAD_S)));
        let commands_current = plan.commands_current();
        channels.extend(commands_current.then(|| channel(MOTOR_CURRENT_SETPOINT, None)));
        channels.extend(velocity_name.map(|name| channel(name, None)));
        if plan.kind == Kind::Encoder {
            channels.extend(encoder_columns::channels(bench, moves_stage));
        }
        channels.extend(["segment", "repeat"].map(|name| channel(name, Some(1.0))));
        Self {
            row: Vec::with_capacity(channels.len()),
            channels,
            brake_nm_per_a,
            brake_direction: is_brake.then_some(1.0),
            // The encoders of an encoder bench are on the motor's shaft.
            velocity_gear_ratio: velocity_name
                .map(|_| if plan.kind == Kind::Encoder { 1.0 } else { bench.constants.gear_ratio }),
            commands_current,
            replacing,
        }
    }

    pub fn empty_trace(&self) -> Trace {
        Trace::new(self.channels.clone())
    }

    /// The row of a tick, in the order of the channels. `thermometer_c`: the thermometer's values.
    pub fn row(&mut self, values: &TickValues, thermometer_c: &[f64], segment: u32, repeat: u32) -> &[f64] {
        if let Some(direction) = &mut self.brake_direction
            && values.velocity_setpoint_rad_s != 0.0
        {
            *direction = values.velocity_setpoint_rad_s.signum();
        }
        let direction = self.brake_direction.unwrap_or(1.0);
        let row = &mut self.row;
        row.clear();
        row.extend([values.time_s, values.joint.motor_position.0, values.joint.motor_velocity.0]);
        row.push(values.joint.motor_current.0);
        row.extend(values.joint.link_position.map(|position| position.0));
        if let Some(torque) = values.torque {
            row.extend([direction * torque.nm, to_time_step(torque.skew_s)]);
            row.extend(torque.other_nm.map(|other_nm| direction * other_nm));
        }
        row.extend(values.temperature_c);
        row.extend(thermometer_c.iter().skip(self.replacing));
        row.extend((!thermometer_c.is_empty()).then(|| to_time_step(values.thermometer_skew_s)));
        if let Some(brake) = values.brake {
            row.push(brake.measured_a);
            row.extend(self.brake_direction.map(|_| to_time_step(brake.skew_s)));
            row.push(brake.commanded_a * self.brake_nm_per_a);
        }
        row.push(values.velocity_setpoint_rad_s);
        row.extend(self.commands_current.then_some(values.motor_current_setpoint_a));
        row.extend(self.velocity_gear_ratio.map(|gear_ratio| values.joint.motor_velocity.0 / gear_ratio));
        if let Some(encoders) = &values.encoders {
            encoder_columns::row(encoders, values.pose, row);
        }
        row.extend([f64::from(segment), f64::from(repeat)]);
        row
    }
}

fn joint_channels(bench: &Bench, reading: &JointReading, is_brake: bool) -> Vec<Channel> {
    let steps = bench.joint.resolution();
    let mut channels = vec![
        channel("time_s", Some(TIME_STEP_S)),
        channel("motor_position_rad", steps.motor_position.map(|step| step.0)),
        channel("motor_velocity_rad_s", steps.motor_velocity.map(|step| step.0)),
        channel("motor_current_a", steps.motor_current.map(|step| step.0)),
    ];
    if reading.link_position.is_some() {
        let name = if is_brake { "position_rad" } else { "link_position_rad" };
        channels.push(channel(name, steps.link_position.map(|step| step.0)));
    }
    channels
}

fn torque_channels(plan: &Plan, bench: &Bench, streams: bool) -> Vec<Channel> {
    let Some(sensor) = &bench.torque_sensor else { return Vec::new() };
    let name = if plan.kind == Kind::Brake { "brake_torque_nm" } else { "link_torque_nm" };
    // A mean of counts has no count resolution.
    let step_nm = sensor.resolution().map(|step| step.0).filter(|_| !streams);
    let mut channels = vec![channel(name, step_nm), channel(TORQUE_SKEW, Some(TIME_STEP_S))];
    if plan.both_ranges && sensor.has_two_ranges() {
        channels.push(channel(OTHER_RANGE, None));
    }
    channels
}

/// `replacing`: thermometer channels that replace the joint's temperature.
fn temperature_channels(bench: &Bench, health: &DriveHealth, thermometers: usize, replacing: usize) -> Vec<Channel> {
    let mut channels = Vec::new();
    let thermometer_step_c = bench.thermometer.as_ref().map(|thermometer| thermometer.resolution().0);
    if health.temperature.is_some() || thermometers > 0 {
        let own_step_c = bench.joint.resolution().temperature.map(|step| step.0);
        channels.push(channel("temperature_c", if replacing == 0 { own_step_c } else { thermometer_step_c }));
    }
    channels
        .extend((replacing..thermometers).map(|at| channel(&format!("thermometer_{}_c", at + 1), thermometer_step_c)));
    channels.extend((thermometers > 0).then(|| channel(THERMOMETER_SKEW, Some(TIME_STEP_S))));
    channels
}

fn brake_channels(bench: &Bench, is_brake: bool, nm_per_a: f64) -> Vec<Channel> {
    let Some(source) = &bench.brake else { return Vec::new() };
    let step_a = source.resolution().map(|step| step.0);
    let mut channels = vec![channel("brake_current_a", step_a)];
    channels.extend(is_brake.then(|| channel(BRAKE_SKEW, Some(TIME_STEP_S))));
    let name = if is_brake { "brake_current_command_a" } else { "brake_torque_command_nm" };
    channels.push(channel(name, step_a.map(|step| step * nm_per_a)));
    channels
}

/// The shaft whose velocity is recorded in addition to that of the motor.
fn velocity_name(kind: Kind) -> Option<&'static str> {
    match kind {
        Kind::Brake | Kind::Encoder => Some("velocity_rad_s"),
        Kind::Stiffness => Some("link_velocity_rad_s"),
        Kind::Friction => None,
    }
}

/// Rounds to whole microseconds.
pub(crate) fn to_time_step(t_s: f64) -> f64 {
    (t_s / TIME_STEP_S).round() * TIME_STEP_S
}

/// Nominal torque per current from the data sheet: it converts a commanded current, but is not the actual torque.
fn nominal_brake_nm_per_a(constants: &JointConstants) -> f64 {
    constants.brake_rated_torque_nm / constants.brake_rated_current_a
}

fn channel(name: &str, resolution: Option<f64>) -> Channel {
    Channel { name: name.to_owned(), resolution }
}
