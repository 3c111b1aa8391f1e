//! The Electro-Mechanical Positioning System (Janot, Gautier, Brunot 2019): published figures on real input.

use super::{effects, json};
use crate::shared::shared;
use serde_json::Value;

fn parameter(fit: &Value, effect: &str) -> f64 {
    let parameters = fit["parameters"].as_array().expect("parameters");
    parameters.iter().find(|p| p["effect"] == effect).and_then(|p| p["value"].as_f64()).expect("the parameter")
}

#[test]
fn the_published_parameters_and_errors_are_reproduced() {
    let (Some(train), Some(pulses)) = (shared("data/emps-train"), shared("data/emps-pulses")) else { return };
    let other = pulses.join("run.csv").display().to_string();
    let said = json("fit", &train, &["--evaluate", &other]);
    for (effect, published, budget) in [
        ("inertia", 95.1089, 0.005),
        ("viscous", 203.5034, 0.005),
        ("coulomb", 20.3935, 0.005),
        ("direction_offset", -3.1648, 0.02),
    ] {
        let found = parameter(&said, effect);
        assert!((found / published - 1.0).abs() < budget, "{effect}: {found}, published {published}");
    }
    let train_error = said["relative_error"].as_f64().expect("the relative error");
    let pulses_error = said["evaluation"]["result"]["relative_error"].as_f64().expect("the relative error elsewhere");
    assert!((0.040..=0.042).contains(&train_error), "train {train_error}");
    assert!((0.059..=0.061).contains(&pulses_error), "pulses {pulses_error}");
}

#[test]
fn the_asymmetry_is_named_first_and_helps_on_unseen_data() {
    let (Some(train), Some(pulses)) = (shared("data/emps-train"), shared("data/emps-pulses")) else { return };
    let diagnosis = json("diagnose", &train, &[]);
    assert_eq!(effects(&diagnosis["suggestions"]).first(), Some(&"viscous_asymmetry"), "{}", diagnosis["summary"]);
    let other = pulses.join("run.csv").display().to_string();
    let model = "inertia,coulomb,viscous,direction_offset,viscous_asymmetry";
    let said = json("fit", &train, &["--model", model, "--evaluate", &other]);
    let error = said["evaluation"]["result"]["relative_error"].as_f64().expect("the relative error");
    assert!(error <= 0.055, "pulses {error}");
}
