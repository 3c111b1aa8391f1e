//! Reproduces the campaigns of the documents on a bench, with each table next to the document's.
//!
//! The caller provides the true values of the bench if they are known; they are only compared at the end.

use crate::bench_facts::BenchFacts;
use crate::catalogue::{Procedure, brake_model, procedure};
use crate::identification::{Identification, Quantity};
use crate::in_memory_run::{InMemoryRun, InMemoryRunFault, run_in_memory_with_facts};
use jointbench_instrument::Bench;
use serde_json::{Map, Value, json};
use statrs::distribution::{ContinuousCDF, Normal};
use std::f64::consts::TAU;

/// The subject of the documents that is on the bench.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Subject {
    /// Joint A of the thesis, with brake A.
    JointA,
    /// Joint B of the thesis, with brake A.
    JointB,
    /// Joint A with the gear and brake B behind brake A.
    GearAndBrakeB,
    /// The encoder bench.
    Encoder,
    /// The same with the filter of the encoder under test enabled, when its delay without the filter is known.
    FilteredEncoder {
        /// Delay of the same encoder without the filter.
        delay_without_s: f64,
    },
    /// Joint 2 of the arm of document 000.
    Puma,
}

/// Requirement on a figure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Requirement {
    /// Largest half width of its interval, in the unit of the quantity.
    Within(f64),
    /// The same, as a share of the value.
    WithinShare(f64),
    /// The value is at least this, in the unit of the quantity.
    AtLeast(f64),
    /// The value is at most this, in the unit of the quantity.
    AtMost(f64),
}

/// One figure of a table: the value of the document, of the run, and of the bench.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// Number of the table or figure in the document.
    pub table: &'static str,
    /// The quantity of this run.
    pub found: Quantity,
    /// `None`: the document has no value.
    pub document: Option<f64>,
    /// `None`: unknown, or the bench has no such figure.
    pub given: Option<f64>,
    /// `None`: the figure is shown but not judged.
    pub demand: Option<Requirement>,
}

impl Comparison {
    /// Whether the interval contains the true value of the bench. `None` without one.
    pub fn is_inside(&self) -> Option<bool> {
        let ([low, high], given) = (self.found.ci95?, self.given?);
        Some((low..=high).contains(&given))
    }

    /// The same if `of` intervals have to hold simultaneously in 95 of 100 campaigns ([`simultaneous_factor`]).
    pub fn is_inside_with(&self, of: u64) -> Option<bool> {
        let ([low, high], given, value) = (self.found.ci95?, self.given?, self.found.value);
        let wider = simultaneous_factor(of);
        Some((value + wider * (low - value)..=value + wider * (high - value)).contains(&given))
    }

    /// Whether the figure meets its requirement. `None` without one.
    pub fn meets_requirement(&self) -> Option<bool> {
        let value = self.found.value;
        let reaches = |widest: f64| self.found.ci95.map(|[low, high]| 0.5 * (high - low) <= widest);
        match self.demand? {
            Requirement::Within(widest) => reaches(widest),
            Requirement::WithinShare(share) => reaches(share * value.abs()),
            Requirement::AtLeast(least) => Some(value >= least),
            Requirement::AtMost(most) => Some(value <= most),
        }
    }
}

/// Factor by which `of` 95 % intervals have to be wider to hold simultaneously in 95 of 100 campaigns (Šidák 1967),
/// for normal deviates.
pub fn simultaneous_factor(of: u64) -> f64 {
    let normal = Normal::standard();
    let reach = |confidence: f64| normal.inverse_cdf(0.5 + 0.5 * confidence);
    reach(0.95_f64.powf(1.0 / of.max(1) as f64)) / reach(0.95)
}

/// One procedure of the campaign.
#[derive(Debug, Clone, PartialEq)]
pub struct ProcedureResult {
    /// Id of the procedure.
    pub procedure: &'static str,
    /// Its title.
    pub title: &'static str,
    /// The parameters that differ from the defaults.
    pub parameters: Map<String, Value>,
    /// Result of its run.
    pub identification: Identification,
    /// Its figures next to those of the document.
    pub comparisons: Vec<Comparison>,
    /// On the bench's clock.
    pub duration_s: f64,
}

