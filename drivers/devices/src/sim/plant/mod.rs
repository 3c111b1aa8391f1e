//! The simulated plant: rotor, gear, link, brake, heat. Physics in SI units; names state the link or motor side.
//!
//! Two inertias, coupled by the elasticity of the gear, with friction on the rotor and the brake on the link. The
//! torque sensor is between the output of the joint and the load.

mod brake;
mod curve;
mod encoders;
mod friction;
mod gear;
mod hidden;
mod line;
mod noise;
mod scatter;
mod thermal;
mod truth;

pub use encoders::{EncoderTruth, S1_COUNTS, S2_COUNTS};
pub use hidden::{HIDDEN_EFFECTS, HiddenEffect};
pub use truth::Truth;

use super::data_sheet::{DataSheet, Load};
use brake::Brake;
use encoders::Encoders;
use friction::Friction;
use gear::Gear;
pub(super) use hidden::Hidden;
use line::Line;
pub(super) use noise::{Noise, Signal};
use scatter::Scatter;
use std::f64::consts::TAU;
use thermal::Thermal;

/// Substep: the ODrive's control period, 8 kHz.
pub(super) const STEP_S: f64 = 125e-6;
pub(super) const AMBIENT_C: f64 = 24.0;
/// Largest deviation of a drawn specimen's friction from its data sheet.
const SPECIMENS: f64 = 0.08;

/// Counts per turn of the encoders.
pub(super) const MOTOR_COUNTS: f64 = 4096.0;
pub(super) const LINK_COUNTS: f64 = 524_288.0;

/// i_q follows its set-point with the drive's current controller (bandwidth 1000 rad/s).
const CURRENT_LAG_S: f64 = 1.0e-3;
/// Low-pass of the torque sensor's electronics, 1 kHz class.
const SENSOR_LAG_S: f64 = 0.4e-3;
/// More than the gravity torque of any link: the torque of a holding brake (assumed).
const HOLDING_NM: f64 = 1.0;

/// Motor current, holding brake and supply, as the firmware sides set them.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Inputs {
    pub motor_current_a: f64,
    /// A holding brake on the motor shaft is closed while the drive is off, if the joint has one.
    pub holding_brake: bool,
    /// `None`: output off.
    pub coil: Option<CoilSupply>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct CoilSupply {
    pub current_a: f64,
    pub voltage_v: f64,
}

pub(super) struct Plant {
    pub inputs: Inputs,
    pub brake: Brake,
    pub noise: Noise,
    pub torque_constant_nm_per_a: f64,
    /// Offset of the torque sensor's zero, as after an overload.
    pub sensor_shift_nm: f64,
    /// Error of a failing thermistor.
    pub thermistor_fault_k: f64,
    sheet: DataSheet,
    friction: Friction,
    scatter: Scatter,
    gear: Gear,
    line: Line,
    line_inertia_kg_m2: f64,
    thermal: Thermal,
    encoders: Encoders,
    hidden: Hidden,
    step: u64,
    motor_angle_rad: f64,
    motor_velocity_rad_s: f64,
    motor_current_a: f64,
    link_angle_rad: f64,
    link_velocity_rad_s: f64,
    sensor_torque_nm: f64,
    sensor_drift_nm: f64,
    current_gain: f64,
    sensor_gain: f64,
}

impl Plant {
    pub fn new(sheet: impl Into<DataSheet>, load: Load, seed: u64, hidden: Hidden) -> Self {
        let sheet: DataSheet = sheet.into();
        let line_inertia_kg_m2 = line::inertia_kg_m2(load);
        let noise = Noise::new(seed);
        let (spread, scatter) = if sheet.is_exact { (0.0, sheet.scatter) } else { (SPECIMENS, 0.0) };
        let coulomb_nm = sheet.coulomb_nm * (1.0 + spread * noise.trait_of(Signal::Coulomb));
        let viscous_nm_s = sheet.viscous_nm_s * (1.0 + spread * noise.trait_of(Signal::Viscous));
        Self {
            inputs: Inputs::default(),
            brake: Brake::new(sheet.brake_nm, hidden.brake),
            torque_constant_nm_per_a: sheet.torque_constant_nm_per_a,
            sensor_shift_nm: 0.0,
            thermistor_fault_k: 0.0,
            friction: Friction::new(coulomb_nm, viscous_nm_s, sheet.rotor_inertia_kg_m2),
            scatter: Scatter::new(scatter, noise),
            gear: Gear::new(&sheet, sheet.link_inertia_kg_m2 + line_inertia_kg_m2, hidden.gear),
            line: Line::new(load, sheet.brake_nm),
            line_inertia_kg_m2,
            thermal: Thermal::new(AMBIENT_C),
            encoders: Encoders::new(&sheet, noise, hidden.encoder),
            hidden,
            step: 0,
            motor_angle_rad: 0.0,
            motor_velocity_rad_s: 0.0,
            motor_current_a: 0.0,
            link_angle_rad: 0.0,
            link_velocity_rad_s: 0.0,
            sensor_torque_nm: 0.0,
            // Class 0.1 % of 20 Nm, reached as the sensor warms up.
            sensor_drift_nm: 0.010 * noise.trait_of(Signal::SensorDrift),
            current_gain: 1.0 - (-STEP_S / CURRENT_LAG_S).exp(),
            sensor_gain: 1.0 - (-STEP_S / SENSOR_LAG_S).exp(),
            sheet,
            noise,
        }
    }

