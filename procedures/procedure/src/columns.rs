//! The columns of a run table: which ones a bench fills, and one row of them.

use crate::encoder_columns::{self, Encoders};
use crate::plan::Plan;
use jointbench_instrument::bench::JointConstants;
use jointbench_instrument::roles::{DriveHealth, JointReading, Pose};
use jointbench_instrument::skew::{BRAKE_SKEW, TORQUE_SKEW, WARMTH_SKEW};
use jointbench_instrument::{Bench, Channel, Kind, Trace};

/// Time is kept in whole microseconds: finer than any serial instrument can tell, and exact to store.
const TIME_STEP_S: f64 = 1e-6;
/// Velocity set-points are sent, and kept, in these steps.
pub(crate) const VELOCITY_STEP_RAD_S: f64 = 1e-4;

/// Only of a plan that commands motor current; what is left of one may command none.
pub(crate) const MOTOR_CURRENT_SETPOINT: &str = "motor_current_setpoint_a";

/// The torque as the sensor's other range tells it.
pub(crate) const OTHER_RANGE: &str = "other_range_torque_nm";

/// The torque in one tick.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TorqueMoment {
    pub nm: f64,
    /// The largest either way, where more than one sample stands behind it.
    pub peak_nm: f64,
    /// In the sensor's other range, where the plan asks for it.
    pub other_nm: Option<f64>,
    /// By how much later than the joint it was felt.
    pub skew_s: f64,
}

/// The brake's current in one tick.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BrakeMoment {
    pub measured_a: f64,
    /// By how much later than the joint it was measured: earlier, where it is held.
    pub skew_s: f64,
    pub commanded_a: f64,
}

/// What one tick knows, measured and commanded. Slow quantities hold their last reading.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Moment {
    pub time_s: f64,
    pub joint: JointReading,
    pub torque: Option<TorqueMoment>,
    pub temperature_c: Option<f64>,
    /// By how much later than the row the thermometer was read: earlier, where it is held.
    pub warmth_skew_s: f64,
    pub brake: Option<BrakeMoment>,
    pub velocity_setpoint_rad_s: f64,
    /// In a run of encoders.
    pub encoders: Option<Encoders>,
    /// Where the stage holds the sensor.
    pub pose: Option<Pose>,
    /// Commanded as such, or fed forward.
    pub motor_current_setpoint_a: f64,
}

/// The columns that this bench can fill. An instrument that is not there has no column.
///
/// Thirteen where all are there: time_s, motor_position_rad, motor_velocity_rad_s, motor_current_a, link_position_rad,
/// link_torque_nm, torque_skew_s (it was felt so much later than its row), temperature_c, brake_current_a,
/// brake_torque_command_nm, velocity_setpoint_rad_s, segment, repeat.
///
/// A thermometer adds thermometer_1_c, thermometer_2_c, … in the order in which the bench description names its channels, and
/// thermometer_skew_s. Of a joint that tells no temperature the first of them is temperature_c instead.
///
/// Where the torque sensor sends by itself, a row has the mean of the samples since the row before, and the middle of their
/// moments.
///
/// A run that checks the torque sensor has other_range_torque_nm behind torque_skew_s: the same torque in its other range.
///
/// A run of a brake names what it feels after the brake: brake_torque_nm is the sensor's reading against the commanded
/// way (positive while the brake brakes), position_rad and velocity_rad_s are those of its shaft, the link's,
/// brake_current_skew_s tells when its current was measured, and brake_current_command_a stands in for the torque that
/// nobody has asked for.
#[derive(Debug, Clone)]
pub(crate) struct Columns {
    channels: Vec<Channel>,
    brake_nm_per_a: f64,
    /// Set for a run of a brake: the way in which the shaft was last told to turn.
    braked_way: Option<f64>,
    /// Turns of the motor for each of the shaft whose velocity is told, too.
    told_gear_ratio: Option<f64>,
    /// The plan commands motor current: motor_current_setpoint_a tells it.
    commands_current: bool,
    /// Channels of the thermometer that stand for the joint's temperature: 0 or 1.
    standing_in: usize,
    row: Vec<f64>,
}

