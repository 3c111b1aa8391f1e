//! Both brakes of the bench: a constant load over speed.

use super::mock::found;
use jointbench_devices::sim::Load;
use jointbench_devices::{Joint, MockSettings};
use jointbench_procedure::identification::Verdict;
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
    assert!(value("change_constant") > 0.01 && value("change") < 0.2 * value("change_constant"), "{}", found.summary);
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
    assert!(found.quantity("change_constant").unwrap().value < 0.02, "{}", found.summary);
}

#[test]
fn a_torque_that_no_current_gives_is_not_held() {
    let given = json!({"torque_nm": 14.5, "levels": 4, "speeds": 2, "top_speed_rad_s": 3.0});
    let (_mock, found) = found(MockSettings::new(Joint::JointB, 3), "constant_load", given);
    assert_eq!(found.verdict, Verdict::Inconclusive);
    assert!(found.summary.contains("14.50 Nm are out of range"), "{}", found.summary);
}
