//! How a joint twists: effects of the kind `stiffness`. Motor position by gear ratio minus link position [rad].

mod backlash;
mod compliance;
mod creep;
mod delay;
mod directional_offset;
mod hardening;
mod offset;
mod temperature_compliance;
mod torsional_hysteresis;
mod transmission_error;

use crate::effect::Effect;

pub static ALL: &[&dyn Effect] = &[
    &offset::Offset,
    &compliance::Compliance,
    &directional_offset::DirectionalOffset,
    &backlash::Backlash,
    &hardening::Hardening,
    &torsional_hysteresis::TorsionalHysteresis,
    &transmission_error::TransmissionError,
    &temperature_compliance::TemperatureCompliance,
    &creep::Creep,
    &delay::Delay,
];
