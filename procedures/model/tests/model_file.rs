//! A modified model file is refused with a message or used as it is, without a panic.

mod common;

use common::tables::{Shape, table};
use jointbench_instrument::{Kind, RunTable};
use jointbench_model::export::{Format, ModelFile, export};
use jointbench_model::{Fit, ModelSpec, Options, UserEffect, evaluate, fit};
use proptest::prelude::*;
use serde_json::{Value, json};
use std::sync::LazyLock;

/// A run of each kind with a model of its baseline and an effect with nonlinear parameters or several columns.
static FITTED: LazyLock<Vec<(RunTable, Value)>> = LazyLock::new(|| {
    let fitted = |kind| {
        let run = table(kind, &Shape { segment: 300, repeats: 3, noise: 0.1, ..Shape::default() });
        let (more, own) = match kind {
            Kind::Friction => ("stribeck", "rub: tau = a * tanh(velocity / w0); a [Nm]; w0 [rad/s] 0.1..10"),
            Kind::Encoder => ("startup_offset", "rub: error = a * tanh(velocity / w0); a [rad]; w0 [rad/s] 0.1..10"),
            Kind::Stiffness => ("hardening", "rub: torsion = a * tanh(load / w0); a [rad]; w0 [Nm] 0.1..10"),
            Kind::Brake => ("saturation", "rub: tau = a * tanh(current / w0); a [Nm]; w0 [A] 0.1..10"),
        };
        let own = UserEffect::inline(kind, own).unwrap();
        let baseline = run.meta().baseline.clone();
        let effects = baseline.iter().map(String::as_str).chain([more, "rub"]);
        let spec = ModelSpec::with_user_effects(kind, effects, vec![own]).unwrap();
        let found = fit(&run, &spec, &Options::default()).unwrap();
        assert!(found.terms.len() > baseline.len(), "{kind}: {:?}", found.notes);
        (run, serde_json::to_value(ModelFile::new(found)).unwrap())
    };
    Kind::ALL.map(fitted).into()
});

/// All uses of a file.
fn use_it(fit: &Fit, run: &RunTable) {
    let _ = evaluate(fit, run);
    for format in Format::ALL {
        let _ = export(fit, format);
    }
}

fn read(file: &Value) -> Result<Fit, String> {
    ModelFile::read(&file.to_string()).map_err(|fault| fault.to_string())
}

#[test]
fn what_was_fitted_comes_back() {
    for (run, file) in FITTED.iter() {
        let fit = read(file).unwrap();
        assert!(evaluate(&fit, run).unwrap().rms <= 1.001 * fit.rms, "{}", run.kind());
    }
}

#[test]
fn a_term_that_its_effect_does_not_have_is_refused_with_what_is_expected() {
    let (_, good) = FITTED.iter().find(|(run, _)| run.kind() == Kind::Friction).unwrap();
    let place = |id: &str| good["fit"]["terms"].as_array().unwrap().iter().position(|t| t["effect"] == id).unwrap();
    let stribeck = place("stribeck");
    let reported = |change: &dyn Fn(&mut Value)| {
        let mut file = good.clone();
        change(&mut file["fit"]["terms"]);
        read(&file).unwrap_err()
    };
    let error = reported(&|terms| {
        terms[stribeck]["shape"] = json!([]);
        terms[stribeck]["names"] = json!(["tau_s"]);
    });
    assert!(error.contains("stribeck has 1 factors, 0 shape values"), "{error}");
    assert!(error.contains("expected are 1 and 2, tau_s, omega_s and delta"), "{error}");
    let error = reported(&|terms| *terms = json!([]));
    assert!(error.contains("coulomb has no term, but the run that was fitted shows it"), "{error}");
    let error = reported(&|terms| terms[stribeck]["form"] = json!("linear"));
    assert!(error.contains("stribeck has the form linear: expected is exponential"), "{error}");
    let error = reported(&|terms| terms[stribeck]["shape"][1] = json!(7.0));
    assert!(error.contains("stribeck has delta = 7: expected is 0.5 to 3"), "{error}");
    let error = reported(&|terms| terms[stribeck]["shape"][0] = json!(0.0));
    assert!(error.contains("stribeck has omega_s = 0: expected is"), "{error}");
    let error = reported(&|terms| {
        let again = terms[stribeck].clone();
        terms.as_array_mut().unwrap().push(again);
    });
    assert!(error.contains("stribeck has 2 terms: one is expected"), "{error}");
    let error = reported(&|terms| terms[place("rub")]["shape"] = json!([1.0, 2.0]));
    assert!(error.contains("rub has 1 factors, 2 shape values"), "{error}");
}

/// Paths to every value within.
fn places(value: &Value, at: &str, found: &mut Vec<String>) {
    found.push(at.to_owned());
    match value {
        Value::Array(items) => items.iter().enumerate().for_each(|(i, v)| places(v, &format!("{at}/{i}"), found)),
        Value::Object(items) => items.iter().for_each(|(k, v)| places(v, &format!("{at}/{k}"), found)),
        _ => {}
    }
}

/// Replaces a value, or adds or removes one.
fn change(value: &mut Value, how: usize) {
    let others = [
        json!(null),
        json!(0),
        json!(-1),
        json!(1),
        json!(1e-300),
        json!(1e308),
        json!(4_000_000_000u32),
        json!([]),
        json!({}),
    ];
    match value {
        Value::Array(items) if how < 2 => match how {
            0 => drop(items.pop()),
            _ => items.extend(items.last().cloned()),
        },
        Value::String(text) if how < 4 => *text = ["linear", "raw", "stop", "plateau_mean"][how].to_owned(),
        Value::Number(_) if how < 1 => *value = json!(value.as_f64().unwrap_or(0.0) * -3.0),
        _ => *value = others[how % others.len()].clone(),
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(600))]

    #[test]
    fn no_file_makes_it_panic(
        kind in 0..Kind::ALL.len(),
        changes in prop::collection::vec((any::<prop::sample::Index>(), 0usize..13), 1..3),
    ) {
        let (run, good) = &FITTED[kind];
        let mut file = good.clone();
        for (place, how) in changes {
            let mut all = Vec::new();
            places(&file, "", &mut all);
            let at = all[place.index(all.len())].clone();
            change(file.pointer_mut(&at).unwrap(), how);
        }
        if let Ok(fit) = read(&file) {
            use_it(&fit, run);
        }
    }
}
