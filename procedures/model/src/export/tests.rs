use crate::UserEffect;
use crate::export::*;
use crate::formula::signals;
use crate::report::fit::{Preparation, ResidualKind, Scope, Term};
use crate::signal::Signals;
use crate::user_effects;
use crate::view::View;
use jointbench_instrument::Motion;
use std::process::Command;

const ROWS: usize = 240;
const STEP_S: f64 = 0.004;

/// Signals that move, reverse and cross zero.
fn moments(kind: Kind) -> Vec<(&'static str, Vec<f64>)> {
    let wave = |rate: f64, size: f64| (0..ROWS).map(|i| size * (rate * i as f64 + 0.3).sin()).collect::<Vec<f64>>();
    let values = |place: usize, signal: Signal| match signal {
        Signal::Time => (0..ROWS).map(|i| STEP_S * i as f64).collect(),
        Signal::Velocity => wave(0.05, 30.0),
        Signal::Direction => wave(0.05, 30.0).iter().map(|v| v.signum()).collect(),
        Signal::Temperature => wave(0.01, 10.0).iter().map(|t| t + 30.0).collect(),
        Signal::Load => wave(0.013, 2.0),
        Signal::Current => wave(0.031, 0.8),
        _ => wave(0.02 + 0.001 * place as f64, 1.5),
    };
    signals(kind).iter().enumerate().map(|(place, s)| (s.name, values(place, s.signal))).collect()
}

fn view(kind: Kind) -> View {
    let mut given = Signals::new(ROWS);
    for ((_, values), named) in moments(kind).into_iter().zip(signals(kind)) {
        given.set(named.signal, values);
    }
    // Three repeats, for effects that change between repeats.
    given.set(Signal::Repeat, (0..ROWS).map(|i| (i / 60) as f64).collect());
    given.set(Signal::Drive, moments(kind)[1].1.clone());
    let mut view = View::new(given.clone(), given, Vec::new(), vec![0], STEP_S);
    view.constants.weight = Some([0.3, -0.2]);
    view
}

/// The effects of a kind with their terms, each in its `n`-th form. Offset effects have no term.
fn terms_of_all(kind: Kind, n: usize, user_effects: &[UserEffect]) -> (Vec<String>, Vec<Term>) {
    let view = view(kind);
    let mut terms = Vec::new();
    let mut ids: Vec<String> = Vec::new();
    for effect in user_effects::with_user_effects(kind, user_effects) {
        let forms = effect.forms(&view);
        if effect.traits().is_offset {
            ids.push(effect.info().id.into());
        } else if !forms.is_empty() {
            let form = &forms[n % forms.len()];
            ids.push(effect.info().id.into());
            terms.push(Term {
                effect: effect.info().id.into(),
                form: form.name.into(),
                shape: form.grid[n % form.grid.len()].clone(),
                linear: (0..form.linear.len()).map(|k| 0.37 + 0.11 * k as f64).collect(),
                names: form.linear.iter().copied().chain(form.shape.iter().map(|s| s.name)).map(String::from).collect(),
            });
        }
    }
    (ids, terms)
}

fn parameters_of(terms: &[Term]) -> Vec<crate::Parameter> {
    let of_term = |term: &Term| {
        let values = term.linear.iter().chain(&term.shape);
        let parameter = |(name, value): (&String, &f64)| crate::Parameter {
            effect: term.effect.clone(),
            name: name.clone(),
            value: *value,
            unit: "Nm·s²/rad²".into(),
            ci95: [0.9 * value, 1.1 * value],
            state: crate::ParameterState::AtBound,
            note: Some("at its bound */ of 3 °C".into()),
        };
        term.names.iter().zip(values).map(parameter).collect::<Vec<_>>()
    };
    terms.iter().flat_map(of_term).collect()
}

fn scope(kind: Kind) -> Scope {
    let range = |(name, values): (&str, Vec<f64>)| SignalRange {
        name: name.into(),
        unit: "1".into(),
        min: values.iter().copied().fold(f64::INFINITY, f64::min),
        max: values.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        noise: None,
    };
    Scope {
        motion: Motion::Rotary,
        load_scale: 50.0,
        sample_s: STEP_S,
        constants: Vec::new(),
        fed_rms: None,
        means: Vec::new(),
        table_rms: None,
        signals: moments(kind).into_iter().map(range).collect(),
    }
}

