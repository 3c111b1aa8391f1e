//! Data sheets of the joints under test and the brake, known to the owner of the bench.

mod puma;

use jointbench_instrument::Limits;
use jointbench_instrument::bench::JointConstants;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// The object that the drive turns: one of two flexible joints, the motor of an encoder bench, or an arm.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Joint {
    /// Belt and strain-wave gear, 177.8:1, 70 Nm, ±5 turns.
    JointA,
    /// Two belts, 50:1, 20 Nm, no stops.
    JointB,
    /// No gear: the shaft has only the two encoders of the encoder bench.
    EncoderShaft,
    /// An axis of a Puma 560, upright at the zero of its encoder.
    Puma,
}

/// The load of the joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Load {
    /// Up to 15 Nm, the same at every speed.
    #[default]
    BrakeA,
    /// Up to 150 Nm: brake B behind a 1:10 gear with speed-dependent friction. Brake A rotates too, without current.
    GearAndBrakeB,
    /// No load and no torque sensor: the encoder bench.
    None,
}

/// Values of a joint, of its friction (motor side) and of its stiffness (link side), as docs/documents.md lists them.
#[derive(Debug, Clone, Copy)]
pub(super) struct DataSheet {
    pub joint: Joint,
    /// A bench has exactly the published values. Otherwise the seed draws its friction around them, without Stribeck
    /// effect and scatter.
    pub is_exact: bool,
    pub torque_constant_nm_per_a: f64,
    pub ratio: f64,
    pub max_torque_nm: f64,
    pub range_rad: Option<f64>,
    pub coulomb_nm: f64,
    /// Standard deviation of Coulomb friction between strokes, as a fraction of it.
    pub scatter: f64,
    pub breakaway_nm: f64,
    pub viscous_nm_s: f64,
    /// Half the difference of Coulomb friction between the directions, and the same for viscous friction as a fraction
    /// of it.
    pub direction_offset_nm: f64,
    pub viscous_asymmetry: f64,
    /// Gravity torque of a link that is upright at 0, when it is horizontal. 0: no load on the joint.
    pub upright_nm: f64,
    /// Link side.
    pub stribeck_velocity_rad_s: f64,
    pub stribeck_exponent: f64,
    pub stiffness_nm_rad: f64,
    /// Stiffness of the joint's bearing, which is in series between the two encoders of the joint.
    pub bearing_nm_rad: f64,
    /// Lost motion: link lag that depends on the direction, without load to either side (β₀ of the table).
    pub lost_rad: f64,
    /// Additional link rotation under load compared with a linear gear. Zero: a linear gear.
    pub soft_rad: f64,
    /// Flange, coupling and sensor shaft on the joint's side of the torque sensor, or the load of the shaft (assumed).
    pub link_inertia_kg_m2: f64,
    /// Link side: inertia with which the drive's gains were tuned.
    pub tuned_inertia_kg_m2: f64,
    /// Assumed: no data sheet states it.
    pub rotor_inertia_kg_m2: f64,
    pub max_motor_velocity_rad_s: f64,
    pub max_motor_current_a: f64,
    /// Loops of the drive.
    pub loops: Loops,
    /// Rated torque of each brake.
    pub brake_nm: f64,
    /// Offset of encoder S2 by its mounting, in points of 2¹⁸.
    pub mounting_points: f64,
}

/// Gains of the drive's loops.
#[derive(Debug, Clone, Copy)]
pub(super) struct Loops {
    /// Gain of a position loop that follows the integral of the velocity set-point, as in the controllers of the joints in docs/documents.md.
    /// `None`: the drive's velocity loop follows the set-point.
    pub position_per_s: Option<f64>,
    /// Bandwidth of the velocity loop.
    pub velocity_rad_s: f64,
    /// Integral gain of the velocity loop, as a multiple of its proportional gain.
    pub integral_per_s: f64,
}

const VELOCITY_LOOP: Loops = Loops { position_per_s: None, velocity_rad_s: 300.0, integral_per_s: 60.0 };