    /// One substep of [`STEP_S`]. Velocities first, then positions (symplectic Euler).
    pub fn advance(&mut self) {
        self.motor_current_a += self.current_gain * (self.inputs.motor_current_a - self.motor_current_a);
        let gear_nm = self.gear.torque(
            self.motor_angle_rad,
            self.link_angle_rad,
            self.motor_velocity_rad_s,
            self.link_velocity_rad_s,
        );
        let velocity = self.motor_velocity_rad_s;
        let held_nm = if self.inputs.holding_brake { HOLDING_NM } else { 0.0 };
        let film_nm = self.friction.coulomb_nm * self.scatter.advance(self.motor_angle_rad);
        let grip =
            held_nm + film_nm + self.hidden.friction.grip(&self.friction, velocity, gear_nm, self.link_angle_rad);
        let drag_nm = self.hidden.friction.drag(&self.friction, velocity, self.thermal.gear_c());
        let friction_nm = self.friction.advance(velocity, grip) + drag_nm;

        let drive_nm = self.torque_constant_nm_per_a * self.motor_current_a;
        let cogging_nm = self.hidden.friction.cogging(self.motor_angle_rad);
        let motor_nm = drive_nm - friction_nm - cogging_nm - gear_nm / self.sheet.ratio;
        self.motor_velocity_rad_s += motor_nm / self.sheet.rotor_inertia_kg_m2 * STEP_S;
        self.motor_angle_rad += self.motor_velocity_rad_s * STEP_S;
        self.encoders.advance(self.motor_angle_rad);

        let brake_nm = self.line.advance(&mut self.brake, self.inputs.coil, self.link_velocity_rad_s);
        let outside_nm = self.hidden.friction.gravity(self.link_angle_rad) + self.gear.stop(self.link_angle_rad);
        let link_acceleration = (gear_nm - outside_nm - brake_nm) / self.gear.link_inertia_kg_m2();
        self.link_velocity_rad_s += link_acceleration * STEP_S;
        self.link_angle_rad += self.link_velocity_rad_s * STEP_S;
        self.gear.advance(self.motor_angle_rad, self.link_angle_rad, self.link_velocity_rad_s * STEP_S);

        let felt_nm = brake_nm + self.line_inertia_kg_m2 * link_acceleration;
        self.sensor_torque_nm += self.sensor_gain * (felt_nm - self.sensor_torque_nm);
        self.thermal.advance(self.motor_current_a, friction_nm * velocity);
        self.step += 1;
    }

    pub fn now_s(&self) -> f64 {
        self.step as f64 * STEP_S
    }

    pub fn motor_counts(&self) -> i64 {
        (self.motor_angle_rad / TAU * MOTOR_COUNTS).floor() as i64
    }

    pub fn link_counts(&self) -> i64 {
        (self.link_angle_rad / TAU * LINK_COUNTS).floor() as i64
    }

    pub fn s1_counts(&self) -> i64 {
        self.encoders.s1_counts(self.motor_angle_rad)
    }

    pub fn s2_counts(&self) -> i64 {
        self.encoders.s2_counts(self.motor_velocity_rad_s, self.step)
    }

    pub fn power_cycle_s2(&mut self) {
        self.encoders.power_cycle_s2(self.step);
    }

    /// Sets the pose of the sensor of S2 on the stage.
    pub fn hold_sensor(&mut self, shift_m: [f64; 3], rotation_rad: [f64; 3]) {
        self.encoders.pose = encoders::Pose { shift_m, rotation_rad };
    }

    /// Starts or ends the slip of the coupling between gear and link.
    pub fn coupling_slips(&mut self, slips: bool) {
        self.gear.slips = slips;
    }

    pub fn filter_s2(&mut self, on: bool) {
        self.encoders.filtered = on;
    }

    pub fn periods_are_consistent(&self) -> bool {
        self.encoders.periods_are_consistent()
    }

    pub fn motor_angle_rad(&self) -> f64 {
        self.motor_angle_rad
    }

    pub fn motor_velocity_rad_s(&self) -> f64 {
        self.motor_velocity_rad_s
    }

    pub fn motor_current_a(&self) -> f64 {
        self.motor_current_a
    }

    /// Torque at the sensor with its drift, before each channel's noise.
    pub fn sensor_torque_nm(&self) -> f64 {
        // Five minutes of warm-up (burster manual 86-2208).
        self.sensor_torque_nm + self.sensor_shift_nm + self.sensor_drift_nm * (1.0 - (-self.now_s() / 300.0).exp())
    }

    /// Temperature of the gear housing, as its thermistor shows it.
    pub fn gear_c(&self) -> f64 {
        self.thermal.gear_c() + self.thermistor_fault_k
    }

    /// Noise of `signal` at the present time; repeated calls return the same value.
    pub fn noise_of(&self, signal: Signal) -> f64 {
        self.noise.at(signal, self.step)
    }

    pub fn truth(&self, seed: u64) -> Truth {
        let reflected_kg_m2 = (self.gear.link_inertia_kg_m2() - self.line_inertia_kg_m2) / self.sheet.ratio.powi(2);
        Truth {
            joint: self.sheet.joint,
            seed,
            hidden: self.hidden.described(),
            coulomb_nm: self.friction.coulomb_nm,
            viscous_nm_s: self.friction.viscous_nm_s,
            bristle_nm_rad: self.friction.stiffness_nm_rad,
            inertia_kg_m2: self.sheet.rotor_inertia_kg_m2 + reflected_kg_m2,
            stiffness_nm_rad: self.sheet.stiffness_nm_rad,
            directional_offset_rad: self.sheet.lost_rad + self.sheet.soft_rad,
            torque_constant_nm_per_a: self.torque_constant_nm_per_a,
            gear_ratio: self.sheet.ratio,
            encoders: self.encoders.truth(),
        }
    }
}