/// A fit of all effects of a kind, each in its `n`-th form.
fn fit_of_all(kind: Kind, n: usize, user_effects: Vec<UserEffect>) -> Fit {
    let (effects, terms) = terms_of_all(kind, n, &user_effects);
    Fit {
        kind,
        effects,
        user_effects,
        settings: Vec::new(),
        rms: 1.0,
        validation_rms: 1.1,
        effects_rms: None,
        unit: kind.target_unit().into(),
        residual: ResidualKind::Raw,
        relative_error: 0.1,
        parameters: parameters_of(&terms),
        trade_offs: Vec::new(),
        condition: 1.0,
        notes: Vec::new(),
        preparation: Preparation {
            residual: ResidualKind::Raw,
            sample_rate_hz: 1.0 / STEP_S,
            cutoff_hz: None,
            velocity_lag_s: None,
            decimation: 1,
            bristles: None,
            chunk_s: None,
            samples: ROWS,
            rows: ROWS,
            blocks: 8,
            segments_from: "column".into(),
            repeats_from: "none".into(),
        },
        terms,
        form_error: Vec::new(),
        scope: Some(scope(kind)),
    }
}

fn rub() -> Vec<UserEffect> {
    let text = "rub: tau = a * tanh(velocity / w0) * abs(load) ^ 1.5 - b * min(load, 0.2 * wrap(9 * velocity)) + sign(velocity) * a; \
                a [1] 0..1; b [1]; w0 [rad/s] 0.1..10";
    vec![UserEffect::inline(Kind::Friction, text).unwrap()]
}

/// The fit without the effects that a controller cannot compute.
fn carried(mut fit: Fit) -> Fit {
    let left_out: Vec<String> =
        parts::Parts::of(&fit).unwrap().left_out.iter().map(|(effect, _)| (*effect).to_owned()).collect();
    fit.effects.retain(|e| !left_out.contains(e));
    fit.terms.retain(|t| !left_out.contains(&t.effect));
    fit
}

/// Compiles the header with a main function that prints the prediction at every moment.
fn run_c(fit: &Fit) -> Option<Vec<f64>> {
    let Ok(version) = Command::new("cc").arg("--version").output() else {
        println!("SKIPPED: there is no C compiler (cc) to hold the exported header against");
        return None;
    };
    assert!(version.status.success());
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let header = export(fit, Format::C).unwrap();
    assert!(header.is_ascii());
    let (name, moments) = (format!("joint_{}", fit.kind), moments(fit.kind));
    std::fs::write(folder.join(format!("{name}.h")), &header).unwrap();
    let mut rows = String::new();
    for i in 0..ROWS {
        let mut fields: Vec<String> = Vec::new();
        for ((_, values), signal) in moments.iter().zip(signals(fit.kind)) {
            let field = suffix::named(signal.name, signal.unit);
            if header.contains(&format!("double {field};")) {
                fields.push(format!(".{field} = {:e}", values[i]));
            }
        }
        if header.contains("double sample_s;") {
            fields.push(format!(".sample_s = {STEP_S:e}"));
        }
        rows += &format!("{{{}}},\n", fields.join(", "));
    }
    let (state, argument) = match header.contains("_state *s") {
        true => (format!("{name}_state s = {{0}};"), "&s, "),
        false => (String::new(), ""),
    };
    let main = format!(
        "#include \"{name}.h\"\n#include <stdio.h>\nstatic const {name}_input rows[] = {{\n{rows}}};\n\
         int main(void) {{ {state} for (int i = 0; i < {ROWS}; i++) \
         printf(\"%.17g\\n\", {name}_{}(&{name}_fitted, {argument}&rows[i])); return 0; }}\n",
        suffix::of(&fit.unit)
    );
    std::fs::write(folder.join("main.c"), main).unwrap();
    let program = folder.join("main");
    let flags = ["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror", "-O1", "-o"];
    let built = Command::new("cc").args(flags).arg(&program).arg(folder.join("main.c")).arg("-lm").output().unwrap();
    assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
    let reported = Command::new(&program).output().unwrap();
    Some(String::from_utf8(reported.stdout).unwrap().lines().map(|line| line.parse().unwrap()).collect())
}

#[test]
fn c_computes_what_the_model_computes() {
    for kind in Kind::ALL {
        for n in 0..3 {
            let user_effects = if kind == Kind::Friction { rub() } else { Vec::new() };
            let fit = carried(fit_of_all(kind, n, user_effects));
            let Some(found) = run_c(&fit) else { return };
            let truth = predict(&fit, &moments(kind), STEP_S).unwrap();
            assert_eq!(found.len(), truth.len());
            for (i, (c, model)) in found.iter().zip(&truth).enumerate() {
                assert!((c - model).abs() <= 1e-9 * model.abs().max(1.0), "{kind} {n} row {i}: {c} and {model}");
            }
        }
    }
}

