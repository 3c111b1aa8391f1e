//! An ODrive v3.6, firmware 0.5.6: state machine, estimators and control law at 8 kHz
//! (`MotorControl/{axis,controller}.cpp`, `encoder.cpp`), commissioned for the joint. Axis 0 drives the motor, axis 1
//! reads the link encoder.

use super::Firmware;
use super::odrive_position::PositionLoop;
use crate::sim::data_sheet::DataSheet;
use crate::sim::plant::{AMBIENT_C, LINK_COUNTS, MOTOR_COUNTS, Plant, STEP_S, Signal};
use crate::sim::trouble::Trouble;
use std::f64::consts::TAU;

pub const IDLE: u8 = 1;
pub const CLOSED_LOOP: u8 = 8;
/// Error bits of axis and controller.
pub const INVALID_STATE: u32 = 0x1;
pub const CONTROLLER_FAILED: u32 = 0x200;
pub const WATCHDOG_EXPIRED: u32 = 0x800;
pub const OVERSPEED: u32 = 0x1;
pub const INVALID_INPUT_MODE: u32 = 0x2;

const TORQUE_MODE: u8 = 1;
const VELOCITY_MODE: u8 = 2;
const POSITION_MODE: u8 = 3;
const PASSTHROUGH: u8 = 1;
const VELOCITY_RAMP: u8 = 2;
pub const TRAP_TRAJ: u8 = 5;
/// Duration of a reboot, in which the UART is silent.
const REBOOT_S: f64 = 1.0;
/// Noise of the measured i_q (assumed).
const CURRENT_NOISE_A: f64 = 0.05;

/// The configuration that `ss` saves.
#[derive(Debug, Clone)]
pub struct Config {
    pub torque_constant: f32,
    pub current_lim: f32,
    pub torque_lim: f32,
    pub control_mode: u8,
    pub input_mode: u8,
    pub vel_limit: f32,
    pub vel_limit_tolerance: f32,
    pub vel_gain: f32,
    pub vel_integrator_gain: f32,
    pub pos_gain: f32,
    pub vel_ramp_rate: f32,
    pub torque_mode_vel_limit: bool,
    pub overspeed_error: bool,
    pub trap_vel_limit: f32,
    pub trap_accel_limit: f32,
    pub enable_watchdog: bool,
    pub watchdog_timeout: f32,
    pub bandwidth: [f32; 2],
}

/// A tracking loop on encoder counts; the firmware has one per encoder.
#[derive(Debug, Clone, Copy, Default)]
pub struct Estimator {
    zero_counts: i64,
    pub shadow_count: i64,
    position_counts: f64,
    velocity_counts_s: f64,
    counts_per_turn: f64,
}

impl Estimator {
    fn track(&mut self, counts: i64, bandwidth: f32) {
        let gain = 2.0 * f64::from(bandwidth);
        let speed_gain = 0.25 * gain * gain;
        self.shadow_count = counts - self.zero_counts;
        self.position_counts += STEP_S * self.velocity_counts_s;
        let behind = (self.shadow_count - self.position_counts.floor() as i64) as f64;
        self.position_counts += STEP_S * gain * behind;
        self.velocity_counts_s += STEP_S * speed_gain * behind;
        // An estimate smaller than the effect of one count in one step is set to zero.
        if self.velocity_counts_s.abs() < 0.5 * STEP_S * speed_gain {
            self.velocity_counts_s = 0.0;
        }
    }

    pub fn set_count(&mut self, counts: i64) {
        self.zero_counts += self.shadow_count - counts;
        self.position_counts += (counts - self.shadow_count) as f64;
        self.shadow_count = counts;
    }

    fn exact_turns(&self) -> f64 {
        self.position_counts / self.counts_per_turn
    }

    pub fn turns(&self) -> f32 {
        self.exact_turns() as f32
    }

    pub fn turns_s(&self) -> f32 {
        (self.velocity_counts_s / self.counts_per_turn) as f32
    }
}

pub struct Odrive {
    factory: Config,
    saved: Config,
    pub config: Config,
    pub state: u8,
    pub axis_error: u32,
    pub motor_error: u64,
    pub encoder_error: u32,
    pub controller_error: u32,
    pub system_error: u32,
    pub encoders: [Estimator; 2],
    pub input_pos: f32,
    pub input_vel: f32,
    pub input_torque: f32,
    /// Set-points after the input filter.
    pos_setpoint: f32,
    vel_setpoint: f32,
    integrator_torque: f32,
    position_loop: Option<PositionLoop>,
    watchdog_s: f64,
    pub iq_setpoint: f32,
    reboot_until_s: Option<f64>,
    /// Value buffer of `w`: a command without a value writes the value of an earlier command.
    pub stale_value: String,
    pub trouble: Trouble,
}

