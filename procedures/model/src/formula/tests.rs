use crate::formula::*;
use crate::signal::{Signal, Signals};

fn parse(text: &str, parameters: &[&str]) -> Result<Formula, Mistake> {
    Formula::parse(Kind::Friction, text, parameters, &vec!["1"; parameters.len()])
}

/// An error that starts at `§`, with some words of its message.
fn check_mistake(marked: &str, parameters: &[&str], words: &str) {
    let text = marked.replacen('§', "", 1);
    let at = marked.find('§').unwrap();
    let mistake = parse(&text, parameters).unwrap_err();
    assert!(mistake.at.start == at && mistake.message.contains(words), "{marked}: {mistake:?}");
}

#[test]
fn every_error_has_its_character() {
    let p = &["a", "w0"];
    check_mistake("tau = a * tanh(§velocty / w0)", p, "did you mean velocity");
    check_mistake("tau = a * tanh(§motor_velocity_rad_s)", p, "write velocity");
    check_mistake("tau = a * §w1", p, "load");
    check_mistake("tau = a * §oil_pressure_pa", p, "write column(oil_pressure_pa)");
    check_mistake("tau = a * §column(2 * load)", p, "column takes the name");
    check_mistake("tau = a * §column(x, y)", p, "such as column(oil_pressure_pa)");
    check_mistake("tau = a * column(§velocity)", p, "velocity is no column");
    check_mistake("tau = a * column(§w0)", p, "w0 is no column");
    check_mistake("tau = a * column(§motor_current_a)", p, "explains nothing");
    check_mistake("tau = a * §thanh(load)", p, "did you mean tanh");
    check_mistake("tau = a * §sinc(load)", p, "did you mean sin?");
    check_mistake("tau = a * §bessel(load)", p, "there are abs, sign");
    check_mistake("tau = a * §tanh + 1", p, "arguments in brackets");
    check_mistake("tau = a * §tanh(load, 2)", p, "takes 1 argument, not 2");
    check_mistake("tau = a * §min(load)", p, "takes 2 arguments, not 1");
    check_mistake("tau = a * §", p, "a function or a bracket");
    check_mistake("tau = a * (load §", p, "closing bracket");
    check_mistake("tau = a * load§)", p, "operator");
    check_mistake("tau = a * min(load §velocity)", p, "comma");
    check_mistake("tau = a * min(load, §)", p, "expected");
    check_mistake("tau = 2§x", p, "operator");
    check_mistake("tau = a §$ load", p, "operator");
    check_mistake(" §", p, "left-hand side");
    check_mistake("tau §a * load", p, "= after");
    check_mistake("§torque = a * load", p, "begins with tau");
    check_mistake("tau = §load", &[], "multiply it");
    check_mistake("tau = a * load + §abs(velocity)", p, "this part of the sum");
    check_mistake("tau = §tanh(a * velocity)", p, "multiply it");
    check_mistake("tau = a * §temperatur", p, "did you mean temperature");
    assert_eq!(parse("tau = a * ω", &["a"]).unwrap_err().at, 10..12, "bytes, not characters");
    assert_eq!(parse(&format!("tau = {}", "1".repeat(900)), &[]).unwrap_err().at.start, 400);
}

#[test]
fn a_formula_may_use_a_column_of_the_run() {
    let formula = parse("tau = a * column(oil_pressure_pa) * column(temperature_c)", &["a"]).unwrap();
    let named: Vec<_> = formula.signals.iter().map(|s| (s.name, s.unit, s.signal)).collect();
    let (oil, known) = (Signal::Column("oil_pressure_pa"), Signal::Temperature);
    assert_eq!(named, [("temperature", "°C", known), ("oil_pressure_pa", "Pa", oil)]);
    let doubt = |units: &[&str]| {
        Formula::parse(Kind::Friction, "tau = a * column(oil_pressure_pa)", &["a"], units)
            .unwrap()
            .unit_fault(None)
            .cloned()
    };
    assert!(doubt(&["Nm/Pa"]).is_none() && doubt(&["Nm"]).is_some_and(|d| d.message.contains("tau is in Nm")));
}

#[test]
fn what_nests_deeply_is_read_or_refused() {
    assert_eq!(parse(&format!("tau = {}a", "-".repeat(380)), &["a"]).unwrap().columns.len(), 1);
    for text in ["(".repeat(380), "sin(".repeat(90), "a^".repeat(180)] {
        let whole = format!("tau = {text}a");
        assert!(parse(&whole, &["a"]).is_err(), "{whole}");
    }
    assert!(parse(&format!("tau = {}a*load{}", "(".repeat(180), ")".repeat(180)), &["a"]).is_ok());
}

/// Rows of `load` and `velocity`, and the value with every parameter given.
fn check_value(text: &str, parameters: &[(&str, f64)], truth: impl Fn(f64, f64) -> f64) {
    let names: Vec<&str> = parameters.iter().map(|p| p.0).collect();
    let values: Vec<f64> = parameters.iter().map(|p| p.1).collect();
    let formula = parse(text, &names).unwrap();
    let rows = [(-2.0, 3.0), (0.5, -7.0), (4.0, 0.25)];
    let mut signals = Signals::new(rows.len());
    signals.set(Signal::Load, rows.map(|r| r.0).into());
    signals.set(Signal::Velocity, rows.map(|r| r.1).into());
    let mut sum = vec![0.0; rows.len()];
    for (coefficient, column) in &formula.columns {
        let column = column.column(&values, &signals);
        sum.iter_mut().zip(column).for_each(|(s, c)| *s += values[*coefficient] * c);
    }
    for ((load, velocity), found) in rows.into_iter().zip(sum) {
        let truth = truth(load, velocity);
        assert!((found - truth).abs() <= 1e-14 * truth.abs(), "{text}: {found} and {truth}");
    }
}