impl Columns {
    /// `placed`: the plan moves the stage. `streams`: the torque sensor sends by itself. `felt`: channels of the thermometer.
    pub fn of(
        plan: &Plan,
        placed: bool,
        streams: bool,
        bench: &Bench,
        reading: &JointReading,
        health: &DriveHealth,
        felt: usize,
    ) -> Self {
        let steps = bench.joint.resolution();
        let is_brake = plan.kind == Kind::Brake;
        let commands_current = plan.commands_current();
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
        if let Some(sensor) = &bench.torque_sensor {
            let name = if is_brake { "brake_torque_nm" } else { "link_torque_nm" };
            // A mean of counts is no count.
            channels.push(channel(name, sensor.resolution().map(|step| step.0).filter(|_| !streams)));
            channels.push(channel(TORQUE_SKEW, Some(TIME_STEP_S)));
            if plan.both_ranges && sensor.has_two_ranges() {
                channels.push(channel(OTHER_RANGE, None));
            }
        }
        let felt_step_c = bench.thermometer.as_ref().map(|thermometer| thermometer.resolution().0);
        let standing_in = usize::from(health.temperature.is_none() && felt > 0);
        if health.temperature.is_some() || felt > 0 {
            let own_step_c = steps.temperature.map(|step| step.0);
            channels.push(channel("temperature_c", if standing_in == 0 { own_step_c } else { felt_step_c }));
        }
        channels.extend((standing_in..felt).map(|at| channel(&format!("thermometer_{}_c", at + 1), felt_step_c)));
        channels.extend((felt > 0).then(|| channel(WARMTH_SKEW, Some(TIME_STEP_S))));
        let brake_nm_per_a = if is_brake { 1.0 } else { nominal_brake_nm_per_a(&bench.constants) };
        if let Some(source) = &bench.brake {
            let step_a = source.resolution().map(|step| step.0);
            channels.push(channel("brake_current_a", step_a));
            if is_brake {
                channels.push(channel(BRAKE_SKEW, Some(TIME_STEP_S)));
            }
            let name = if is_brake { "brake_current_command_a" } else { "brake_torque_command_nm" };
            channels.push(channel(name, step_a.map(|step| step * brake_nm_per_a)));
        }
        channels.push(channel("velocity_setpoint_rad_s", Some(VELOCITY_STEP_RAD_S)));
        if commands_current {
            channels.push(channel(MOTOR_CURRENT_SETPOINT, None));
        }
        let told = match plan.kind {
            Kind::Brake => Some("velocity_rad_s"),
            Kind::Stiffness => Some("link_velocity_rad_s"),
            Kind::Encoder => Some("velocity_rad_s"),
            Kind::Friction => None,
        };
        channels.extend(told.map(|name| channel(name, None)));
        if plan.kind == Kind::Encoder {
            channels.extend(encoder_columns::channels(bench, placed));
        }
        channels.push(channel("segment", Some(1.0)));
        channels.push(channel("repeat", Some(1.0)));
        Self {
            row: Vec::with_capacity(channels.len()),
            channels,
            brake_nm_per_a,
            braked_way: is_brake.then_some(1.0),
            // An encoder bench's encoders sit on the motor's shaft.
            told_gear_ratio: told.map(|_| if plan.kind == Kind::Encoder { 1.0 } else { bench.constants.gear_ratio }),
            commands_current,
            standing_in,
        }
    }

    pub fn empty_trace(&self) -> Trace {
        Trace::new(self.channels.clone())
    }

    /// The row of a moment, in the order of the channels. `felt_c`: the thermometer's.
    pub fn row(&mut self, moment: &Moment, felt_c: &[f64], segment: u32, repeat: u32) -> &[f64] {
        if let Some(way) = &mut self.braked_way
            && moment.velocity_setpoint_rad_s != 0.0
        {
            *way = moment.velocity_setpoint_rad_s.signum();
        }
        let way = self.braked_way.unwrap_or(1.0);
        let row = &mut self.row;
        row.clear();
        row.extend([moment.time_s, moment.joint.motor_position.0, moment.joint.motor_velocity.0]);
        row.push(moment.joint.motor_current.0);
        row.extend(moment.joint.link_position.map(|position| position.0));
        if let Some(torque) = moment.torque {
            row.extend([way * torque.nm, to_time_step(torque.skew_s)]);
            row.extend(torque.other_nm.map(|other_nm| way * other_nm));
        }
        row.extend(moment.temperature_c);
        row.extend(felt_c.iter().skip(self.standing_in));
        row.extend((!felt_c.is_empty()).then(|| to_time_step(moment.warmth_skew_s)));
        if let Some(brake) = moment.brake {
            row.push(brake.measured_a);
            row.extend(self.braked_way.map(|_| to_time_step(brake.skew_s)));
            row.push(brake.commanded_a * self.brake_nm_per_a);
        }
        row.push(moment.velocity_setpoint_rad_s);
        row.extend(self.commands_current.then_some(moment.motor_current_setpoint_a));
        row.extend(self.told_gear_ratio.map(|gear_ratio| moment.joint.motor_velocity.0 / gear_ratio));
        if let Some(encoders) = &moment.encoders {
            encoder_columns::row(encoders, moment.pose, row);
        }
        row.extend([f64::from(segment), f64::from(repeat)]);
        row
    }
}

/// Whole microseconds.
pub(crate) fn to_time_step(t_s: f64) -> f64 {
    (t_s / TIME_STEP_S).round() * TIME_STEP_S
}

/// The data sheet's proportionality of torque and current: what a commanded current stands for, not what it gives.
fn nominal_brake_nm_per_a(constants: &JointConstants) -> f64 {
    constants.brake_rated_torque_nm / constants.brake_rated_current_a
}

fn channel(name: &str, resolution: Option<f64>) -> Channel {
    Channel { name: name.to_owned(), resolution }
}
