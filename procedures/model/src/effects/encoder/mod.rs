//! Effects of the kind `encoder`: test minus reference encoder [rad].

pub(crate) mod delay;
pub(crate) mod direction_hysteresis;
pub(crate) mod fixed_harmonic;
pub(crate) mod harmonic_1;
pub(crate) mod harmonic_2;
pub(crate) mod harmonic_n;
pub(crate) mod offset;
pub(crate) mod pole_period;
pub(crate) mod slip;
pub(crate) mod startup_offset;
pub(crate) mod temperature_drift;

use crate::effect::Effect;

pub static ALL: &[&dyn Effect] = &[
    &offset::OFFSET,
    &delay::DELAY,
    &harmonic_1::HARMONIC_1,
    &harmonic_2::HARMONIC_2,
    &harmonic_n::HarmonicN,
    &pole_period::PolePeriod,
    &direction_hysteresis::DIRECTION_HYSTERESIS,
    &temperature_drift::TEMPERATURE_DRIFT,
    &slip::Slip,
    &startup_offset::StartupOffset,
];