#[test]
fn operators_bind_as_everywhere() {
    check_value("tau = a*-load^2", &[("a", 3.0)], |l, _| 3.0 * -(l * l));
    check_value("tau = a*2^3^load", &[("a", 3.0)], |l, _| 3.0 * 2f64.powf(3f64.powf(l)));
    check_value("tau = a*(load - velocity - 1)", &[("a", 3.0)], |l, v| 3.0 * (l - v - 1.0));
    check_value("tau = a*load/velocity/2", &[("a", 3.0)], |l, v| 3.0 * l / v / 2.0);
    check_value("tau = a*load**2 * 1.5e-3 + .5*a", &[("a", 3.0)], |l, _| 3.0 * (l * l * 1.5e-3 + 0.5));
    check_value("tau = a * min(load, velocity) * sign(velocity)", &[("a", 2.0)], |l, v| 2.0 * l.min(v) * v.signum());
}

#[test]
fn linear_parameters_are_separated_from_nonlinear_ones() {
    let split = |text: &str, parameters: &[&str]| {
        let formula = parse(text, parameters).unwrap();
        let linear: Vec<usize> = formula.columns.iter().map(|c| c.0).collect();
        (linear, formula.shape)
    };
    assert_eq!(split("tau = a * tanh(velocity / w0) * abs(load)", &["a", "w0"]), (vec![0], vec![1]));
    assert_eq!(split("tau = a*(b*load + c*velocity)", &["a", "b", "c"]), (vec![1, 2], vec![0]));
    assert_eq!(split("tau = a*load + b*velocity - (c - a)*load^2", &["a", "b", "c"]), (vec![0, 1, 2], vec![]));
    check_value("tau = a*load - (c - a)*load^2 + a/2", &[("a", 3.0), ("c", 5.0)], |l, _| 3.0 * l - 2.0 * l * l + 1.5);
}

#[test]
fn a_wave_is_known() {
    assert!(parse("tau = a * cos(7 * position)", &["a"]).unwrap().is_periodic);
    assert!(!parse("tau = a * cos(b) * velocity", &["a", "b"]).unwrap().is_periodic);
}

/// Parameters a, b and w with these units; the contradiction is at `§`.
fn check_units(kind: Kind, marked: &str, units: [&str; 3], words: &str) {
    let text = marked.replacen('§', "", 1);
    let found = Formula::parse(kind, &text, &["a", "b", "w"], &units);
    match marked.find('§') {
        None => assert_eq!(found.unwrap().unit_fault(None), None, "{marked}"),
        Some(at) => {
            let mistake = found.unwrap().unit_fault(None).cloned().unwrap_or_else(|| panic!("{marked}"));
            assert!(mistake.at.start == at && mistake.message.contains(words), "{marked}: {mistake:?}");
        }
    }
}

#[test]
fn contradicting_units_are_reported_at_their_position() {
    let torque = ["Nm", "Nm·s/rad", "rad/s"];
    let check = |marked: &str, units, words: &str| check_units(Kind::Friction, marked, units, words);
    check("tau = a * tanh(velocity / w) + b * velocity", torque, "");
    check("tau = a * tanh(§velocity / w)", ["Nm", "1", "s"], "tanh takes a plain number, but this is in 1/s²");
    check("tau = §a * velocity", torque, "tau is in Nm, but this is in Nm/s");
    check("tau = a + §b * velocity^2", torque, "this is in Nm/s, but a is in Nm");
    check("tau = a * 2^§load", torque, "an exponent takes a plain number, but this is in Nm");
    check("tau = a * max(load, §velocity)", torque, "but load is in Nm");
    check("tau = §a * sqrt(load) * wrap(position - 3)", torque, "this is in Nm^1.5");
    check("tau = a * sign(velocity - w) * abs(direction) + a * sqrt((velocity/w)^2)", torque, "");
    check("tau = §a * exp(-b * (temperature - w)) * load", ["1/K", "1/°C", "°C"], "this is in Nm/K");
    check("tau = a * exp(-b * (temperature - w)) * load", ["1", "1/°C", "°C"], "");
}

#[test]
fn unknown_units_are_accepted() {
    check_units(Kind::Friction, "tau = a * tanh(velocity / 0.3)", ["Nm", "1", "1"], "");
    check_units(Kind::Friction, "§tau = a * velocity", ["furlong", "1", "1"], "[furlong] is none");
    check_units(Kind::Friction, "§tau = a * sign(velocity)", ["mNm", "1", "1"], "not converted");
    check_units(Kind::Friction, "tau = a * velocity + b", ["1", "Nm", "1"], "");
    check_units(Kind::Friction, "tau = a * abs(velocity)^w", ["Nm", "1", "1"], "");
    check_units(Kind::Friction, "tau = a * tanh(velocity / w)", ["N", "1", "m/s"], "a joint that slides");
    check_units(Kind::Encoder, "error = a * cos(position) + b * velocity", ["rad", "s", "1"], "");
    check_units(Kind::Brake, "tau = a * current^2 + b * current", ["Nm/A²", "Nm·A⁻¹", "1"], "");
    check_units(Kind::Stiffness, "torsion = a * load", ["rad/Nm", "1", "1"], "");
}

#[test]
fn an_angle_is_wrapped_to_half_a_turn() {
    use std::f64::consts::PI;
    for (angle, within) in [(0.5, 0.5), (7.0, 7.0 - 2.0 * PI), (-4.0, 2.0 * PI - 4.0), (63.0, 63.0 - 20.0 * PI)] {
        let found = Function::Wrap.apply(angle, 0.0);
        assert!((found - within).abs() < 1e-12, "{angle}: {found}");
    }
}
