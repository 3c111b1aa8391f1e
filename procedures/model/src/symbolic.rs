//! The effects of the library as text for a controller.
//!
//! The formulas use the language of user effects, with the nonlinear parameters of the form as their parameters, so
//! that both share one printer. A test compares every formula with its effect.

use crate::effects::encoder::pole_period::FUNDAMENTAL;
use crate::report::fit::Term;
use jointbench_instrument::Kind;

/// A regressor, multiplied by its coefficient.
#[derive(Debug, Clone, PartialEq)]
pub enum Column {
    Formula(String),
    /// A formula in which `z` is a state that follows a signal. All columns of an effect follow the same signal.
    Memory {
        rule: Rule,
        signal: &'static str,
        /// Number of the nonlinear parameter that is its reach, or its time constant.
        reach: usize,
        /// Limit of a Dahl state; other states do not use it.
        end: &'static str,
        formula: &'static str,
    },
    /// Stop operators weighted by hat functions over their reach (Prandtl–Ishlinskii).
    Band {
        stops: usize,
        bands: usize,
        band: usize,
    },
}

/// How a state follows its signal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rule {
    Dahl,
    Stop,
    /// The mean of stop operators with reaches evenly spaced up to the largest.
    MaxwellSlip,
    Lag,
}

/// Torque that the gear teeth transmit if the sensor does not measure the weight.
const TEETH: &str = "load + g_c * cos(link_position) + g_s * sin(link_position)";

const UNKNOWN: &str = "its form is not written out for a controller";