impl Odrive {
    pub fn new(sheet: impl Into<DataSheet>) -> Self {
        let sheet: DataSheet = sheet.into();
        let inertia = sheet.rotor_inertia_kg_m2 + sheet.tuned_inertia_kg_m2 / sheet.ratio.powi(2);
        // In the drive's unit, Nm per turn/s.
        let vel_gain = (inertia * sheet.loops.velocity_rad_s * TAU) as f32;
        let config = Config {
            torque_constant: sheet.torque_constant_nm_per_a as f32,
            current_lim: 10.0,
            torque_lim: f32::INFINITY,
            control_mode: POSITION_MODE,
            input_mode: PASSTHROUGH,
            vel_limit: 2.0,
            vel_limit_tolerance: 1.2,
            vel_gain,
            vel_integrator_gain: sheet.loops.integral_per_s as f32 * vel_gain,
            pos_gain: 20.0,
            vel_ramp_rate: 1.0,
            torque_mode_vel_limit: true,
            overspeed_error: true,
            trap_vel_limit: 2.0,
            trap_accel_limit: 0.5,
            enable_watchdog: false,
            watchdog_timeout: 0.0,
            bandwidth: [1000.0; 2],
        };
        let estimator = |counts_per_turn| Estimator { counts_per_turn, ..Estimator::default() };
        Self {
            factory: config.clone(),
            saved: config.clone(),
            config,
            state: IDLE,
            axis_error: 0,
            motor_error: 0,
            encoder_error: 0,
            controller_error: 0,
            system_error: 0,
            encoders: [estimator(MOTOR_COUNTS), estimator(LINK_COUNTS)],
            input_pos: 0.0,
            input_vel: 0.0,
            input_torque: 0.0,
            pos_setpoint: 0.0,
            vel_setpoint: 0.0,
            integrator_torque: 0.0,
            position_loop: sheet.loops.position_per_s.map(PositionLoop::new),
            watchdog_s: 0.0,
            iq_setpoint: 0.0,
            reboot_until_s: None,
            stale_value: String::new(),
            trouble: Trouble::None,
        }
    }

    pub fn feed_watchdog(&mut self) {
        self.watchdog_s = self.config.watchdog_timeout.into();
    }

    pub fn clear_errors(&mut self) {
        (self.axis_error, self.motor_error, self.encoder_error) = (0, 0, 0);
        (self.controller_error, self.system_error) = (0, 0);
    }

    pub fn save(&mut self, now_s: f64) {
        self.saved = self.config.clone();
        self.reboot(now_s);
    }

    pub fn erase(&mut self, now_s: f64) {
        self.saved = self.factory.clone();
        self.reboot(now_s);
    }

    /// Incremental encoders start from 0 at power-up.
    pub fn reboot(&mut self, now_s: f64) {
        self.disarm();
        self.clear_errors();
        self.config = self.saved.clone();
        (self.input_pos, self.input_vel, self.input_torque) = (0.0, 0.0, 0.0);
        self.encoders.iter_mut().for_each(|encoder| encoder.set_count(0));
        self.reboot_until_s = Some(now_s + REBOOT_S);
    }

    pub fn is_booting(&self) -> bool {
        self.reboot_until_s.is_some()
    }

    /// `requested_state`: closing the loop needs a drive without errors; calibrations finish immediately.
    pub fn request_state(&mut self, state: u8) {
        self.axis_error &= !INVALID_STATE;
        match state {
            CLOSED_LOOP if !self.has_errors() => {
                self.state = CLOSED_LOOP;
                self.integrator_torque = 0.0;
                self.vel_setpoint = 0.0;
                self.pos_setpoint = self.encoders[0].turns();
                self.input_pos = self.pos_setpoint;
                self.feed_watchdog();
            }
            0 | IDLE | 3 | 4 | 6 | 7 => self.disarm(),
            _ => {
                self.disarm();
                self.axis_error |= INVALID_STATE;
            }
        }
    }

    fn has_errors(&self) -> bool {
        self.axis_error | self.encoder_error | self.controller_error | self.system_error != 0 || self.motor_error != 0
    }

    fn disarm(&mut self) {
        self.state = IDLE;
        self.iq_setpoint = 0.0;
    }

    pub fn iq_measured(&self, plant: &Plant) -> f32 {
        (plant.motor_current_a() + CURRENT_NOISE_A * plant.noise_of(Signal::MotorCurrent)) as f32
    }

    pub fn bus_voltage(&self, plant: &Plant) -> f32 {
        (24.09 - 0.02 * plant.motor_current_a().abs() + 0.01 * plant.noise_of(Signal::BusVoltage)) as f32
    }

    /// The converter of the thermistor has a resolution of 1/16 K.
    pub fn motor_temperature(&self, plant: &Plant) -> f32 {
        let shown_c = plant.gear_c() + 0.02 * plant.noise_of(Signal::GearThermistor);
        ((shown_c * 16.0).round() / 16.0) as f32
    }

    pub fn stage_temperature(&self, plant: &Plant) -> f32 {
        let warm_c = AMBIENT_C + 6.0 + 0.3 * plant.motor_current_a().powi(2);
        (warm_c + 0.1 * plant.noise_of(Signal::StageThermistor)) as f32
    }

