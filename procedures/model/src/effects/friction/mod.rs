//! Effects of the kind `friction`: motor torque of a moving joint. Motor side; positive torque drives positive
//! velocity.

pub(crate) mod cogging;
pub(crate) mod coulomb;
pub(crate) mod direction_offset;
pub(crate) mod drift;
pub(crate) mod friction_ripple;
pub(crate) mod gravity;
pub(crate) mod inertia;
pub(crate) mod load_linear;
pub(crate) mod load_quadratic;
pub(crate) mod load_transmission;
pub(crate) mod load_viscous;
pub(crate) mod presliding;
pub(crate) mod signal_delay;
pub(crate) mod stribeck;
pub(crate) mod stribeck_load;
pub(crate) mod teeth;
pub(crate) mod temperature_coulomb;
pub(crate) mod temperature_viscous;
pub(crate) mod torque_constant_saturation;
pub(crate) mod viscous;
pub(crate) mod viscous_asymmetry;
pub(crate) mod viscous_quadratic;
pub(crate) mod viscous_sublinear;

use crate::effect::Effect;

pub static ALL: &[&dyn Effect] = &[
    &inertia::INERTIA,
    &load_transmission::LoadTransmission,
    &coulomb::COULOMB,
    &viscous::VISCOUS,
    &stribeck::Stribeck,
    &direction_offset::DirectionOffset,
    &viscous_asymmetry::ViscousAsymmetry,
    &viscous_quadratic::ViscousQuadratic,
    &viscous_sublinear::ViscousSublinear,
    &load_linear::LoadLinear,
    &load_quadratic::LoadQuadratic,
    &load_viscous::LoadViscous,
    &stribeck_load::StribeckLoad,
    &temperature_viscous::TEMPERATURE_VISCOUS,
    &temperature_coulomb::TEMPERATURE_COULOMB,
    &gravity::Gravity,
    &cogging::Cogging,
    &friction_ripple::FrictionRipple,
    &torque_constant_saturation::TorqueConstantSaturation,
    &drift::Drift,
    &presliding::Presliding,
    &signal_delay::SIGNAL_DELAY,
];
