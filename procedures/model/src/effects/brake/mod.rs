//! How a hysteresis brake holds: effects of the kind `brake`. Braking torque [Nm].

mod cogging;
mod drag;
mod hysteresis;
mod saturation;
mod scaled;
mod temperature_dependence;
mod torque_per_current;
mod velocity_dependence;

use crate::effect::Effect;

pub static ALL: &[&dyn Effect] = &[
    &drag::Drag,
    &torque_per_current::TorquePerCurrent,
    &saturation::Saturation,
    &hysteresis::Hysteresis,
    &velocity_dependence::VelocityDependence,
    &cogging::Cogging,
    &temperature_dependence::TemperatureDependence,
];
