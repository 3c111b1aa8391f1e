//! The documents' campaigns made again on a bench, each table beside the document's.
//!
//! What a bench really is, where somebody knows it, is handed in by the caller and only compared with at the end.

use crate::catalogue::procedure;
use crate::conduct::{ConductFault, Conducted, conduct};
use crate::identification::{Identification, Quantity};
use jointbench_instrument::Bench;
use serde_json::{Map, Value, json};

/// Which of the documents' joints is on the bench.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Subject {
    JointA,
    JointB,
    Puma,
}

/// One figure of a table: the document's, what the run found, what the bench was given.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    pub table: &'static str,
    pub found: Quantity,
    pub document: f64,
    /// `None`: nobody knows, or the bench was not given such a figure.
    pub given: Option<f64>,
    /// The interval may reach this share of the value to either side.
    pub widest: Option<f64>,
}

impl Comparison {
    /// Whether the interval holds what the bench was given. `None` where there is nothing to compare.
    pub fn is_inside(&self) -> Option<bool> {
        let ([low, high], given) = (self.found.ci95?, self.given?);
        Some((low..=high).contains(&given))
    }

    /// Half the width of the interval as a share of the value.
    pub fn width(&self) -> Option<f64> {
        self.found.ci95.map(|[low, high]| 0.5 * (high - low) / self.found.value.abs())
    }

    pub fn is_narrow(&self) -> Option<bool> {
        Some(self.width()? <= self.widest?)
    }
}

/// One procedure of the campaign.
#[derive(Debug, Clone, PartialEq)]
pub struct Chapter {
    pub procedure: &'static str,
    pub title: &'static str,
    pub parameters: Map<String, Value>,
    pub identification: Identification,
    pub comparisons: Vec<Comparison>,
    /// On the bench's clock.
    pub duration_s: f64,
}

/// A figure of a document: table, quantity, value, widest interval.
type Figure = (&'static str, &'static str, f64, Option<f64>);
/// A row of the thesis: table, quantity, joint A, joint B, widest interval.
type Row = (&'static str, &'static str, f64, f64, Option<f64>);

const FRICTION: &[Row] = &[
    ("4.5, 4.6", "tau_c", 0.030, 0.031, Some(0.02)),
    ("4.5, 4.6", "c_v", 1.512e-4, 7.835e-5, Some(0.03)),
    ("4.5, 4.6", "tau_h", 0.039, 0.057, Some(0.05)),
    ("4.5, 4.6", "omega_s", 0.06, 0.08, Some(0.15)),
    ("4.5, 4.6", "delta_s", 0.8, 1.9, None),
];

const COMPENSATION: &[Row] = &[
    ("4.7", "ratio_zero_area", 0.87, 0.79, None),
    ("4.7", "ratio_interpolated", 0.86, 0.82, None),
    ("4.7", "ratio_coulomb_viscous", 0.87, 0.79, None),
    ("4.7", "ratio_observer", 0.87, 0.85, None),
    ("4.7", "rho_max_none", 7.640e-3, 7.245e-3, None),
    ("4.7", "rho_max_observer", 6.480e-3, 6.400e-3, None),
];

const STIFFNESS: &[Row] = &[
    ("4.8", "inverse_k", 0.1812e-3, 1.4746e-3, None),
    ("4.8", "k", 5722.5, 684.3, Some(0.01)),
    ("4.8", "beta_0", 0.5871e-3, 0.9588e-3, Some(0.03)),
];

/// Figure 3.2 of the chapter on the Puma, joint 2: volts, and volts over degrees each second at the link.
const PUMA: &[Figure] = &[
    ("3.2", "b_positive", 0.007581, Some(0.03)),
    ("3.2", "f_positive", 0.545064, Some(0.02)),
    ("3.2", "r2_positive", 0.979807, None),
    ("3.2", "b_negative", 0.005757, Some(0.03)),
    ("3.2", "f_negative", -0.307835, Some(0.02)),
    ("3.2", "r2_negative", 0.975420, None),
];

/// The procedures of a campaign in their order, each with its choices and its table.
fn campaign(subject: Subject) -> Vec<(&'static str, Value, Vec<Figure>)> {
    let bearing = match subject {
        Subject::JointA => 155.0e3,
        Subject::JointB => 75.0e3,
        Subject::Puma => return vec![("puma_friction", json!({}), PUMA.to_vec())],
    };
    let of = |rows: &[Row]| column(rows, subject);
    vec![
        ("brake_speed_independence", json!({}), Vec::new()),
        ("brake_hysteresis", json!({}), Vec::new()),
        ("demagnetise", json!({}), Vec::new()),
        ("friction", json!({"load_levels": 1, "repeats": 3}), of(FRICTION)),
        ("breakaway", json!({}), Vec::new()),
        ("friction_load", json!({}), Vec::new()),
        ("stiffness", json!({"bearing_stiffness_nm_rad": bearing}), of(STIFFNESS)),
        ("compensation", json!({}), of(COMPENSATION)),
    ]
}

