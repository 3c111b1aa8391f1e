//! The six axes of a Puma 560 (Corke 1994).

use super::{DataSheet, Joint, VELOCITY_LOOP, brake};
use std::f64::consts::PI;

/// The axis of figure 3.2.
pub const SHOULDER: u8 = 2;

/// Motor torque of axis 2 per volt at its converter: its published Coulomb friction (Nm) over that of figure 3.2 (V).
const SHOULDER_NM_PER_V: f64 = 0.231;
/// Coulomb friction (V) and slope (V over degrees in a second at the link) of figure 3.2, in positive and negative
/// direction.
const SHOULDER_V: [f64; 2] = [0.545064, 0.307835];
const SHOULDER_SLOPES: [f64; 2] = [0.007581, 0.005757];

/// One row of table 3.1 (motor side), and the other constants of the axis.
struct Axis {
    stiction_nm: f64,
    /// In positive and negative direction.
    coulomb_nm: [f64; 2],
    viscous_nm_s: [f64; 2],
    nm_per_v: f64,
    max_motor_current_a: f64,
    ratio: f64,
    rotor_inertia_kg_m2: f64,
    upright_nm: f64,
    range_rad: f64,
    /// Assumed, as is the stiffness.
    link_inertia_kg_m2: f64,
    stiffness_nm_rad: f64,
}

const SHOULDER_RATIO: f64 = 107.815;

/// Viscous friction of axis 2 (motor) for a slope of its line.
const fn shoulder_viscous_nm_s(slope: f64) -> f64 {
    slope * SHOULDER_NM_PER_V / (SHOULDER_RATIO * (PI / 180.0))
}

/// Friction: table 3.1 of Corke 1994, as in table 2.12 of Corke 1996; axis 2 from the
/// lines of figure 3.2, which agree with the table within 0.5 %. Ratio, rotor, torque constant and weight: Corke and
/// Armstrong-Hélouvry 1994. The wrist carries a small tool (assumed).
const AXES: [Axis; 6] = [
    Axis {
        stiction_nm: 0.569,
        coulomb_nm: [0.435, 0.395],
        viscous_nm_s: [1.46e-3, 1.49e-3],
        nm_per_v: 0.189,
        max_motor_current_a: 8.0,
        ratio: 62.6111,
        rotor_inertia_kg_m2: 2.0e-4,
        upright_nm: 0.0,
        range_rad: 2.79,
        link_inertia_kg_m2: 3.0,
        stiffness_nm_rad: 66e3,
    },
    Axis {
        stiction_nm: 0.141,
        coulomb_nm: [SHOULDER_V[0] * SHOULDER_NM_PER_V, SHOULDER_V[1] * SHOULDER_NM_PER_V],
        viscous_nm_s: [shoulder_viscous_nm_s(SHOULDER_SLOPES[0]), shoulder_viscous_nm_s(SHOULDER_SLOPES[1])],
        nm_per_v: SHOULDER_NM_PER_V,
        max_motor_current_a: 5.0,
        ratio: SHOULDER_RATIO,
        rotor_inertia_kg_m2: 2.0e-4,
        upright_nm: 37.2,
        range_rad: 1.6,
        link_inertia_kg_m2: 4.0,
        stiffness_nm_rad: 76e3,
    },
    Axis {
        stiction_nm: 0.164,
        coulomb_nm: [0.105, 0.132],
        viscous_nm_s: [1.78e-3, 0.972e-3],
        nm_per_v: 0.202,
        max_motor_current_a: 5.0,
        ratio: 53.7063,
        rotor_inertia_kg_m2: 2.0e-4,
        upright_nm: 8.4,
        range_rad: 2.3,
        link_inertia_kg_m2: 0.9,
        stiffness_nm_rad: 30e3,
    },
    Axis {
        stiction_nm: 14.7e-3,
        coulomb_nm: [11.2e-3, 16.9e-3],
        viscous_nm_s: [64.4e-6, 77.9e-6],
        nm_per_v: 0.075,
        max_motor_current_a: 5.0,
        ratio: 76.0364,
        rotor_inertia_kg_m2: 3.3e-5,
        upright_nm: 0.0,
        range_rad: 1.9,
        link_inertia_kg_m2: 0.02,
        stiffness_nm_rad: 2e3,
    },
    Axis {
        stiction_nm: 5.72e-3,
        coulomb_nm: [9.26e-3, 14.5e-3],
        viscous_nm_s: [93.4e-6, 71.8e-6],
        nm_per_v: 0.066,
        max_motor_current_a: 5.0,
        ratio: 71.923,
        rotor_inertia_kg_m2: 3.3e-5,
        upright_nm: 0.0,
        range_rad: 1.7,
        link_inertia_kg_m2: 0.02,
        stiffness_nm_rad: 2e3,
    },
    Axis {
        stiction_nm: 5.44e-3,
        coulomb_nm: [3.96e-3, 10.5e-3],
        viscous_nm_s: [40.3e-6, 33.1e-6],
        nm_per_v: 0.066,
        max_motor_current_a: 5.0,
        ratio: 76.686,
        rotor_inertia_kg_m2: 3.3e-5,
        upright_nm: 0.0,
        range_rad: 4.6,
        link_inertia_kg_m2: 0.02,
        stiffness_nm_rad: 2e3,
    },
];

/// Axes 1 to 6; other numbers are the nearest axis.
pub fn axis(number: u8) -> DataSheet {
    let axis = &AXES[usize::from(number.clamp(1, 6)) - 1];
    let ([forward, backward], [out, back]) = (axis.coulomb_nm, axis.viscous_nm_s);
    let coulomb_nm = 0.5 * (forward + backward);
    DataSheet {
        joint: Joint::Puma,
        is_exact: false,
        torque_constant_nm_per_a: axis.nm_per_v,
        ratio: axis.ratio,
        max_torque_nm: axis.nm_per_v * axis.max_motor_current_a * axis.ratio,
        range_rad: Some(axis.range_rad),
        coulomb_nm,
        // r² of figure 3.2 for the line of axis 2 over 5 to 40 °/s: a scatter of 11.5 mV.
        scatter: 0.027,
        // Stiction is that of the positive direction.
        breakaway_nm: coulomb_nm + axis.stiction_nm - forward,
        viscous_nm_s: 0.5 * (out + back),
        direction_offset_nm: 0.5 * (forward - backward),
        viscous_asymmetry: (out - back) / (out + back),
        upright_nm: axis.upright_nm,
        stribeck_velocity_rad_s: 0.008,
        stribeck_exponent: 2.0,
        stiffness_nm_rad: axis.stiffness_nm_rad,
        bearing_nm_rad: f64::INFINITY,
        lost_rad: 0.0,
        soft_rad: 0.0,
        link_inertia_kg_m2: axis.link_inertia_kg_m2,
        tuned_inertia_kg_m2: axis.link_inertia_kg_m2,
        rotor_inertia_kg_m2: axis.rotor_inertia_kg_m2,
        max_motor_velocity_rad_s: 120.0,
        max_motor_current_a: axis.max_motor_current_a,
        loops: VELOCITY_LOOP,
        brake_nm: brake::RATED_TORQUE_NM,
        mounting_points: 0.0,
    }
}