/// A figure to compare: table, quantity, value of the document, requirement.
type Figure = (&'static str, &'static str, Option<f64>, Option<Requirement>);

/// One procedure with its parameters, and the figures of the document.
type Part = (&'static str, Value, Vec<Figure>);

fn friction([tau_c, c_v, tau_h, omega_s, delta_s]: [f64; 5]) -> Vec<Figure> {
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
        ("brake_speed_independence", json!({}), vec![("3.4", "change_max", None, Some(Requirement::AtMost(0.02)))]),
        ("brake_hysteresis", json!({}), Vec::new()),
        ("brake_torque", json!({}), vec![("beyond", "error_max", None, Some(Requirement::AtMost(0.01)))]),
        ("demagnetise", json!({}), Vec::new()),
        (
            "torque_sensor_zero",
            json!({}),
            vec![("data sheet", "disagreement", None, Some(Requirement::AtMost(RANGES_AGREE_NM)))],
        ),
        ("friction", json!({"load_levels": 1, "repeats": 5}), friction),
        ("breakaway", json!({}), Vec::new()),
        ("presliding", json!({}), Vec::new()),
        ("friction_load", json!({}), Vec::new()),
        ("stiffness", json!({"bearing_stiffness_nm_rad": bearing_nm_rad}), stiffness),
        ("compensation", json!({}), compensation),
    ]
}

/// The purpose of the gear and brake B: high loads, and a torque that depends on speed.
fn gear_and_brake_b() -> Vec<Part> {
    // Ten times the torque at the same current: the joint's own limits end it at a third.
    let share = 0.35;
    let (slow, stiff) =
        (json!({"top_current": share}), json!({"top_load": share, "bearing_stiffness_nm_rad": 155.0e3}));
    vec![
        ("brake_speed_independence", slow, vec![("3.5", "change_max", None, Some(Requirement::AtLeast(0.02)))]),
        ("stiffness", stiff, stiffness([0.1812e-3, 5722.5, 0.5871e-3])),
    ]
}

/// The smallest steps of the stage in an edge search, a shift and a rotation.
const SHIFT_STEP: Requirement = Requirement::Within(4e-6);
const ROTATION_STEP: Requirement = Requirement::Within(2e-4);

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
        ("encoder_delay", json!({}), vec![("4.2", "delay", Some(64.34e-6), Some(Requirement::Within(1e-6)))]),
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

/// Figure 3.2 of the chapter on the Puma, joint 2: volts, and volts over degrees in a second at the link.
fn puma() -> Vec<Part> {
    let line = |name, figure, share: Option<f64>| ("3.2", name, Some(figure), share.map(Requirement::WithinShare));
    let figures = vec![
        line("b_positive", 0.007581, Some(0.03)),
        line("f_positive", 0.545064, Some(0.02)),
        line("r2_positive", 0.979807, None),
        line("b_negative", 0.005757, Some(0.03)),
        line("f_negative", -0.307835, Some(0.02)),
        line("r2_negative", 0.975420, None),
    ];
    vec![("puma_friction", json!({}), figures)]
}

impl Subject {
    /// The procedures of its campaign, in their order.
    pub fn procedures(self) -> Vec<&'static dyn Procedure> {
        self.campaign().into_iter().filter_map(|(id, ..)| procedure(id)).collect()
    }

    fn campaign(self) -> Vec<Part> {
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
            Subject::GearAndBrakeB => gear_and_brake_b(),
            Subject::Encoder => encoder(),
            Subject::FilteredEncoder { delay_without_s } => vec![(
                "encoder_delay",
                json!({"delay_without_filter_s": delay_without_s}),
                vec![("4.3", "filter_delay", Some(10.99e-6), Some(Requirement::Within(1e-6)))],
            )],
            Subject::Puma => puma(),
        }
    }
}