    /// Updates the set-points from the inputs according to the input mode.
    fn filter_inputs(&mut self) {
        let dt = STEP_S as f32;
        match self.config.input_mode {
            PASSTHROUGH => {
                self.pos_setpoint = self.input_pos;
                self.vel_setpoint = self.input_vel;
            }
            VELOCITY_RAMP => {
                let most = self.config.vel_ramp_rate * dt;
                self.vel_setpoint += (self.input_vel - self.vel_setpoint).clamp(-most, most);
            }
            TRAP_TRAJ => {
                let left = self.input_pos - self.pos_setpoint;
                let braking = (2.0 * self.config.trap_accel_limit * left.abs()).sqrt();
                let wanted = left.signum() * braking.min(self.config.trap_vel_limit);
                let most = self.config.trap_accel_limit * dt;
                self.vel_setpoint += (wanted - self.vel_setpoint).clamp(-most, most);
                self.pos_setpoint += self.vel_setpoint * dt;
            }
            _ => self.controller_error |= INVALID_INPUT_MODE,
        }
    }

    /// Position P, velocity PI, torque clamp. Torque in Nm at the motor.
    fn control(&mut self) -> f32 {
        let config = &self.config;
        let (position, velocity) = (self.encoders[0].turns(), self.encoders[0].turns_s());
        let mut torque = self.input_torque;
        if config.control_mode >= VELOCITY_MODE {
            let mut wanted = match &mut self.position_loop {
                Some(position_loop) if config.control_mode == VELOCITY_MODE => {
                    position_loop.advance(self.vel_setpoint, self.encoders[0].exact_turns())
                }
                _ => self.vel_setpoint,
            };
            if config.control_mode >= POSITION_MODE {
                wanted += config.pos_gain * (self.pos_setpoint - position);
            }
            let behind = wanted.clamp(-config.vel_limit, config.vel_limit) - velocity;
            torque += config.vel_gain * behind + self.integrator_torque;
            let most = self.most_torque();
            if torque.abs() > most {
                self.integrator_torque *= 0.99;
            } else {
                self.integrator_torque += config.vel_integrator_gain * STEP_S as f32 * behind;
            }
            return torque.clamp(-most, most);
        }
        if config.control_mode == TORQUE_MODE && config.torque_mode_vel_limit {
            // Reduces the torque far below the limit: already near standstill with the default of 2 turns/s.
            let most = (config.vel_limit - velocity) * config.vel_gain;
            let least = (-config.vel_limit - velocity) * config.vel_gain;
            torque = torque.max(least).min(most);
        }
        torque.max(-self.most_torque()).min(self.most_torque())
    }

    fn most_torque(&self) -> f32 {
        (self.config.torque_constant * self.config.current_lim).min(self.config.torque_lim).max(0.0)
    }

    fn check(&mut self) {
        let config = &self.config;
        if config.enable_watchdog {
            if self.watchdog_s > 0.0 {
                self.watchdog_s -= STEP_S;
            } else {
                self.axis_error |= WATCHDOG_EXPIRED;
            }
        }
        let velocity = self.encoders[0].turns_s().abs();
        if self.state == CLOSED_LOOP
            && config.overspeed_error
            && velocity > config.vel_limit * config.vel_limit_tolerance
        {
            self.controller_error |= OVERSPEED;
        }
        if self.controller_error != 0 {
            self.axis_error |= CONTROLLER_FAILED;
        }
        if self.has_errors() {
            self.disarm();
        }
    }
}

impl Firmware for Odrive {
    fn receive(&mut self, input: &mut Vec<u8>, plant: &mut Plant, output: &mut Vec<u8>) {
        super::odrive_lines::receive(self, input, plant, output);
    }

    fn step(&mut self, plant: &mut Plant) {
        if self.reboot_until_s.is_some_and(|until_s| plant.now_s() >= until_s) {
            self.reboot_until_s = None;
        }
        self.encoders[0].track(plant.motor_counts(), self.config.bandwidth[0]);
        self.encoders[1].track(plant.link_counts(), self.config.bandwidth[1]);
        if self.state == CLOSED_LOOP {
            self.filter_inputs();
        }
        self.check();
        if self.state == CLOSED_LOOP {
            let torque = self.control();
            self.iq_setpoint = torque / self.config.torque_constant;
        }
        if self.state != CLOSED_LOOP || self.config.control_mode != VELOCITY_MODE {
            self.position_loop.iter_mut().for_each(PositionLoop::rest);
        }
        // A controller with an invalid state (nan) switches the current off.
        plant.inputs.motor_current_a = if self.iq_setpoint.is_finite() { self.iq_setpoint.into() } else { 0.0 };
    }

    fn apply_trouble(&mut self, trouble: Trouble) {
        self.trouble = trouble;
    }

    fn power_cycle(&mut self, plant: &mut Plant) {
        self.reboot(plant.now_s());
    }
}