/// Hysteresis effects in every form that a search can result in.
#[test]
fn c_remembers_as_the_model_does() {
    let (load, position) = ("torsional_hysteresis", "presliding");
    for (kind, effect, form, shape) in [
        (Kind::Friction, position, "dahl", &[0.3][..]),
        (Kind::Friction, position, "stop", &[0.3]),
        (Kind::Friction, position, "maxwell_slip", &[0.3]),
        (Kind::Friction, position, "lugre", &[0.3, 8.0, 0.4]),
        (Kind::Stiffness, load, "maxwell_slip", &[0.5]),
        (Kind::Stiffness, load, "stops", &[0.3, 0.9, 1.8]),
        (Kind::Stiffness, load, "dahl_and_stops", &[0.3, 0.9]),
        (Kind::Stiffness, load, "maxwell_slip_and_stops", &[0.3, 0.9, 1.8]),
    ] {
        let mut fit = fit_of_all(kind, 0, Vec::new());
        fit.effects = vec![effect.into()];
        fit.terms.retain(|t| t.effect == effect);
        let term = &mut fit.terms[0];
        (term.form, term.shape) = (form.into(), shape.into());
        let (coefficients, reaches): (&[&str], &[&str]) = match kind {
            Kind::Friction => (&["tau_p"], &["theta_p", "omega_s", "rho"]),
            _ => (&["eta", "eta_2", "eta_3"], &["tau_eta", "tau_eta_2", "tau_eta_3"]),
        };
        let coefficients = &coefficients[..shape.len().min(coefficients.len())];
        term.linear = (0..coefficients.len()).map(|k| 0.37 + 0.11 * k as f64).collect();
        term.names = coefficients.iter().chain(&reaches[..shape.len()]).map(|name| (*name).to_owned()).collect();
        let Some(found) = run_c(&fit) else { return };
        let truth = predict(&fit, &moments(kind), STEP_S).unwrap();
        let largest = truth.iter().fold(0.0f64, |m, v| m.max(v.abs()));
        assert!(largest > 0.1, "{form}: nothing moved");
        for (i, (c, model)) in found.iter().zip(&truth).enumerate() {
            assert!((c - model).abs() <= 1e-9, "{effect} {form} row {i}: {c} and {model}");
        }
    }
}

#[test]
fn little_is_left_out_and_that_is_named() {
    let left_out = |kind| {
        let mut all: Vec<String> = Vec::new();
        for n in 0..3 {
            let fit = fit_of_all(kind, n, Vec::new());
            let parts = parts::Parts::of(&fit).unwrap();
            let header = export(&fit, Format::C).unwrap();
            for (effect, _) in &parts.left_out {
                assert!(header.contains(&format!("NOT CARRIED OVER: {effect}")), "{header}");
                all.push((*effect).to_owned());
            }
        }
        all.sort();
        all.dedup();
        all
    };
    assert_eq!(left_out(Kind::Friction), [""; 0], "effects without `symbolic`");
    assert_eq!(left_out(Kind::Encoder), ["startup_offset"]);
    assert_eq!(left_out(Kind::Stiffness), [""; 0], "effects without `symbolic`");
    assert_eq!(left_out(Kind::Brake), ["temperature_dependence", "velocity_dependence"]);
}

#[test]
fn only_ranges_of_inputs_are_reported() {
    let mut fit = fit_of_all(Kind::Friction, 0, Vec::new());
    fit.effects.retain(|e| ["inertia", "coulomb", "viscous"].contains(&e.as_str()));
    fit.terms.retain(|t| fit.effects.contains(&t.effect));
    let reported = |format| -> Vec<String> {
        let text = export(&fit, format).unwrap();
        let ranges = text.split("Fitted where ").skip(1);
        ranges.filter_map(|rest| rest.split(' ').next().map(str::to_owned)).collect()
    };
    assert_eq!(reported(Format::C), ["velocity", "acceleration"]);
    assert_eq!(reported(Format::Mujoco), ["velocity", "acceleration"]);
    assert_eq!(reported(Format::Urdf), ["velocity"], "URDF has no armature");
}

