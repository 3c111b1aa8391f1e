//! What the diagnosis says of runs that procedures make on the mock bench, whose parts are those of the documents.

use jointbench_devices::{Joint, MockBench, MockSettings};
use jointbench_model::{ModelSpec, Options, discover};
use jointbench_procedure::conduct::conduct;
use jointbench_procedure::procedure;
use serde_json::{Value, json};

/// The effects that a run is found to show beside its baseline.
fn found(joint: Joint, id: &str, parameters: Value) -> Vec<String> {
    let mock = MockBench::start(MockSettings::new(joint, 3)).unwrap();
    let mut bench = mock.open_bench("mock").unwrap();
    let run = conduct(&mut bench, procedure(id).unwrap(), parameters.as_object().unwrap()).unwrap().table;
    let baseline = ModelSpec::baseline(&run).unwrap();
    let mut added = discover(&run, &baseline, &Options::default(), 6, |_| {}).unwrap().model;
    added.retain(|effect| !baseline.contains(effect));
    added.sort();
    added
}

#[test]
fn a_brake_saturates_and_remembers() {
    // The supply tells the current ten times a second at best: held readings would hide both.
    let given = json!({"levels": 6, "loops": 1, "random_turns": 6, "speed_rad_s": 3.0});
    assert_eq!(found(Joint::JointA, "brake_hysteresis", given), ["hysteresis", "saturation"]);
    // At one speed a dependence on it is the torque itself.
    assert!(!found(Joint::JointB, "brake_hysteresis", json!({})).contains(&"velocity_dependence".to_owned()));
}

#[test]
fn an_encoder_has_waves_over_the_turn_and_over_the_pole_pair_and_a_play() {
    let expected = ["direction_hysteresis", "harmonic_1", "harmonic_2", "pole_period"];
    assert_eq!(found(Joint::EncoderShaft, "encoder_linearity", json!({})), expected);
}

#[test]
fn a_stiff_joint_lacks_nothing_and_a_soft_one_hardens() {
    assert_eq!(found(Joint::JointA, "stiffness", json!({"load_levels": 4})), Vec::<String>::new());
    // With as many loads as the procedure takes unasked, whatever its formula left over would be named.
    assert_eq!(found(Joint::JointB, "stiffness", json!({})), ["hardening"]);
}

#[test]
fn an_unloaded_joint_that_swings_at_a_few_places_shows_neither_load_nor_waves() {
    for joint in [Joint::JointA, Joint::JointB] {
        let found = found(joint, "presliding", json!({}));
        let false_ones = |effect: &String| effect.contains("load") || effect == "cogging";
        assert!(found.contains(&"presliding".to_owned()) && !found.iter().any(false_ones), "{joint:?}: {found:?}");
    }
}

#[test]
fn an_arm_is_heavy_and_its_directions_differ() {
    // A fiftieth of what gravity takes, but gravity's formula leaves no remainder that it could be.
    assert_eq!(found(Joint::Puma, "puma_friction", json!({})), ["gravity", "viscous_asymmetry"]);
}