/// The thesis' figures of one joint.
fn column(rows: &[Row], subject: Subject) -> Vec<Figure> {
    let one = |(table, name, joint_a, joint_b, widest): &Row| {
        (*table, *name, if subject == Subject::JointA { *joint_a } else { *joint_b }, *widest)
    };
    rows.iter().map(one).collect()
}

/// Runs the campaign in its order and tells of each chapter as it is done. `given` names what the bench was given, by the
/// names of the quantities.
pub fn reproduce(
    bench: &mut Bench,
    subject: Subject,
    given: &dyn Fn(&str) -> Option<f64>,
    done: &mut dyn FnMut(&Chapter),
) -> Result<Vec<Chapter>, ConductFault> {
    let mut chapters: Vec<Chapter> = Vec::new();
    for (id, parameters, figures) in campaign(subject) {
        let Some(procedure) = procedure(id) else { continue };
        let mut parameters = parameters.as_object().cloned().unwrap_or_default();
        if id == "compensation" {
            parameters.extend(chapters.iter().find(|c| c.procedure == "friction").into_iter().flat_map(stated));
        }
        let Conducted { identification, duration_s, .. } = conduct(bench, procedure, &parameters)?;
        let Some(identification) = identification else { continue };
        let comparisons = compare(&identification, &figures, given);
        let title = procedure.title();
        let chapter = Chapter { procedure: procedure.id(), title, parameters, identification, comparisons, duration_s };
        done(&chapter);
        chapters.push(chapter);
    }
    Ok(chapters)
}

fn compare(found: &Identification, figures: &[Figure], given: &dyn Fn(&str) -> Option<f64>) -> Vec<Comparison> {
    let one = |(table, name, document, widest): &Figure| {
        let found = found.quantity(name)?.clone();
        Some(Comparison { table, found, document: *document, given: given(name), widest: *widest })
    };
    figures.iter().filter_map(one).collect()
}

/// The friction that a compensation is to feed forward.
fn stated(friction: &Chapter) -> Vec<(String, Value)> {
    let names = [
        ("tau_c", "tau_c_nm"),
        ("c_v", "c_v_nm_s"),
        ("tau_h", "tau_h_nm"),
        ("omega_s", "stribeck_speed_rad_s"),
        ("delta_s", "stribeck_exponent"),
    ];
    let pair = |(from, to): (&str, &str)| Some((to.to_owned(), json!(friction.identification.quantity(from)?.value)));
    let mut stated: Vec<(String, Value)> = names.into_iter().filter_map(pair).collect();
    // Without a rise towards standstill friction there is Coulomb friction.
    if friction.identification.quantity("tau_h").is_none()
        && let Some(coulomb) = friction.identification.quantity("tau_c")
    {
        stated.push(("tau_h_nm".into(), json!(coulomb.value)));
    }
    stated
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identification::Verdict;

    fn friction(names: &[(&str, f64)]) -> Identification {
        let quantity = |(name, value): &(&str, f64)| Quantity {
            name: (*name).into(),
            symbol: String::new(),
            title: String::new(),
            unit: String::new(),
            value: *value,
            ci95: Some([0.99 * value, 1.01 * value]),
        };
        let quantities = names.iter().map(quantity).collect();
        let summary = String::new();
        Identification { verdict: Verdict::Identified, summary, advice: None, quantities, figures: Vec::new() }
    }

    #[test]
    fn an_interval_is_held_against_what_the_bench_was_given() {
        let found = friction(&[("tau_c", 0.0300), ("c_v", 1.6e-4)]);
        let given = |name: &str| (name == "tau_c").then_some(0.0302);
        let comparisons = compare(&found, &column(FRICTION, Subject::JointA), &given);
        assert_eq!(comparisons.iter().map(|c| c.document).collect::<Vec<_>>(), [0.030, 1.512e-4]);
        assert_eq!((comparisons[0].is_inside(), comparisons[0].is_narrow()), (Some(true), Some(true)));
        assert_eq!((comparisons[1].is_inside(), comparisons[1].is_narrow()), (None, Some(true)));
    }

    #[test]
    fn compensation_takes_what_friction_found() {
        let chapter = Chapter {
            procedure: "friction",
            title: "Friction",
            parameters: Map::new(),
            identification: friction(&[("tau_c", 0.03), ("c_v", 1.5e-4)]),
            comparisons: Vec::new(),
            duration_s: 1.0,
        };
        let stated: Map<String, Value> = stated(&chapter).into_iter().collect();
        assert_eq!(Value::Object(stated), json!({"tau_c_nm": 0.03, "c_v_nm_s": 1.5e-4, "tau_h_nm": 0.03}));
    }
}
