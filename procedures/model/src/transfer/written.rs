//! The library's effects once more, as text: what a controller computes.
//!
//! Formulas are in the language of users' effects, with the shape parameters of the form as their parameters, so one
//! printer serves both. A test holds every line against the effect that it copies.

use crate::report::Term;
use jointbench_instrument::Kind;

/// What a factor multiplies.
#[derive(Debug, Clone, PartialEq)]
pub enum Column {
    Formula(String),
    /// A formula in which `z` is a state that remembers a signal.
    Memory {
        rule: Rule,
        signal: &'static str,
        formula: &'static str,
    },
    /// Stops weighted by hats over their reach (Prandtl–Ishlinskii).
    Band {
        stops: usize,
        bands: usize,
        band: usize,
    },
}

/// How a state follows its signal. The shape parameter of the form is its reach, or its time constant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rule {
    Dahl,
    Stop,
    Lag,
}

/// Columns of a term. `None` where a controller has not what the effect needs.
pub fn written(kind: Kind, term: &Term) -> Option<Vec<Column>> {
    let formula = |text: &str| Some(vec![Column::Formula(text.to_owned())]);
    let memory = |rule, signal, formula| Some(vec![Column::Memory { rule, signal, formula }]);
    let rule = if term.form == "stop" { Rule::Stop } else { Rule::Dahl };
    match (kind, term.effect.as_str(), term.form.as_str()) {
        // States of several elements, or of two signals: more than one rule can follow.
        (_, _, "maxwell_slip" | "lugre" | "stops" | "dahl_and_stops" | "maxwell_slip_and_stops") => None,
        (Kind::Friction, id, form) => match (id, form) {
            ("inertia", _) => formula("acceleration"),
            ("coulomb", _) => formula("direction"),
            ("viscous", _) => formula("velocity"),
            ("stribeck", _) => formula("exp(-(abs(velocity) / omega_s) ^ delta) * direction"),
            ("direction_offset", _) => formula("1"),
            ("viscous_asymmetry", _) => formula("abs(velocity)"),
            ("viscous_quadratic", "one_sided") => formula("velocity * velocity"),
            ("viscous_quadratic", _) => formula("velocity * abs(velocity)"),
            ("viscous_sublinear", "limited") => formula("(1 - exp(-abs(velocity) / omega_l)) * direction"),
            ("viscous_sublinear", _) => formula("abs(velocity) ^ alpha * direction"),
            ("load_linear", _) => formula("abs(load) * direction"),
            ("load_quadratic", _) => formula("load * load * direction"),
            ("load_viscous", _) => formula("abs(load) * velocity"),
            ("stribeck_load", _) => formula("exp(-(abs(velocity) / omega_s) ^ delta) * direction * abs(load)"),
            ("temperature_viscous", _) => formula("(temperature - 25) * velocity"),
            ("temperature_coulomb", _) => formula("(temperature - 25) * direction"),
            ("gravity", _) => Some(waves("link_position", "", &["1".to_owned()])),
            ("cogging", _) => Some(waves("position", "", &orders(term))),
            ("friction_ripple", "with_speed") => {
                let mut columns = waves("link_position", " * direction", &orders(term));
                columns.extend(waves("link_position", " * velocity", &orders(term)));
                Some(columns)
            }
            ("friction_ripple", _) => Some(waves("link_position", " * direction", &orders(term))),
            ("torque_constant_saturation", _) => formula("motor_torque * motor_torque * motor_torque"),
            ("drift", _) => formula("time"),
            ("presliding", _) => memory(rule, "position", "z - direction"),
            ("signal_delay", _) => formula("jerk"),
            _ => None,
        },
        (Kind::Encoder, id, _) => match id {
            "offset" => formula("1"),
            "delay" => formula("-velocity"),
            "harmonic_1" => Some(waves("position", "", &["1".to_owned()])),
            "harmonic_2" => Some(waves("position", "", &["2".to_owned()])),
            "harmonic_n" => Some(waves("position", "", &orders(term))),
            "pole_period" => Some(waves("position", "", &["pole_pairs".to_owned(), "2 * pole_pairs".to_owned()])),
            "direction_hysteresis" => formula("direction"),
            "temperature_drift" => formula("temperature - 25"),
            "slip" => formula("max(sign(time - t_s), 0)"),
            // A controller does not know which power-up of the recording it has.
            _ => None,
        },
        (Kind::Stiffness, id, form) => match (id, form) {
            ("offset", _) => formula("1"),
            ("compliance", _) => formula("load"),
            ("directional_offset", _) => formula("direction"),
            ("backlash", _) => formula("tanh(load / tau_b)"),
            ("hardening", "cubic") => formula("load * load * load"),
            ("hardening", "root") => formula("(sqrt(1 + abs(load) / tau_h) - 1) * sign(load)"),
            ("hardening", _) => formula("load / (tau_h^n + abs(load)^n)^(1 / n)"),
            ("torsional_hysteresis", _) => memory(rule, "load", "z"),
            ("transmission_error", _) => Some(waves("link_position", "", &orders(term))),
            ("temperature_compliance", _) => formula("(temperature - 25) * load"),
            ("creep", _) => memory(Rule::Lag, "load", "z - load"),
            ("delay", _) => formula("velocity"),
            _ => None,
        },
        (Kind::Brake, id, form) => match (id, form) {
            ("drag", _) => formula("1"),
            ("torque_per_current", _) => formula("current"),
            ("saturation", "polynomial") => {
                Some(["current * current", "current * current * current"].map(|f| Column::Formula(f.into())).into())
            }
            ("saturation", "quintic") => {
                let power = |n: usize| Column::Formula(vec!["current"; n].join(" * "));
                Some([2, 3, 4, 5].map(power).into())
            }
            ("saturation", "curve") => {
                Some((2..).take(term.linear.len()).map(|n| Column::Formula(from_zero(n))).collect())
            }
            ("saturation", "tanh") => formula("tanh(current / i_s)"),
            ("saturation", _) => formula("tanh((current - i_0) / i_s) + tanh(i_0 / i_s)"),
            ("hysteresis", "bands" | "bands_3" | "bands_5") => {
                let bands = term.linear.len();
                Some((0..bands).map(|band| Column::Band { stops: 6 * bands, bands, band }).collect())
            }
            ("hysteresis", _) => memory(rule, "current", "z + 1"),
            ("velocity_dependence", "plain") => formula("abs(velocity)"),
            ("velocity_dependence", "excited") => formula("abs(velocity) * current"),
            ("cogging", "excited") => Some(waves("position", " * current", &orders(term))),
            ("cogging", _) => Some(waves("position", "", &orders(term))),
            ("temperature_dependence", "plain") => formula("temperature - 25"),
            ("temperature_dependence", "excited") => formula("(temperature - 25) * current"),
            // The torque that current and history explain is known for a recording only.
            _ => None,
        },
    }
}