#[test]
fn what_comes_back_predicts_the_same_bits() {
    for kind in Kind::ALL {
        let user_effects = if kind == Kind::Friction { rub() } else { Vec::new() };
        let mut fit = fit_of_all(kind, 1, user_effects);
        fit.terms.iter_mut().flat_map(|t| &mut t.linear).for_each(|v| *v = (*v / 3.0).exp());
        fit.condition = f64::INFINITY;
        let text = export(&fit, Format::Json).unwrap();
        let again = ModelFile::read(&text).unwrap();
        assert_eq!(again, fit);
        let bits = |fit: &Fit| -> Vec<u64> {
            predict(&carried(fit.clone()), &moments(kind), STEP_S).unwrap().iter().map(|v| v.to_bits()).collect()
        };
        assert_eq!(bits(&again), bits(&fit), "{kind}");
    }
}

#[test]
fn a_file_that_is_none_is_refused() {
    let good = export(&fit_of_all(Kind::Friction, 0, rub()), Format::Json).unwrap();
    for (bad, words) in [
        (String::from("{"), "EOF"),
        (good.replace("jointbench-model", "other"), "this program reads"),
        (good.replace("\"version\": 1", "\"version\": 9"), "version 9"),
        (good.replace("\"coulomb\"", "\"coulomp\""), "coulomp is not known"),
        (good.replace("tanh(velocity", "thanh(velocity"), "did you mean tanh"),
        (good.replacen("\"rms\": 1.0", "\"rms\": \"x\"", 1), "invalid type"),
    ] {
        let error = ModelFile::read(&bad).unwrap_err().to_string();
        assert!(error.contains(words), "{words}: {error}");
    }
}

#[test]
fn a_table_holds_the_settled_value() {
    let mut fit = fit_of_all(Kind::Friction, 0, rub());
    let left_out = ["presliding", "gravity"];
    let held = ["load_transmission", "coulomb", "stribeck", "rub"];
    fit.effects.retain(|e| held.iter().chain(&left_out).any(|of| of == e));
    fit.terms.retain(|t| fit.effects.contains(&t.effect));
    let text = export(&fit, Format::Table).unwrap();
    for effect in left_out {
        assert!(text.contains(&format!("# NOT CARRIED OVER: {effect}")), "{text}");
    }
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    assert_eq!(lines.next(), Some("velocity_rad_s,load_nm,motor_torque_nm"));
    let rows: Vec<Vec<f64>> = lines.map(|l| l.split(',').map(|f| f.parse().unwrap()).collect()).collect();
    assert_eq!(rows.len(), 62 * 21);
    fit.effects.retain(|e| !left_out.contains(&e.as_str()));
    fit.terms.retain(|t| !left_out.contains(&t.effect.as_str()));
    let column = |k: usize| rows.iter().map(|r| r[k]).collect::<Vec<f64>>();
    let direction = column(0).iter().map(|v| v.signum()).collect();
    let given = [("velocity", column(0)), ("load", column(1)), ("direction", direction)];
    assert_eq!(predict(&fit, &given, STEP_S).unwrap(), column(2));
}

#[test]
fn simulators_get_what_they_have_attributes_for() {
    let mut fit = fit_of_all(Kind::Friction, 0, Vec::new());
    let parameter = |effect: &str, name: &str, value: f64| crate::Parameter {
        effect: effect.into(),
        name: name.into(),
        value,
        unit: "1".into(),
        ci95: [value, value],
        state: crate::ParameterState::Ok,
        note: None,
    };
    fit.effects = ["load_transmission", "inertia", "coulomb", "viscous", "stribeck"].map(String::from).into();
    fit.parameters =
        vec![parameter("inertia", "j", 2e-6), parameter("coulomb", "tau_c", 0.02), parameter("viscous", "c_v", 1e-4)];
    let mujoco = export(&fit, Format::Mujoco).unwrap();
    assert!(mujoco.contains(r#"<joint frictionloss="1" damping="0.25" armature="0.005"/>"#), "{mujoco}");
    assert!(mujoco.contains("NOT CARRIED OVER: stribeck"), "{mujoco}");
    let urdf = export(&fit, Format::Urdf).unwrap();
    assert!(urdf.contains(r#"<dynamics damping="0.25" friction="1"/>"#), "{urdf}");
    assert!(urdf.contains("NOT CARRIED OVER: inertia (URDF has no armature"), "{urdf}");
    let other = export(&fit_of_all(Kind::Brake, 0, Vec::new()), Format::Urdf).unwrap_err();
    assert!(other.to_string().contains("only friction models"), "{other}");
    let other = export(&fit_of_all(Kind::Stiffness, 0, Vec::new()), Format::Mujoco).unwrap_err();
    assert!(other.to_string().contains("a second hinge about the same axis"), "{other}");
}
