//! What a turning joint asks of its motor: effects of the kind `friction`. Motor side, positive torque drives positive
//! velocity.

mod cogging;
mod coulomb;
mod direction_offset;
mod drift;
mod friction_ripple;
mod gravity;
mod inertia;
mod load_linear;
mod load_quadratic;
mod load_transmission;
mod load_viscous;
mod presliding;
mod signal_delay;
mod stribeck;
mod stribeck_load;
mod teeth;
mod temperature_coulomb;
mod temperature_viscous;
mod torque_constant_saturation;
mod viscous;
mod viscous_asymmetry;
mod viscous_quadratic;
mod viscous_sublinear;

use crate::effect::Effect;
pub use teeth::WITH_WEIGHT;

pub static ALL: &[&dyn Effect] = &[
    &inertia::Inertia,
    &load_transmission::LoadTransmission,
    &coulomb::Coulomb,
    &viscous::Viscous,
    &stribeck::Stribeck,
    &direction_offset::DirectionOffset,
    &viscous_asymmetry::ViscousAsymmetry,
    &viscous_quadratic::ViscousQuadratic,
    &viscous_sublinear::ViscousSublinear,
    &load_linear::LoadLinear,
    &load_quadratic::LoadQuadratic,
    &load_viscous::LoadViscous,
    &stribeck_load::StribeckLoad,
    &temperature_viscous::TemperatureViscous,
    &temperature_coulomb::TemperatureCoulomb,
    &gravity::Gravity,
    &cogging::Cogging,
    &friction_ripple::FrictionRipple,
    &torque_constant_saturation::TorqueConstantSaturation,
    &drift::Drift,
    &presliding::Presliding,
    &signal_delay::SignalDelay,
];