/// Chebyshev polynomial beside its value without current.
fn from_zero(degree: usize) -> String {
    let sign = if degree.is_multiple_of(2) { '-' } else { '+' };
    format!("({} {sign} 1)", chebyshev(degree))
}

/// Chebyshev polynomial over the range of currents, by Horner's rule.
fn chebyshev(degree: usize) -> String {
    let next = |before: &[i64], now: &[i64]| -> Vec<i64> {
        let at = |c: &[i64], k: Option<usize>| k.and_then(|k| c.get(k)).copied().unwrap_or(0);
        (0..=now.len()).map(|k| 2 * at(now, k.checked_sub(1)) - at(before, Some(k))).collect()
    };
    let (_, factors) = (1..degree).fold((vec![1], vec![0, 1]), |(before, now), _| (now.clone(), next(&before, &now)));
    let rest = factors.iter().rev().map(i64::to_string);
    rest.reduce(|inner, factor| format!("({inner}) * (2 * current / i_max - 1) + {factor}")).unwrap_or_default()
}

/// Names of the orders of a term: `harmonic`, `harmonic_2` and so on.
fn orders(term: &Term) -> Vec<String> {
    (1..=term.shape.len()).map(|k| if k == 1 { "harmonic".to_owned() } else { format!("harmonic_{k}") }).collect()
}

fn waves(angle: &str, times: &str, orders: &[String]) -> Vec<Column> {
    let wave = |function: &str, order: &String| Column::Formula(format!("{function}({order} * {angle}){times}"));
    orders.iter().flat_map(|order| [wave("cos", order), wave("sin", order)]).collect()
}
