//! One axis of a Puma 560's digital servo board with its amplifier (Corke 1994, section 2.3 and table 2.7). The
//! frames and all other parts that the document does not describe are defined by this project: see `protocol::puma`.
//!
//! The axis processor closes the position loop once per tick. The amplifier closes the velocity loop on the motor's
//! tachometer, with the current loop inside it.

use super::Firmware;
use super::puma_loop::Loop;
use super::puma_memory::Ram;
use crate::sim::plant::{Plant, STEP_S};
use crate::sim::trouble::Trouble;
use std::f64::consts::TAU;

/// Four counts for each of 200 lines (assumed).
pub const ENCODER_COUNTS: u32 = 800;
/// Current through the shunt per volt at the converter (assumed).
pub const AMPERES_PER_VOLT: f64 = 1.0;
/// Plant steps per tick of 0.875 ms: 32 ticks are 28 ms.
const STEPS_PER_TICK: u32 = 7;
pub const VOLTS_PER_COUNT: f64 = 10.0 / 2048.0;
pub const MOST_COUNTS: i16 = 2047;
/// Initial value in table 2.7.
const INITIAL_NINTER: u8 = 0x20;
/// Velocity gain of the amplifier [A·s/rad] (assumed: a velocity loop of 150 rad/s).
const VELOCITY_GAIN_A_S: f64 = 0.35;
/// Release time of the holding brake and start-up time of the processor (assumed).
pub const RELEASE_S: f64 = 0.2;
const BOOT_S: f64 = 0.5;
/// Arm power is switched off after this time without a command, or with the current at its limit (our definition).
const HOST_S: f64 = 0.25;
const OVERLOAD_S: f64 = 0.5;

pub const POSITION: u16 = 1 << 0;
pub const CURRENT: u16 = 1 << 1;
const ARM_POWER: u16 = 1 << 2;
/// Our definition: within `postol` of the set-point.
const IN_POSITION: u16 = 1 << 3;
const NO_HOST: u16 = 1 << 11;
const OVERLOADED: u16 = 1 << 12;

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Power {
    Off,
    ReleasingUntil(f64),
    On,
}

pub struct Puma {
    pub power: Power,
    pub mode: u16,
    pub errors: u16,
    /// Positions count from a power-up that is not yet acknowledged.
    pub fresh: bool,
    pub ninter: u8,
    pub limit: i16,
    pub memory_pointer: u8,
    /// Position of the encoder at power-up, and the counter.
    pub zero_counts: i64,
    pub counts: i64,
    pub axis: Loop,
    pub ram: Ram,
    pub current_word: i16,
    pub shunt_a: f64,
    pub steps: u32,
    pub heard_s: f64,
    pub overloaded_s: f64,
    pub booting_until_s: f64,
    pub trouble: Trouble,
}

impl Puma {
    pub fn new() -> Self {
        Self {
            power: Power::Off,
            mode: 0,
            errors: 0,
            fresh: true,
            ninter: INITIAL_NINTER,
            limit: MOST_COUNTS,
            memory_pointer: 0,
            zero_counts: 0,
            counts: 0,
            axis: Loop::new(f64::from(STEPS_PER_TICK) * STEP_S),
            ram: Ram::new(),
            current_word: 0,
            shunt_a: 0.0,
            steps: 0,
            heard_s: 0.0,
            overloaded_s: 0.0,
            booting_until_s: 0.0,
            trouble: Trouble::None,
        }
    }

    pub fn status(&self) -> u16 {
        let power = if self.power == Power::On { ARM_POWER } else { 0 };
        // Bits 6 and 7 belong to the encoder routines: the quadrature state.
        let encoder = (self.counts.rem_euclid(4) as u16) << 6;
        let arrived = if self.mode == POSITION && self.axis.is_in_position() { IN_POSITION } else { 0 };
        self.mode | power | arrived | encoder | self.errors
    }

    pub fn hold_here(&mut self) {
        self.axis.hold(self.counts);
    }

    pub fn stop(&mut self) {
        (self.power, self.mode, self.current_word) = (Power::Off, 0, 0);
        self.axis.rest();
    }

    /// Motor current that the amplifier has to supply.
    fn control(&self, plant: &Plant) -> f64 {
        let wanted_a = match self.mode {
            POSITION => {
                let demand_rad_s = self.axis.force / self.axis.tick_s * TAU / f64::from(ENCODER_COUNTS);
                VELOCITY_GAIN_A_S * (demand_rad_s - plant.motor_velocity_rad_s())
            }
            CURRENT => f64::from(self.current_word) * VOLTS_PER_COUNT * AMPERES_PER_VOLT,
            _ => 0.0,
        };
        let most_a = f64::from(self.limit) * VOLTS_PER_COUNT * AMPERES_PER_VOLT;
        wanted_a.clamp(-most_a, most_a)
    }

    /// Conditions that switch arm power off.
    fn watch(&mut self, now_s: f64, at_limit: bool) {
        self.overloaded_s = if at_limit { self.overloaded_s + STEP_S } else { 0.0 };
        let host = if now_s - self.heard_s > HOST_S { NO_HOST } else { 0 };
        let overload = if self.overloaded_s > OVERLOAD_S { OVERLOADED } else { 0 };
        if self.power != Power::Off && host | overload != 0 {
            self.errors |= host | overload;
            self.stop();
        }
    }
}

impl Firmware for Puma {
    fn receive(&mut self, input: &mut Vec<u8>, plant: &mut Plant, output: &mut Vec<u8>) {
        if plant.now_s() < self.booting_until_s {
            return input.clear();
        }
        super::puma_orders::receive(self, input, plant, output);
    }

    fn step(&mut self, plant: &mut Plant) {
        let now_s = plant.now_s();
        let turns = plant.motor_angle_rad() / TAU;
        self.counts = (turns * f64::from(ENCODER_COUNTS)).floor() as i64 - self.zero_counts;
        self.steps += 1;
        if self.steps.is_multiple_of(STEPS_PER_TICK) {
            self.axis.tick(self.counts, self.mode == POSITION);
        }
        if let Power::ReleasingUntil(until_s) = self.power
            && now_s >= until_s
        {
            self.hold_here();
            (self.power, self.mode) = (Power::On, POSITION);
        }
        let current_a = if self.power == Power::On { self.control(plant) } else { 0.0 };
        let most_a = f64::from(self.limit) * VOLTS_PER_COUNT * AMPERES_PER_VOLT;
        self.watch(now_s, current_a.abs() >= most_a);
        let on = self.power == Power::On;
        self.shunt_a = plant.motor_current_a();
        plant.inputs.motor_current_a = if on { current_a } else { 0.0 };
        plant.inputs.holding_brake = !on;
    }

    fn apply_trouble(&mut self, trouble: Trouble) {
        self.trouble = trouble;
    }

    /// The counter starts at 0 at the present position of the joint.
    fn power_cycle(&mut self, plant: &mut Plant) {
        let zero_counts = self.zero_counts + self.counts;
        let booting_until_s = plant.now_s() + BOOT_S;
        *self = Self { zero_counts, booting_until_s, trouble: self.trouble, ..Self::new() };
    }
}
