//! Both brakes of the bench: a constant load over speed behind the gear, and the difference between the brakes.

use super::mock::found;
use jointbench_devices::sim::Load;
use jointbench_devices::{Joint, MockBench, MockSettings};
use jointbench_procedure::catalogue::compared_brake;
use jointbench_procedure::identification::{Identification, Verdict};
use jointbench_procedure::in_memory_run::run_in_memory_with_facts;
use jointbench_procedure::{BenchFacts, ComparedBrake, procedure};
use serde_json::json;

fn behind_the_gear(documents: bool) -> MockSettings {
    MockSettings { load: Load::GearAndBrakeB, documents, ..MockSettings::new(Joint::JointA, 1) }
}

#[test]
fn the_current_is_readjusted_at_each_speed_behind_the_gear() {
    let given = json!({"torque_nm": 25.0, "top_current": 0.35, "levels": 8, "speeds": 4});
    let (_mock, found) = found(behind_the_gear(true), "constant_load", given);
    assert_eq!(found.verdict, Verdict::Identified, "{}", found.summary);
    let value = |name: &str| found.quantity(name).unwrap_or_else(|| panic!("no {name}")).value;
    assert_eq!(value("demanded"), 25.0);
    // At one current the drag of the gear changes the torque.
    assert!(value("change_constant") > 1.0 && value("change") < 0.2 * value("change_constant"), "{}", found.summary);
    let mut currents: Vec<f64> = (1..=4).map(|number| value(&format!("current_{number}"))).collect();
    for number in 1..=4 {
        let reached = found.quantity(&format!("reached_{number}")).unwrap();
        let [low, high] = reached.ci95.unwrap();
        assert!((reached.value / 25.0 - 1.0).abs() < 0.02, "{number}: {}", found.summary);
        assert!(low < reached.value && reached.value < high && high - low < 1.0, "{number}: {low} … {high}");
    }
    currents.dedup();
    assert!(currents.len() > 2, "{currents:?}");
}

#[test]
fn brake_a_needs_no_readjustment() {
    let given = json!({"levels": 6, "speeds": 3, "repeats": 2, "top_speed_rad_s": 3.0});
    let (_mock, found) = found(MockSettings::new(Joint::JointB, 3), "constant_load", given);
    assert_eq!(found.verdict, Verdict::Identified, "{}", found.summary);
    assert!(found.quantity("change_constant").unwrap().value < 2.0, "{}", found.summary);
}

#[test]
fn a_torque_that_no_current_gives_is_not_held() {
    let given = json!({"torque_nm": 14.5, "levels": 4, "speeds": 2, "top_speed_rad_s": 3.0});
    let (_mock, found) = found(MockSettings::new(Joint::JointB, 3), "constant_load", given);
    assert_eq!(found.verdict, Verdict::Inconclusive);
    assert!(found.summary.contains("14.50 Nm are out of range"), "{}", found.summary);
}

/// Brake of a bench, and the result with the other brake.
fn hysteresis(settings: MockSettings, other: Option<ComparedBrake>) -> (ComparedBrake, Identification) {
    let mock = MockBench::start(settings).unwrap();
    let mut bench = mock.open_bench("mock").unwrap();
    let run = u32::from(other.is_some());
    let facts = BenchFacts { compared_brake: other, ..BenchFacts::of(&bench) };
    let given = json!({"levels": 10, "loops": 3, "random_turns": 6, "top_current": 0.35, "compare_run": run});
    let hysteresis = procedure("brake_hysteresis").unwrap();
    let done = run_in_memory_with_facts(&mut bench, &facts, hysteresis, given.as_object().unwrap()).unwrap();
    (compared_brake(&done.table).unwrap(), done.identification.unwrap())
}

#[test]
fn both_brakes_have_nearly_the_same_curve() {
    let brake_a = MockSettings { documents: true, ..MockSettings::new(Joint::JointA, 1) };
    let (brake_a, alone) = hysteresis(brake_a, None);
    assert!(alone.quantity("difference_mean").is_none());
    let (_, both) = hysteresis(behind_the_gear(true), Some(brake_a.clone()));
    // The second brake of this bench is like the first one, but turns ten times as fast and is warmer.
    for (name, most) in [("difference_mean", 0.06), ("difference_top", 0.06), ("difference_max", 0.6)] {
        let quantity = both.quantity(name).unwrap();
        let [low, high] = quantity.ci95.unwrap();
        assert!(low < quantity.value && quantity.value < high, "{name}: {low} … {high}");
        assert!(low < most && high > -most && quantity.value.abs() < most, "{name}: {}", both.summary);
    }
    assert!(both.figures.iter().any(|figure| figure.name == "difference_over_current"));

    // A brake of 13 Nm instead of 15 Nm differs.
    let (_, weaker) = hysteresis(behind_the_gear(false), Some(brake_a));
    let [_, high] = weaker.quantity("difference_top").unwrap().ci95.unwrap();
    assert!(high < 0.0, "{}", weaker.summary);
}

#[test]
fn a_comparison_needs_a_brake_that_is_known_as_far() {
    let mock = MockBench::start(MockSettings::new(Joint::JointB, 1)).unwrap();
    let bench = mock.open_bench("mock").unwrap();
    let facts = BenchFacts::of(&bench);
    let given = json!({"compare_run": 7});
    let fault = procedure("brake_hysteresis").unwrap().plan(given.as_object().unwrap(), &facts).unwrap_err();
    assert!(fault.to_string().contains("compare_run"), "{fault}");
}
