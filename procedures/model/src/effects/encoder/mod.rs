//! What parts a test encoder from a reference: effects of the kind `encoder`. Test minus reference [rad].

mod delay;
mod direction_hysteresis;
mod harmonic_1;
mod harmonic_2;
mod harmonic_n;
mod offset;
mod pole_period;
mod slip;
mod startup_offset;
mod temperature_drift;

use crate::effect::Effect;

pub static ALL: &[&dyn Effect] = &[
    &offset::Offset,
    &delay::Delay,
    &harmonic_1::Harmonic1,
    &harmonic_2::Harmonic2,
    &harmonic_n::HarmonicN,
    &pole_period::PolePeriod,
    &direction_hysteresis::DirectionHysteresis,
    &temperature_drift::TemperatureDrift,
    &slip::Slip,
    &startup_offset::StartupOffset,
];
