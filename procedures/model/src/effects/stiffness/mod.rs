//! Effects of the kind `stiffness`: motor position divided by the gear ratio, minus link position [rad].

pub(crate) mod backlash;
pub(crate) mod compliance;
pub(crate) mod creep;
pub(crate) mod delay;
pub(crate) mod directional_offset;
pub(crate) mod hardening;
pub(crate) mod offset;
pub(crate) mod temperature_compliance;
pub(crate) mod torsional_hysteresis;
pub(crate) mod transmission_error;

use crate::effect::Effect;

pub static ALL: &[&dyn Effect] = &[
    &offset::OFFSET,
    &compliance::COMPLIANCE,
    &directional_offset::DIRECTIONAL_OFFSET,
    &backlash::Backlash,
    &hardening::Hardening,
    &torsional_hysteresis::TorsionalHysteresis,
    &transmission_error::TransmissionError,
    &temperature_compliance::TEMPERATURE_COMPLIANCE,
    &creep::Creep,
    &delay::DELAY,
];
