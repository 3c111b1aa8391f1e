//! The part of the property tree that a bench needs (`odrive-interface.yaml`, tag fw-v0.5.6).

use super::odrive::Odrive;
use super::scan::{float, print_float, unsigned};
use crate::sim::plant::Plant;

/// A property that `w` may change.
enum Slot<'a> {
    Float(&'a mut f32),
    Switch(&'a mut bool),
    Choice(&'a mut u8),
    Errors(&'a mut u32),
    LongErrors(&'a mut u64),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Refused {
    NoSuchProperty,
    /// Read-only, or the value is invalid.
    NotPossible,
}

fn slot<'a>(drive: &'a mut Odrive, path: &str) -> Option<Slot<'a>> {
    let config = &mut drive.config;
    Some(match path {
        "error" => Slot::Errors(&mut drive.system_error),
        "axis0.error" => Slot::Errors(&mut drive.axis_error),
        "axis0.motor.error" => Slot::LongErrors(&mut drive.motor_error),
        "axis0.encoder.error" => Slot::Errors(&mut drive.encoder_error),
        "axis0.controller.error" => Slot::Errors(&mut drive.controller_error),
        "axis0.controller.input_pos" => Slot::Float(&mut drive.input_pos),
        "axis0.controller.input_vel" => Slot::Float(&mut drive.input_vel),
        "axis0.controller.input_torque" => Slot::Float(&mut drive.input_torque),
        "axis0.controller.config.control_mode" => Slot::Choice(&mut config.control_mode),
        "axis0.controller.config.input_mode" => Slot::Choice(&mut config.input_mode),
        "axis0.controller.config.vel_limit" => Slot::Float(&mut config.vel_limit),
        "axis0.controller.config.vel_limit_tolerance" => Slot::Float(&mut config.vel_limit_tolerance),
        "axis0.controller.config.vel_gain" => Slot::Float(&mut config.vel_gain),
        "axis0.controller.config.vel_integrator_gain" => Slot::Float(&mut config.vel_integrator_gain),
        "axis0.controller.config.pos_gain" => Slot::Float(&mut config.pos_gain),
        "axis0.controller.config.vel_ramp_rate" => Slot::Float(&mut config.vel_ramp_rate),
        "axis0.controller.config.enable_torque_mode_vel_limit" => Slot::Switch(&mut config.torque_mode_vel_limit),
        "axis0.controller.config.enable_overspeed_error" => Slot::Switch(&mut config.overspeed_error),
        "axis0.trap_traj.config.vel_limit" => Slot::Float(&mut config.trap_vel_limit),
        "axis0.trap_traj.config.accel_limit" => Slot::Float(&mut config.trap_accel_limit),
        "axis0.motor.config.torque_constant" => Slot::Float(&mut config.torque_constant),
        "axis0.motor.config.current_lim" => Slot::Float(&mut config.current_lim),
        "axis0.motor.config.torque_lim" => Slot::Float(&mut config.torque_lim),
        "axis0.config.enable_watchdog" => Slot::Switch(&mut config.enable_watchdog),
        "axis0.config.watchdog_timeout" => Slot::Float(&mut config.watchdog_timeout),
        "axis0.encoder.config.bandwidth" => Slot::Float(&mut config.bandwidth[0]),
        "axis1.encoder.config.bandwidth" => Slot::Float(&mut config.bandwidth[1]),
        _ => return None,
    })
}

/// Read-only properties, as the firmware prints them.
fn measured(drive: &Odrive, plant: &Plant, path: &str) -> Option<String> {
    let real = |value: f32| Some(print_float(value));
    let whole = |value: i64| Some(value.to_string());
    let encoder = |axis: usize, leaf: &str| {
        let encoder = &drive.encoders[axis];
        match leaf {
            "pos_estimate" => real(encoder.turns()),
            "vel_estimate" => real(encoder.turns_s()),
            "shadow_count" => whole(encoder.shadow_count),
            "count_in_cpr" => whole(encoder.shadow_count.rem_euclid(if axis == 0 { 4096 } else { 524_288 })),
            "config.cpr" => whole(if axis == 0 { 4096 } else { 524_288 }),
            "is_ready" => whole(1),
            _ => None,
        }
    };
    match path {
        "vbus_voltage" => real(drive.bus_voltage(plant)),
        "ibus" => real(0.05 + 0.015 * plant.motor_current_a().abs() as f32),
        "hw_version_major" => whole(3),
        "hw_version_minor" => whole(6),
        "hw_version_variant" => whole(56),
        "fw_version_major" => whole(0),
        "fw_version_minor" => whole(5),
        "fw_version_revision" => whole(6),
        // 0x376E35743231; the reply is cut like every other one.
        "serial_number" => whole(0x376E_3574_3231),
        "axis0.current_state" => whole(drive.state.into()),
        "axis0.requested_state" | "axis1.requested_state" => whole(0),
        "axis1.current_state" => whole(1),
        "axis1.error" => whole(0),
        "axis0.motor.is_calibrated" => whole(1),
        "axis0.motor.current_control.Iq_setpoint" => real(drive.iq_setpoint),
        "axis0.motor.current_control.Iq_measured" => real(drive.iq_measured(plant)),
        "axis0.motor.current_control.Id_measured" => real(0.0),
        "axis0.motor.motor_thermistor.temperature" => real(drive.motor_temperature(plant)),
        "axis0.motor.fet_thermistor.temperature" => real(drive.stage_temperature(plant)),
        _ => match path.split_once(".encoder.") {
            Some(("axis0", leaf)) => encoder(0, leaf),
            Some(("axis1", leaf)) => encoder(1, leaf),
            _ => None,
        },
    }
}

pub fn read(drive: &mut Odrive, plant: &Plant, path: &str) -> Option<String> {
    if let Some(text) = measured(drive, plant, path) {
        return Some(text);
    }
    Some(match slot(drive, path)? {
        Slot::Float(value) => print_float(*value),
        Slot::Switch(on) => u8::from(*on).to_string(),
        Slot::Choice(value) => value.to_string(),
        Slot::Errors(bits) => bits.to_string(),
        Slot::LongErrors(bits) => bits.to_string(),
    })
}

pub fn write(drive: &mut Odrive, plant: &Plant, path: &str, text: &str) -> Result<(), Refused> {
    let number = unsigned(text).map(|(value, _)| value).ok_or(Refused::NotPossible);
    match path {
        "axis0.requested_state" => {
            drive.request_state(number?.min(255) as u8);
            return Ok(());
        }
        "axis1.requested_state" => return number.map(|_| ()),
        _ => {}
    }
    let read_only = measured(drive, plant, path).is_some();
    match slot(drive, path) {
        // `nan` and `inf` are accepted, although they can disable the controller.
        Some(Slot::Float(value)) => *value = float(text).ok_or(Refused::NotPossible)?.0,
        Some(Slot::Switch(on)) => *on = number? != 0,
        Some(Slot::Choice(value)) => *value = number? as u8,
        Some(Slot::Errors(bits)) => *bits = number?,
        Some(Slot::LongErrors(bits)) => *bits = text.parse().map_err(|_| Refused::NotPossible)?,
        None if read_only => return Err(Refused::NotPossible),
        None => return Err(Refused::NoSuchProperty),
    }
    Ok(())
}