/// Magtrol HB-1750M, data sheet EN 04/2025.
pub(super) mod brake {
    pub const RATED_TORQUE_NM: f64 = 13.0;
    pub const RATED_CURRENT_A: f64 = 0.6;
    pub const COIL_OHM_25C: f64 = 52.0;
    pub const INERTIA_KG_M2: f64 = 5.63e-3;
    pub const CONTINUOUS_W: f64 = 350.0;
}

/// Turns of brake B per turn of the link.
pub(super) const LINE_RATIO: f64 = 10.0;

/// Supplies rated current to a coil at 100 °C (40.4 V) with a margin.
const COMPLIANCE_V: f64 = 45.0;

/// Rated torque of the brakes in docs/documents.md.
const DOCUMENTS_BRAKE_NM: f64 = 15.0;
/// ξ of the encoder bench, in points of 2¹⁸.
const MOUNTING_POINTS: f64 = 1437.0;
/// Motor current of joint A at its largest torque of 70 Nm: 9.7 A, and up to 2 A for friction.
const FULL_TORQUE_A: f64 = 12.0;

/// Position loops with the tracking errors of table 4.7 at 0.15 rad/s: a lag of 6.4 mrad, and friction in addition.
const JOINT_A_LOOPS: Loops = Loops { position_per_s: Some(23.3), velocity_rad_s: 450.0, integral_per_s: 0.7 };
const JOINT_B_LOOPS: Loops = Loops { position_per_s: Some(24.0), velocity_rad_s: 500.0, integral_per_s: 0.3 };

const JOINT_A: DataSheet = DataSheet {
    joint: Joint::JointA,
    is_exact: false,
    torque_constant_nm_per_a: 0.0406,
    ratio: 177.8,
    max_torque_nm: 70.0,
    range_rad: Some(5.0 * TAU),
    coulomb_nm: 0.030,
    scatter: 0.0,
    breakaway_nm: 0.039,
    viscous_nm_s: 1.512e-4,
    direction_offset_nm: 0.0,
    viscous_asymmetry: 0.0,
    upright_nm: 0.0,
    stribeck_velocity_rad_s: 0.06,
    stribeck_exponent: 0.8,
    stiffness_nm_rad: 5722.5,
    bearing_nm_rad: 155.0e3,
    lost_rad: 0.5871e-3,
    soft_rad: 0.0,
    link_inertia_kg_m2: 0.011,
    tuned_inertia_kg_m2: 0.017,
    rotor_inertia_kg_m2: 1.2e-5,
    max_motor_velocity_rad_s: 350.0,
    max_motor_current_a: 8.0,
    loops: VELOCITY_LOOP,
    brake_nm: brake::RATED_TORQUE_NM,
    mounting_points: 0.0,
};

const JOINT_B: DataSheet = DataSheet {
    joint: Joint::JointB,
    is_exact: false,
    torque_constant_nm_per_a: 0.0798,
    ratio: 50.0,
    max_torque_nm: 20.0,
    range_rad: None,
    coulomb_nm: 0.031,
    scatter: 0.0,
    breakaway_nm: 0.057,
    viscous_nm_s: 7.835e-5,
    direction_offset_nm: 0.0,
    viscous_asymmetry: 0.0,
    upright_nm: 0.0,
    stribeck_velocity_rad_s: 0.08,
    stribeck_exponent: 1.9,
    stiffness_nm_rad: 684.3,
    bearing_nm_rad: 75.0e3,
    lost_rad: 0.0,
    soft_rad: 0.9588e-3,
    link_inertia_kg_m2: 0.011,
    tuned_inertia_kg_m2: 0.017,
    rotor_inertia_kg_m2: 4.4e-5,
    max_motor_velocity_rad_s: 350.0,
    max_motor_current_a: 8.0,
    loops: VELOCITY_LOOP,
    brake_nm: brake::RATED_TORQUE_NM,
    mounting_points: 0.0,
};

