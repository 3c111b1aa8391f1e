//! Measurements made by others, with figures that others published.

mod common;

use common::{read, shared};
use jointbench_model::{ModelSpec, Options, Verdict, diagnose, discover, evaluate, fit};

/// Janot, Gautier, Brunot 2019: symmetric model of the electro-mechanical positioning system.
#[test]
fn emps_gives_the_published_parameters() {
    let Some(data) = shared("data") else { return };
    let train = read(&data.join("emps-train"));
    let spec = ModelSpec::baseline(&train).unwrap();
    let found = fit(&train, &spec, &Options::default()).unwrap();
    let check = |name: &str, published: f64, budget: f64| {
        let value = found.parameters.iter().find(|p| p.name == name).unwrap().value;
        assert!((value / published - 1.0).abs() < budget, "{name}: {value}, published {published}");
    };
    check("j", 95.1089, 0.005);
    check("c_v", 203.5034, 0.005);
    check("tau_c", 20.3935, 0.005);
    check("tau_0", -3.1648, 0.02);
    assert!((0.040..0.042).contains(&found.relative_error), "train: {}", found.relative_error);
    assert_eq!(found.unit, "N");

    let pulses = read(&data.join("emps-pulses"));
    let unseen = evaluate(&found, &pulses).unwrap();
    assert!((0.059..0.061).contains(&unseen.relative_error), "pulses: {}", unseen.relative_error);

    let diagnosis = diagnose(&train, &spec, &Options::default()).unwrap();
    assert_eq!(diagnosis.suggestions[0].effect, "viscous_asymmetry");
    assert!(diagnosis.suggestions[0].confounded_with.iter().any(|e| e == "viscous_quadratic"), "|v| and v² tie here");
    let asymmetric = fit(&train, &spec.with("viscous_asymmetry").unwrap(), &Options::default()).unwrap();
    let unseen = evaluate(&asymmetric, &pulses).unwrap();
    assert!(unseen.relative_error < 0.055, "pulses with asymmetry: {}", unseen.relative_error);
}

#[test]
fn emps_goes_on_to_the_flexibility() {
    let Some(data) = shared("data") else { return };
    let train = read(&data.join("emps-train"));
    let spec = ModelSpec::baseline(&train).unwrap();
    let found = discover(&train, &spec, &Options::default(), 5, |_| {}).unwrap();
    let unseen = evaluate(&found.fit, &read(&data.join("emps-pulses"))).unwrap();
    assert!(unseen.relative_error < 0.028, "{:?}: {}", found.model, unseen.relative_error);
    assert_eq!(found.verdict, Verdict::UnexplainedStructure);
}
