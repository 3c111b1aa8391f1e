//! Friction compensation on the mock bench, with the friction that is true.

use crate::mock::found;
use jointbench_devices::sim::Truth;
use jointbench_devices::{Joint, MockBench, MockSettings};
use jointbench_procedure::identification::{Identification, Series, Verdict};
use jointbench_procedure::in_memory_run::run_in_memory;
use jointbench_procedure::procedure;
use serde_json::{Value, json};

/// The parameters of `compensation` that are exact for a joint of the mock bench with a Stribeck rise.
fn exact(truth: &Truth) -> Value {
    let rise = &truth.hidden[0].parameters;
    json!({
        "tau_c_nm": truth.coulomb_nm, "c_v_nm_s": truth.viscous_nm_s, "tau_h_nm": truth.coulomb_nm + rise["rise_nm"],
        "stribeck_speed_rad_s": rise["velocity_rad_s"] / truth.gear_ratio, "stribeck_exponent": 0.8,
    })
}

fn compensated(truth: &Truth, hidden: &[&str], more: Value) -> Identification {
    let mut given = exact(truth).as_object().unwrap().clone();
    given.extend(more.as_object().unwrap().clone());
    found(MockSettings::new(Joint::JointA, 1).hiding(hidden), "compensation", Value::Object(given)).1
}

fn truth_of(hidden: &[&str]) -> Truth {
    MockBench::start(MockSettings::new(Joint::JointA, 1).hiding(hidden)).unwrap().truth().clone()
}

/// Within a few bristle deflections the static models are wrong.
#[test]
fn a_slow_reference_is_followed_best_with_the_dynamic_model() {
    let truth = truth_of(&["stribeck"]);
    let slow = json!({"amplitude_rad_s": 0.01, "presliding_stiffness_nm_rad": truth.bristle_nm_rad});
    let found = compensated(&truth, &["stribeck"], slow);
    let ratio = |way: &str| found.quantity(&format!("ratio_{way}")).unwrap();
    for other in ["interpolated", "coulomb_viscous", "full", "observer", "observer_and_model"] {
        let [dynamic, other] = [ratio("dynamic"), ratio(other)].map(|ratio| ratio.ci95.unwrap());
        assert!(dynamic[1] < other[0], "{}", found.summary);
    }
    assert!(found.summary.contains("Ideal Coulomb is unstable at standstill"), "{}", found.summary);
    let changes = |way: &str| found.quantity(&format!("sign_changes_{way}")).unwrap().value;
    assert!(changes("ideal_coulomb") > 20.0 && changes("dynamic") == 2.0);
}

#[test]
fn the_load_term_and_the_observer_reduce_the_error_under_load() {
    let hidden = ["stribeck", "load_linear"];
    let truth = truth_of(&hidden);
    let per_load = truth.hidden[1].parameters["per_link_nm"] * truth.gear_ratio;
    let found = compensated(&truth, &hidden, json!({"load": 0.5, "load_friction": per_load}));
    let ratio = |way: &str| found.quantity(&format!("ratio_{way}")).unwrap().ci95.unwrap();
    assert!(ratio("load")[1] < ratio("full")[0] && ratio("load")[1] < ratio("observer")[0], "{}", found.summary);
    assert!(ratio("observer_and_model")[1] < ratio("full")[0], "{}", found.summary);
}

#[test]
fn a_reference_that_no_method_follows_better_gets_the_reason() {
    let fast = json!({"amplitude_rad_s": 1.5, "period_s": 2.0, "share": 0.8});
    let found = compensated(&truth_of(&["stribeck"]), &["stribeck"], fast);
    assert_eq!(found.verdict, Verdict::Inconclusive);
    assert!(found.summary.starts_with("No method reduces the error significantly."), "{}", found.summary);
    assert!(found.summary.contains("is a time shift: the motion is early by"), "{}", found.summary);
    let shift = found.quantity("shift_full").unwrap().ci95.unwrap();
    assert!(shift[1] < 0.0, "{shift:?}");
}

#[test]
fn the_full_model_halves_the_error_without_over_compensating() {
    let mock = MockBench::start(MockSettings::new(Joint::JointA, 1).hiding(&["stribeck"])).unwrap();
    let truth = mock.truth();
    let rise_nm = truth.hidden[0].parameters["rise_nm"];
    let given = json!({
        "tau_c_nm": truth.coulomb_nm, "c_v_nm_s": truth.viscous_nm_s, "tau_h_nm": truth.coulomb_nm + rise_nm,
        "stribeck_speed_rad_s": truth.hidden[0].parameters["velocity_rad_s"] / truth.gear_ratio,
        "stribeck_exponent": 0.8, "periods": 2, "period_s": 4.0,
    });
    let mut bench = mock.open_bench("mock").unwrap();
    let procedure = procedure("compensation").unwrap();
    let found = run_in_memory(&mut bench, procedure, given.as_object().unwrap()).unwrap().identification.unwrap();
    assert_eq!(found.verdict, Verdict::Identified, "{}", found.summary);
    let ratio = |way: &str| found.quantity(&format!("ratio_{way}")).unwrap().value;
    assert!(ratio("full") < 0.5 && ratio("full") < ratio("interpolated"), "{}", found.summary);
    assert!(ratio("observer") < 1.0);
}

#[test]
fn table_4_7_is_drawn_as_bars_with_a_trajectory() {
    let (_, found) = found(MockSettings::new(Joint::JointA, 2).hiding(&["stribeck"]), "compensation", json!({}));
    let figure = |name: &str| found.figures.iter().find(|figure| figure.name == name).unwrap();
    let bars = &figure("ratio").series;
    for (series, name) in bars.iter().zip(["rho_1", "rho_2", "rho_max"]) {
        let of = |way: &str| found.quantity(&format!("{name}_{way}")).unwrap().value;
        assert_eq!((series.y[0], series.y.last()), (1.0, Some(&(of("observer_and_model") / of("none")))), "{name}");
    }
    let rms_rad = |way: &str| found.quantity(&format!("rms_{way}")).unwrap().value;
    assert!(0.0 < rms_rad("full") && rms_rad("full") < rms_rad("none"), "{}", found.summary);
    assert!(found.summary.contains("the RMS error from "), "{}", found.summary);
    let [reference, none, best] = &figure("trajectory").series[..] else { panic!("{:?}", figure("trajectory")) };
    let off = |one: &Series| reference.y.iter().zip(&one.y).map(|(a, b)| (a - b).abs()).sum::<f64>();
    assert!(off(best) < 0.5 * off(none) && off(none) > 0.0, "{} {}", best.label, none.label);
    assert!((reference.x.last().unwrap() - 6.0).abs() < 0.1, "one period");
}
