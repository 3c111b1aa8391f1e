//! Effects of the kind `brake`: braking torque [Nm] of a hysteresis brake.

pub(crate) mod cogging;
pub(crate) mod drag;
pub(crate) mod hysteresis;
pub(crate) mod saturation;
pub(crate) mod scaled;
pub(crate) mod temperature_dependence;
pub(crate) mod torque_per_current;
pub(crate) mod velocity_dependence;

use crate::effect::Effect;

pub static ALL: &[&dyn Effect] = &[
    &drag::DRAG,
    &torque_per_current::TORQUE_PER_CURRENT,
    &saturation::Saturation,
    &hysteresis::Hysteresis,
    &velocity_dependence::VelocityDependence,
    &cogging::Cogging,
    &temperature_dependence::TemperatureDependence,
];
