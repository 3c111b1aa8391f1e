//! The campaigns of the documents: their procedures, and the figures of their tables.

use super::{ProcedureResult, Requirement};
use crate::catalogue::{Procedure, procedure};
use serde_json::{Value, json};
use std::f64::consts::TAU;

/// The subject of the documents that is on the bench.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Subject {
    /// Joint A of docs/documents.md, with brake A.
    JointA,
    /// Joint B of docs/documents.md, with brake A.
    JointB,
    /// Joint A with the gear and brake B behind brake A.
    GearAndBrakeB {
        /// Highest load as a fraction of the rated torque: the joint's own limits end it earlier.
        share: f64,
    },
    /// The encoder bench.
    Encoder,
    /// The same with the filter of the encoder under test enabled, when its delay without the filter is known.
    FilteredEncoder {
        /// Delay of the same encoder without the filter.
        delay_without_s: f64,
        /// Half the difference of this delay between the directions.
        half_difference_s: f64,
    },
    /// An axis of a Puma 560 (Corke 1994).
    Puma {
        /// 1 to 6.
        axis: usize,
    },
}

/// A figure to compare: table, quantity, value of the document, requirement.
pub(super) type Figure = (&'static str, &'static str, Option<f64>, Option<Requirement>);

/// One procedure with its parameters, and the figures of the document.
pub(super) type Part = (&'static str, Value, Vec<Figure>);

pub(super) fn friction([tau_c, c_v, tau_h, omega_s, delta_s]: [f64; 5]) -> Vec<Figure> {
    let table = "4.5, 4.6";
    vec![
        (table, "tau_c", Some(tau_c), Some(Requirement::WithinShare(0.02))),
        (table, "c_v", Some(c_v), Some(Requirement::WithinShare(0.03))),
        (table, "tau_h", Some(tau_h), Some(Requirement::WithinShare(0.05))),
        (table, "omega_s", Some(omega_s), Some(Requirement::WithinShare(0.15))),
        (table, "delta_s", Some(delta_s), None),
    ]
}

fn compensation(figures: [f64; 9]) -> Vec<Figure> {
    let names = [
        "ratio_zero_area",
        "ratio_interpolated",
        "ratio_coulomb_viscous",
        "ratio_observer",
        "rho_max_none",
        "rho_max_zero_area",
        "rho_max_interpolated",
        "rho_max_coulomb_viscous",
        "rho_max_observer",
    ];
    let beyond = [("ratio_full", 0.5), ("over_full", 0.0)]
        .map(|(name, most)| ("beyond", name, None, Some(Requirement::AtMost(most))));
    names.into_iter().zip(figures).map(|(name, figure)| ("4.7", name, Some(figure), None)).chain(beyond).collect()
}

fn stiffness([inverse_k, k, beta_0]: [f64; 3]) -> Vec<Figure> {
    vec![
        ("4.8", "inverse_k", Some(inverse_k), None),
        ("4.8", "k", Some(k), Some(Requirement::WithinShare(0.01))),
        ("4.8", "beta_0", Some(beta_0), Some(Requirement::WithinShare(0.03))),
    ]
}

/// The accuracy classes of both ranges of the torque sensor together: 0.1 % of 20 Nm and 0.05 % of 200 Nm.
const RANGES_AGREE_NM: f64 = 0.12;

/// The campaign of a joint, in its order.
fn joint(bearing_nm_rad: f64, figures: [Vec<Figure>; 3]) -> Vec<Part> {
    let [friction, stiffness, compensation] = figures;
    vec![
        ("brake_speed_independence", json!({}), vec![("3.4", "change_max", None, Some(Requirement::AtMost(2.0)))]),
        ("brake_hysteresis", json!({}), Vec::new()),
        ("brake_torque", json!({}), vec![("beyond", "error_max", None, Some(Requirement::AtMost(1.0)))]),
        ("demagnetise", json!({}), Vec::new()),
        (
            "torque_sensor_zero",
            json!({}),
            vec![("data sheet", "disagreement", None, Some(Requirement::AtMost(RANGES_AGREE_NM)))],
        ),
        ("friction", json!({"load_levels": 1, "repeats": 5, "dwell_s": 3.0}), friction),
        ("breakaway", json!({}), Vec::new()),
        ("presliding", json!({}), Vec::new()),
        ("friction_load", json!({}), Vec::new()),
        ("stiffness", json!({"bearing_stiffness_nm_rad": bearing_nm_rad}), stiffness),
        ("compensation", json!({}), compensation),
    ]
}

/// The purpose of the gear and brake B: high loads, and a torque that depends on speed.
fn gear_and_brake_b(share: f64) -> Vec<Part> {
    let (slow, stiff) = (
        json!({"top_current": share}),
        json!({"top_load": share, "bearing_stiffness_nm_rad": 155.0e3, "dwell_s": 4.0}),
    );
    vec![
        ("brake_speed_independence", slow, vec![("3.5", "change_max", None, Some(Requirement::AtLeast(2.0)))]),
        ("stiffness", stiff, stiffness([0.1812e-3, 5722.5, 0.5871e-3])),
    ]
}

/// The smallest steps of the stage in an edge search, a shift and a rotation.
const SHIFT_STEP: Requirement = Requirement::Within(4e-6);
const ROTATION_STEP: Requirement = Requirement::Within(2e-4);

/// Table 4.2: the mean of equation 4.5, and each speed.
fn delay() -> Vec<Figure> {
    let per_rpm = [
        ("points_per_rpm_1", 0.2724),
        ("points_per_rpm_2", 0.2735),
        ("points_per_rpm_3", 0.2748),
        ("points_per_rpm_4", 0.2902),
        ("points_per_rpm_5", 0.2887),
        ("points_per_rpm_6", 0.2869),
    ];
    let first = [("4.2", "delay", None, Some(Requirement::Within(1e-6))), ("4.2", "delay_mean", Some(64.34e-6), None)];
    first.into_iter().chain(per_rpm.map(|(name, figure)| ("4.2", name, Some(figure), None))).collect()
}

/// Table 4.3: its mean, and the delay beyond the data sheet at each speed.
fn filter_delay() -> Vec<Figure> {
    let missing = [
        ("missing_delay_1", 0.94e-6),
        ("missing_delay_2", 1.11e-6),
        ("missing_delay_3", 0.69e-6),
        ("missing_delay_4", 1.34e-6),
        ("missing_delay_5", 1.02e-6),
        ("missing_delay_6", 0.84e-6),
    ];
    let first = [("4.3", "filter_delay", Some(10.99e-6), Some(Requirement::Within(1e-6)))];
    first.into_iter().chain(missing.map(|(name, figure)| ("4.3", name, Some(figure), None))).collect()
}

fn encoder() -> Vec<Part> {
    let point_rad = TAU / f64::from(1 << 18);
    let degree = TAU / 360.0;
    let edge = |name, at, step| ("4.4", name, Some(at), Some(step));
    vec![
        (
            "encoder_offset",
            json!({}),
            vec![("eq. 4.3", "offset", Some(1437.0 * point_rad), Some(Requirement::Within(point_rad)))],
        ),
        ("encoder_startup", json!({}), vec![("section 4.1", "startup_spread", None, None)]),
        ("encoder_delay", json!({}), delay()),
        (
            "encoder_linearity",
            json!({}),
            vec![
                ("figs 4.4–4.11", "bits_before", Some(10.0), None),
                ("figs 4.4–4.11", "bits_velocity", Some(14.0), None),
                ("beyond", "bits_direction", None, Some(Requirement::AtLeast(15.0))),
            ],
        ),
        (
            "encoder_alignment",
            json!({}),
            vec![
                edge("radial_negative", -0.25e-3, SHIFT_STEP),
                edge("radial_positive", 0.3e-3, SHIFT_STEP),
                edge("axial_positive", 0.65e-3, SHIFT_STEP),
                edge("rotation_negative", -degree, ROTATION_STEP),
                edge("rotation_positive", degree, ROTATION_STEP),
                edge("tilt_negative", -1.5 * degree, ROTATION_STEP),
                edge("tilt_positive", 1.5 * degree, ROTATION_STEP),
            ],
        ),
    ]
}

/// Table 3.1 of the chapter on the Puma (motor side): stiction, Coulomb and viscous friction in both directions.
const PUMA: [[f64; 5]; 6] = [
    [0.569, 0.435, 0.395, 1.46e-3, 1.49e-3],
    [0.141, 0.126, 0.0709, 0.928e-3, 0.705e-3],
    [0.164, 0.105, 0.132, 1.78e-3, 0.972e-3],
    [14.7e-3, 11.2e-3, 16.9e-3, 64.4e-6, 77.9e-6],
    [5.72e-3, 9.26e-3, 14.5e-3, 93.4e-6, 71.8e-6],
    [5.44e-3, 3.96e-3, 10.5e-3, 40.3e-6, 33.1e-6],
];

/// Figure 3.2 of the same chapter, axis 2: volts, and volts over degrees in a second at the link.
fn puma_lines() -> Vec<Figure> {
    let line = |name, figure, share: Option<f64>| ("3.2", name, Some(figure), share.map(Requirement::WithinShare));
    vec![
        line("b_positive", 0.007581, Some(0.03)),
        line("f_positive", 0.545064, Some(0.02)),
        line("r2_positive", 0.979807, None),
        line("b_negative", 0.005757, Some(0.03)),
        line("f_negative", -0.307835, Some(0.02)),
        line("r2_negative", 0.975420, None),
    ]
}

/// The ramp of the breakaway ends in 15 s at 1.5 times the largest friction of the axis.
fn puma(axis: usize) -> Vec<Part> {
    let table = PUMA[axis - 1];
    let names = ["tau_s_positive", "tau_c_positive", "tau_c_negative", "c_v_positive", "c_v_negative"];
    let rows = names.into_iter().zip(table).map(|(name, figure)| ("3.1", name, Some(figure), None));
    let (figures, parameters) = match axis {
        2 => (puma_lines(), json!({})),
        _ => {
            let top_nm = 1.5 * table[..3].iter().copied().fold(0.0, f64::max);
            // At 5 °/s the motor of axis 5 turns once per second: 100 Hz would sample its 800 counts at one phase.
            (Vec::new(), json!({"top_torque_nm": top_nm, "ramp_nm_s": top_nm / 15.0, "sample_rate_hz": 110}))
        }
    };
    vec![("puma_friction", parameters, figures.into_iter().chain(rows).collect())]
}

impl Subject {
    /// The procedures of its campaign, in their order.
    pub fn procedures(self) -> Vec<&'static dyn Procedure> {
        self.campaign().into_iter().filter_map(|(id, ..)| procedure(id)).collect()
    }

    /// Takes the results of earlier subjects that this one needs.
    pub fn follow<'a>(&mut self, earlier: impl IntoIterator<Item = &'a ProcedureResult>) {
        if let Subject::FilteredEncoder { delay_without_s, half_difference_s } = self {
            let found = earlier.into_iter().find(|result| result.procedure == "encoder_delay");
            let value = |name| found.and_then(|found| Some(found.identification.quantity(name)?.value));
            *delay_without_s = value("delay").unwrap_or(0.0);
            // Within its interval of 0, the earlier run has one delay.
            let half_difference = found.and_then(|found| found.identification.quantity("half_difference"));
            let differs = |ends: [f64; 2]| ends[0] > 0.0 || ends[1] < 0.0;
            *half_difference_s =
                half_difference.filter(|one| one.ci95.is_some_and(differs)).map_or(0.0, |one| one.value);
        }
    }

    pub(super) fn campaign(self) -> Vec<Part> {
        match self {
            Subject::JointA => joint(
                155.0e3,
                [
                    friction([0.030, 1.512e-4, 0.039, 0.06, 0.8]),
                    stiffness([0.1812e-3, 5722.5, 0.5871e-3]),
                    compensation([0.87, 0.86, 0.87, 0.87, 7.640e-3, 7.519e-3, 6.557e-3, 6.606e-3, 6.480e-3]),
                ],
            ),
            Subject::JointB => joint(
                75.0e3,
                [
                    friction([0.031, 7.835e-5, 0.057, 0.08, 1.9]),
                    stiffness([1.4746e-3, 684.3, 0.9588e-3]),
                    compensation([0.79, 0.82, 0.79, 0.85, 7.245e-3, 7.844e-3, 7.653e-3, 7.688e-3, 6.400e-3]),
                ],
            ),
            Subject::GearAndBrakeB { share } => gear_and_brake_b(share),
            Subject::Encoder => encoder(),
            Subject::FilteredEncoder { delay_without_s, half_difference_s } => vec![(
                "encoder_delay",
                json!({
                    "delay_without_filter_s": delay_without_s,
                    "half_difference_without_filter_s": half_difference_s,
                }),
                filter_delay(),
            )],
            Subject::Puma { axis } => puma(axis),
        }
    }
}
