//! Short runs on the mock bench that measure the load: brakes, and the transmission before one of them.

use crate::mock::found;
use jointbench_devices::sim::Load;
use jointbench_devices::{Joint, MockSettings};
use jointbench_procedure::identification::Verdict;
use serde_json::json;

#[test]
fn a_demagnetised_brake_is_clean() {
    let given = json!({"turns": 1.0, "speed_rad_s": 3.0, "sample_rate_hz": 100.0});
    let (_, found) = found(MockSettings::new(Joint::JointB, 3), "demagnetise", given);
    assert_eq!(found.verdict, Verdict::Identified, "{}", found.summary);
}

/// Of 21 poles with 6 % of the rated torque, magnetised at standstill with the rated current.
#[test]
fn the_poles_of_a_brake_are_counted_and_removed() {
    let given = json!({"repeats": 2, "demagnetise_speed_rad_s": 3.0});
    for (joint, seed) in [(Joint::JointA, 1), (Joint::JointA, 2), (Joint::JointB, 3), (Joint::JointB, 4)] {
        let (_, found) = found(MockSettings::new(joint, seed), "brake_poles", given.clone());
        assert_eq!(found.verdict, Verdict::Identified, "{}", found.summary);
        let value = |name: &str| found.quantity(name).unwrap().value;
        assert_eq!(value("poles"), 21.0, "{}", found.summary);
        assert!((value("amplitude") / (0.06 * 13.0) - 1.0).abs() < 2e-3, "{}", found.summary);
        assert!(value("amplitude_after") < 0.02 * value("amplitude"), "{}", found.summary);
    }
    let settings = MockSettings { load: Load::GearAndBrakeB, ..MockSettings::new(Joint::JointA, 1) };
    let (_, found) = found(settings, "brake_poles", json!({"repeats": 2, "top_current": 0.3}));
    assert_eq!(found.quantity("poles").unwrap().value, 21.0, "behind a gear: {}", found.summary);
}

/// The gear holds 4 Nm at rest, and the brakes without current up to 0.33 Nm (30 mNm, and ten times as much behind the
/// gear). The bristles yield before the peak.
#[test]
fn a_transmission_breaks_away_without_the_friction_of_the_joint() {
    let given = json!({"positions": 3, "ramp_nm_s": 2.0});
    let measured = |joint, seed, effects: &[&str]| {
        let settings = MockSettings { load: Load::GearAndBrakeB, ..MockSettings::new(joint, seed) }.hiding(effects);
        found(settings, "transmission_breakaway", given.clone()).1
    };
    let joints =
        [measured(Joint::JointA, 1, &[]), measured(Joint::JointA, 2, &["stribeck"]), measured(Joint::JointB, 3, &[])];
    for found in joints {
        assert_eq!(found.verdict, Verdict::Identified, "{} {:?}", found.summary, found.advice);
        for name in ["tau_b", "tau_b_positive", "tau_b_negative"] {
            let quantity = found.quantity(name).unwrap();
            assert!((3.8..4.4).contains(&quantity.value) && quantity.ci95.is_some(), "{}", found.summary);
        }
        // Twice the largest zero of the sensor.
        assert!(found.quantity("tau_b_difference").unwrap().value.abs() < 0.06, "{}", found.summary);
    }
    let jolted = measured(Joint::JointB, 3, &["stribeck"]);
    assert_eq!(jolted.verdict, Verdict::Inconclusive, "{}", jolted.summary);
    assert!(jolted.advice.is_some_and(|advice| advice.contains("with a jolt at 6 positions")));
}