/// Columns of a term, or why a controller cannot compute them.
pub fn written(kind: Kind, term: &Term) -> Result<Vec<Column>, &'static str> {
    let formula = |text: &str| Ok(vec![Column::Formula(text.to_owned())]);
    let part = |reach, rule, signal, formula| Column::Memory { rule, signal, reach, end: "1", formula };
    let memory = |rule, signal, formula| Ok(vec![part(0, rule, signal, formula)]);
    let rule = match term.form.as_str() {
        "stop" | "stops" => Rule::Stop,
        "maxwell_slip" | "maxwell_slip_and_stops" => Rule::MaxwellSlip,
        _ => Rule::Dahl,
    };
    match (kind, term.effect.as_str(), term.form.as_str()) {
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
            ("load_linear", "with_weight") => formula(&format!("abs({TEETH}) * direction")),
            ("load_quadratic", "with_weight") => formula(&format!("({TEETH})^2 * direction")),
            ("load_viscous", "with_weight") => formula(&format!("abs({TEETH}) * velocity")),
            ("load_linear", _) => formula("abs(load) * direction"),
            ("load_quadratic", _) => formula("load * load * direction"),
            ("load_viscous", _) => formula("abs(load) * velocity"),
            ("stribeck_load", _) => formula("exp(-(abs(velocity) / omega_s) ^ delta) * direction * abs(load)"),
            ("temperature_viscous", _) => formula("(temperature - 25) * velocity"),
            ("temperature_coulomb", _) => formula("(temperature - 25) * direction"),
            ("gravity", _) => Ok(waves("link_position", "", &["1".to_owned()])),
            ("cogging", _) => Ok(waves("position", "", &orders(term))),
            ("friction_ripple", "with_speed") => {
                let mut columns = waves("link_position", " * direction", &orders(term));
                columns.extend(waves("link_position", " * velocity", &orders(term)));
                Ok(columns)
            }
            ("friction_ripple", _) => Ok(waves("link_position", " * direction", &orders(term))),
            ("torque_constant_saturation", "power") => formula("abs(motor_torque) ^ n * motor_torque"),
            ("torque_constant_saturation", _) => formula("motor_torque * motor_torque * motor_torque"),
            ("drift", "settling") => formula("1 - exp(-time / t_d)"),
            ("drift", _) => formula("time"),
            ("presliding", "lugre") => Ok(vec![Column::Memory {
                rule,
                signal: "position",
                reach: 0,
                end: "1 + rho * exp(-(velocity / omega_s) ^ 2)",
                formula: "z - (1 + rho * exp(-(velocity / omega_s) ^ 2)) * direction",
            }]),
            ("presliding", _) => memory(rule, "position", "z - direction"),
            ("signal_delay", _) => formula("jerk"),
            _ => Err(UNKNOWN),
        },
        (Kind::Encoder, "pole_period", FUNDAMENTAL) => Ok(waves("position", "", &["pole_pairs".to_owned()])),
        (Kind::Encoder, id, _) => match id {
            "offset" => formula("1"),
            "delay" => formula("-velocity"),
            "harmonic_1" => Ok(waves("position", "", &["1".to_owned()])),
            "harmonic_2" => Ok(waves("position", "", &["2".to_owned()])),
            "harmonic_n" => Ok(waves("position", "", &orders(term))),
            "pole_period" => Ok(waves("position", "", &["pole_pairs".to_owned(), "2 * pole_pairs".to_owned()])),
            "direction_hysteresis" => formula("direction"),
            "temperature_drift" => formula("temperature - 25"),
            "slip" => formula("max(sign(time - t_s), 0)"),
            "startup_offset" => {
                Err("it has an offset for each power-up of the recording, and a controller's own is another")
            }
            _ => Err(UNKNOWN),
        },
        (Kind::Stiffness, id, form) => match (id, form) {
            ("offset", _) => formula("1"),
            ("compliance", _) => formula("load"),
            ("directional_offset", _) => formula("direction"),
            ("backlash", _) => formula("tanh(load / tau_b)"),
            ("hardening", "cubic") => formula("load * load * load"),
            ("hardening", "root") => formula("(sqrt(1 + abs(load) / tau_h) - 1) * sign(load)"),
            ("hardening", _) => formula("load / (tau_h^n + abs(load)^n)^(1 / n)"),
            ("torsional_hysteresis", _) => {
                let stops = (1..term.shape.len()).map(|k| part(k, Rule::Stop, "load", "z"));
                Ok(std::iter::once(part(0, rule, "load", "z")).chain(stops).collect())
            }
            ("transmission_error", _) => Ok(waves("link_position", "", &orders(term))),
            ("temperature_compliance", _) => formula("(temperature - 25) * load"),
            ("creep", _) => memory(Rule::Lag, "load", "z - load"),
            ("delay", _) => formula("velocity"),
            _ => Err(UNKNOWN),
        },
        (Kind::Brake, id, form) => match (id, form) {
            ("drag", _) => formula("1"),
            ("torque_per_current", _) => formula("current"),
            ("saturation", "polynomial") => {
                Ok(["current * current", "current * current * current"].map(|f| Column::Formula(f.into())).into())
            }
            ("saturation", "quintic") => {
                let power = |n: usize| Column::Formula(vec!["current"; n].join(" * "));
                Ok([2, 3, 4, 5].map(power).into())
            }
            ("saturation", "curve") => {
                Ok((2..).take(term.linear.len()).map(|n| Column::Formula(from_zero(n))).collect())
            }
            ("saturation", "tanh") => formula("tanh(current / i_s)"),
            ("saturation", _) => formula("tanh((current - i_0) / i_s) + tanh(i_0 / i_s)"),
            ("hysteresis", "bands" | "bands_3" | "bands_5") => {
                let bands = term.linear.len();
                Ok((0..bands).map(|band| Column::Band { stops: 6 * bands, bands, band }).collect())
            }
            ("hysteresis", _) => memory(rule, "current", "z + 1"),
            ("velocity_dependence", "plain") => formula("abs(velocity)"),
            ("velocity_dependence", "excited") => formula("abs(velocity) * current"),
            ("cogging", "excited") => Ok(waves("position", " * current", &orders(term))),
            ("cogging", _) => Ok(waves("position", "", &orders(term))),
            ("temperature_dependence", "plain") => formula("temperature - 25"),
            ("temperature_dependence", "excited") => formula("(temperature - 25) * current"),
            ("velocity_dependence" | "temperature_dependence", _) => {
                Err("it grows with the torque that current and history explain, which is known for a recording only")
            }
            _ => Err(UNKNOWN),
        },
    }
}

/// Chebyshev polynomial minus its value at zero current.
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
    let (_, coefficients) =
        (1..degree).fold((vec![1], vec![0, 1]), |(before, now), _| (now.clone(), next(&before, &now)));
    let rest = coefficients.iter().rev().map(i64::to_string);
    rest.reduce(|inner, coefficient| format!("({inner}) * (2 * current / i_max - 1) + {coefficient}"))
        .unwrap_or_default()
}

/// Names of the orders of a term: `harmonic`, `harmonic_2` and so on.
fn orders(term: &Term) -> Vec<String> {
    (1..=term.shape.len()).map(|k| if k == 1 { "harmonic".to_owned() } else { format!("harmonic_{k}") }).collect()
}

fn waves(angle: &str, times: &str, orders: &[String]) -> Vec<Column> {
    let wave = |function: &str, order: &String| Column::Formula(format!("{function}({order} * {angle}){times}"));
    orders.iter().flat_map(|order| [wave("cos", order), wave("sin", order)]).collect()
}
