//! The command to the drive in a tick: a velocity with feedforward, or a motor current alone.

use super::session::{DriveCommand, Session};
use crate::plan::{Drive, EndCondition, Feedforward, Step};
use jointbench_instrument::roles::JointReading;
use std::f64::consts::TAU;

/// Measured friction in excess of the planned feedforward, low-pass filtered, during a step.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct MeasuredFriction {
    left_a: f64,
}

/// Detects a breakaway: counts consecutive increases of the motor position.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct BreakawayDetector {
    at_rad: Option<f64>,
    times: u32,
}

impl BreakawayDetector {
    /// Whether the joint has broken away in the direction of the current.
    pub fn is_detected(&mut self, until: EndCondition, current_a: f64, joint: Option<JointReading>) -> bool {
        let Some(joint) = joint else { return false };
        let position_rad = joint.motor_position.0;
        let before_rad = self.at_rad.replace(position_rad).unwrap_or(position_rad);
        self.times = if (position_rad - before_rad) * current_a > 0.0 { self.times + 1 } else { 0 };
        self.times >= until.increases || joint.motor_velocity.0.abs() > until.speed_rad_s
    }
}

impl Session<'_> {
    pub(super) fn drive_command(&self, step: &Step, t_s: f64, friction: &mut MeasuredFriction) -> DriveCommand {
        let rad_s = step.velocity.at(t_s);
        match &step.drive {
            Drive::Current { from_s, current_a, .. } if t_s >= *from_s => {
                DriveCommand::Current { a: current_a.at(t_s - from_s) }
            }
            Drive::Velocity | Drive::Current { .. } => DriveCommand::Velocity { rad_s, feedforward_a: 0.0 },
            Drive::Fed(feedforward) => {
                DriveCommand::Velocity { rad_s, feedforward_a: self.feedforward_a(feedforward, rad_s, t_s, friction) }
            }
        }
    }

    fn feedforward_a(
        &self,
        feedforward: &Feedforward,
        setpoint_rad_s: f64,
        t_s: f64,
        friction: &mut MeasuredFriction,
    ) -> f64 {
        let side = |ramp_rad_s: f64| (setpoint_rad_s / ramp_rad_s).clamp(-1.0, 1.0);
        match feedforward {
            Feedforward::Planned(current_a) => current_a.at(t_s),
            Feedforward::Observed { planned_a, share, corner_hz, ramp_rad_s } => {
                let planned_a = planned_a.at(t_s);
                let gain = 1.0 - (-TAU * corner_hz * self.period.duration_s).exp();
                let left_a = share * self.friction_a() - planned_a.abs();
                friction.left_a += gain * (left_a - friction.left_a);
                planned_a + friction.left_a * side(*ramp_rad_s)
            }
            Feedforward::LoadDependent { planned_a, a_per_nm, ramp_rad_s } => {
                planned_a.at(t_s) + a_per_nm * self.link_torque_nm.unwrap_or(0.0).abs() * side(*ramp_rad_s)
            }
            Feedforward::MeasuredDirection { current_a } => {
                let rad_s = self.joint.map_or(0.0, |joint| joint.motor_velocity.0);
                if rad_s == 0.0 { 0.0 } else { current_a.copysign(rad_s) }
            }
        }
    }

    /// The motor current of friction from the latest readings: in the direction of motion, never negative.
    fn friction_a(&self) -> f64 {
        let Some(joint) = self.joint else { return 0.0 };
        let constants = &self.bench.constants;
        let load_a = self.link_torque_nm.unwrap_or(0.0) / constants.gear_ratio / constants.torque_constant_nm_per_a;
        ((joint.motor_current.0 - load_a) * joint.motor_velocity.0.signum()).max(0.0)
    }
}