/// A BLDC motor without a data sheet: all values are assumed.
const ENCODER_SHAFT: DataSheet = DataSheet {
    joint: Joint::EncoderShaft,
    is_exact: false,
    torque_constant_nm_per_a: 0.08,
    ratio: 1.0,
    max_torque_nm: 1.0,
    range_rad: None,
    coulomb_nm: 0.010,
    scatter: 0.0,
    breakaway_nm: 0.012,
    viscous_nm_s: 2e-5,
    direction_offset_nm: 0.0,
    viscous_asymmetry: 0.0,
    upright_nm: 0.0,
    stribeck_velocity_rad_s: 1.0,
    stribeck_exponent: 1.0,
    stiffness_nm_rad: 20.0,
    bearing_nm_rad: f64::INFINITY,
    lost_rad: 0.0,
    soft_rad: 0.0,
    link_inertia_kg_m2: 1e-5,
    tuned_inertia_kg_m2: 1e-5,
    rotor_inertia_kg_m2: 4.4e-5,
    max_motor_velocity_rad_s: 200.0,
    max_motor_current_a: 5.0,
    loops: VELOCITY_LOOP,
    brake_nm: brake::RATED_TORQUE_NM,
    mounting_points: 0.0,
};

impl From<Joint> for DataSheet {
    fn from(joint: Joint) -> Self {
        match joint {
            Joint::JointA => JOINT_A,
            Joint::JointB => JOINT_B,
            Joint::EncoderShaft => ENCODER_SHAFT,
            Joint::Puma => puma::axis(puma::SHOULDER),
        }
    }
}

impl DataSheet {
    /// The sheet of a joint. `axis` applies to the Puma.
    pub fn of(joint: Joint, axis: u8) -> Self {
        if joint == Joint::Puma { puma::axis(axis) } else { joint.into() }
    }

    /// The bench of the documents: exactly their values.
    pub fn exact(self) -> Self {
        let (loops, max_motor_current_a) = match self.joint {
            Joint::JointA => (JOINT_A_LOOPS, FULL_TORQUE_A),
            Joint::JointB => (JOINT_B_LOOPS, self.max_motor_current_a),
            _ => (self.loops, self.max_motor_current_a),
        };
        let (brake_nm, mounting_points) = (DOCUMENTS_BRAKE_NM, MOUNTING_POINTS);
        Self { is_exact: true, loops, max_motor_current_a, brake_nm, mounting_points, ..self }
    }

    /// The constants that a bench description of this joint and load states.
    pub fn constants(&self, load: Load) -> JointConstants {
        let (load_gear_ratio, brakes) = match load {
            Load::BrakeA => (None, 1.0),
            Load::GearAndBrakeB => (Some(LINE_RATIO), 1.0),
            Load::None => (None, 0.0),
        };
        JointConstants {
            torque_constant_nm_per_a: self.torque_constant_nm_per_a,
            gear_ratio: self.ratio,
            rotor_inertia_kg_m2: self.rotor_inertia_kg_m2,
            brake_compliance_v: brakes * COMPLIANCE_V,
            brake_rated_current_a: brakes * brake::RATED_CURRENT_A,
            brake_rated_torque_nm: brakes * load_gear_ratio.unwrap_or(1.0) * self.brake_nm,
            link_range_rad: self.range_rad,
            load_gear_ratio,
        }
    }

    /// The limits of the bench: the lowest of joint, torque range and brake.
    pub fn limits(&self, load: Load) -> Limits {
        let (sensor_nm, brakes) = match load {
            Load::BrakeA => (18.0, 1.0),
            Load::GearAndBrakeB => (150.0, 1.0),
            Load::None => (0.0, 0.0),
        };
        Limits {
            motor_velocity_rad_s: self.max_motor_velocity_rad_s,
            motor_current_a: self.max_motor_current_a,
            link_torque_nm: self.max_torque_nm.min(sensor_nm),
            temperature_c: 70.0,
            brake_current_a: brakes * 0.62,
            brake_power_w: brakes * brake::CONTINUOUS_W,
        }
    }
}