/// Runs the campaign in its order and reports the result of each procedure when it is done. `given` contains the true values of the
/// bench, by the names of the quantities.
pub fn reproduce(
    bench: &mut Bench,
    subject: Subject,
    given: &dyn Fn(&str) -> Option<f64>,
    done: &mut dyn FnMut(&ProcedureResult),
) -> Result<Vec<ProcedureResult>, InMemoryRunFault> {
    let mut results: Vec<ProcedureResult> = Vec::new();
    let mut facts = BenchFacts::of(bench);
    for (id, parameters, figures) in subject.campaign() {
        let Some(procedure) = procedure(id) else { continue };
        let mut parameters = parameters.as_object().cloned().unwrap_or_default();
        if id == "compensation" {
            let friction = results.iter().find(|result| result.procedure == "friction");
            let next = friction.and_then(|result| crate::procedure("friction")?.follow_up(&result.identification));
            parameters.extend(next.map(|next| next.parameters).unwrap_or_default());
        }
        let InMemoryRun { table, identification, duration_s } =
            run_in_memory_with_facts(bench, &facts, procedure, &parameters)?;
        if id == "brake_hysteresis" {
            facts.brake_model = brake_model(&table);
        }
        let Some(identification) = identification else { continue };
        let comparisons = compare(&identification, &figures, given);
        let title = procedure.title();
        let result =
            ProcedureResult { procedure: procedure.id(), title, parameters, identification, comparisons, duration_s };
        done(&result);
        results.push(result);
    }
    Ok(results)
}

fn compare(found: &Identification, figures: &[Figure], given: &dyn Fn(&str) -> Option<f64>) -> Vec<Comparison> {
    let one = |(table, name, document, demand): &Figure| {
        let found = found.quantity(name)?.clone();
        Some(Comparison { table, found, document: *document, given: given(name), demand: *demand })
    };
    figures.iter().filter_map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::findings::quantity;
    use crate::identification::Verdict;

    fn found(names: &[(&str, f64)]) -> Identification {
        let made =
            |(name, value): &(&str, f64)| quantity([name, "", "", ""], *value, Some([0.99 * value, 1.01 * value]));
        let quantities = names.iter().map(made).collect();
        let summary = String::new();
        Identification { verdict: Verdict::Identified, summary, quantities, ..Identification::default() }
    }

    #[test]
    fn an_interval_is_held_against_what_the_bench_was_given() {
        let found = found(&[("tau_c", 0.0300), ("c_v", 1.6e-4)]);
        let given = |name: &str| (name == "tau_c").then_some(0.0302);
        let comparisons = compare(&found, &friction([0.030, 1.512e-4, 0.039, 0.06, 0.8]), &given);
        assert_eq!(comparisons.iter().map(|c| c.document).collect::<Vec<_>>(), [Some(0.030), Some(1.512e-4)]);
        assert_eq!((comparisons[0].is_inside(), comparisons[0].meets_requirement()), (Some(true), Some(true)));
        assert_eq!((comparisons[1].is_inside(), comparisons[1].meets_requirement()), (None, Some(true)));
    }

    #[test]
    fn intervals_that_hold_together_are_wider() {
        let found = found(&[("tau_c", 0.0300)]);
        let off = |given: f64| {
            let of_table = [("4.5", "tau_c", None, None)];
            compare(&found, &of_table, &|_| Some(given)).remove(0)
        };
        // ±1 % alone; 1 − 0.95^(1/31) is two-sided 3.146 standard deviations, and 3.146 / 1.960 = 1.605.
        let (near, far) = (off(0.0300 * 1.016), off(0.0300 * 1.0161));
        assert_eq!(
            (near.is_inside(), near.is_inside_with(1), near.is_inside_with(31)),
            (Some(false), Some(false), Some(true))
        );
        assert_eq!(far.is_inside_with(31), Some(false));
        assert_eq!(off(0.0300 * 0.991).is_inside_with(1), Some(true));
    }
}
