//! The Electro-Mechanical Positioning System (Janot, Gautier, Brunot 2019): published figures on real input.

use super::{effects, json};
use crate::shared::shared;
use serde_json::Value;

fn parameter<'v>(fit: &'v Value, effect: &str) -> &'v Value {
    let parameters = fit["parameters"].as_array().expect("parameters");
    parameters.iter().find(|p| p["effect"] == effect).expect("the parameter")
}

#[test]
fn the_published_parameters_lie_in_the_intervals_and_the_errors_are_no_larger() {
    let (Some(train), Some(pulses)) = (shared("data/emps-train"), shared("data/emps-pulses")) else { return };
    let other = pulses.join("run.csv").display().to_string();
    let fit = json("fit", &train, &["--evaluate", &other]);
    // The published fit has no columns for formula errors, and weights all samples equally.
    for (effect, published, budget) in [
        ("inertia", 95.1089, 0.015),
        ("viscous", 203.5034, 0.04),
        ("coulomb", 20.3935, 0.06),
        ("direction_offset", -3.1648, 0.05),
    ] {
        let found = parameter(&fit, effect);
        let value = found["value"].as_f64().expect("a value");
        assert!((value / published - 1.0).abs() < budget, "{found}, published {published}");
        let [low, high] = [0, 1].map(|end| found["ci95"][end].as_f64().expect("an end of the interval"));
        assert!((low..high).contains(&published), "{found}, published {published}");
    }
    let train_error = fit["relative_error"].as_f64().expect("the relative error");
    let pulses_error = fit["evaluation"]["result"]["relative_error"].as_f64().expect("the relative error elsewhere");
    assert!(train_error < 0.041, "train {train_error}, published 0.0408");
    assert!(pulses_error < 0.060, "pulses {pulses_error}, published 0.0598");
}

#[test]
fn the_asymmetry_is_named_first_and_helps_on_unseen_data() {
    let (Some(train), Some(pulses)) = (shared("data/emps-train"), shared("data/emps-pulses")) else { return };
    let diagnosis = json("diagnose", &train, &[]);
    assert_eq!(effects(&diagnosis["suggestions"]).first(), Some(&"viscous_asymmetry"), "{}", diagnosis["summary"]);
    let other = pulses.join("run.csv").display().to_string();
    let model = "inertia,coulomb,viscous,direction_offset,viscous_asymmetry";
    let fit = json("fit", &train, &["--model", model, "--evaluate", &other]);
    let error = fit["evaluation"]["result"]["relative_error"].as_f64().expect("the relative error");
    assert!(error <= 0.055, "pulses {error}");
}
