//! Diagnoses of procedure runs on the mock bench, whose parts are those of the documents.

use jointbench_devices::{Joint, MockBench, MockSettings};
use jointbench_instrument::RunTable;
use jointbench_model::preprocess::attention;
use jointbench_model::{Diagnosis, ModelSpec, Open, Options, diagnose, discover, next_run};
use jointbench_procedure::in_memory_run::run_in_memory;
use jointbench_procedure::{BenchFacts, menu, procedure};
use serde_json::{Map, Value, json};

/// A run of a joint with hidden effects.
fn run(joint: Joint, hidden: &[&str], id: &str, parameters: Value) -> RunTable {
    seeded(3, joint, hidden, id, parameters)
}

fn seeded(seed: u64, joint: Joint, hidden: &[&str], id: &str, parameters: Value) -> RunTable {
    let mut settings = MockSettings::new(joint, seed);
    settings.effects = hidden.iter().map(|effect| (*effect).to_owned()).collect();
    let mock = MockBench::start(settings).unwrap();
    let mut bench = mock.open_bench("mock").unwrap();
    run_in_memory(&mut bench, procedure(id).unwrap(), parameters.as_object().unwrap()).unwrap().table
}

/// The effects that the diagnosis adds to the baseline of a run.
fn shown(run: &RunTable) -> Vec<String> {
    let baseline = ModelSpec::baseline(run).unwrap();
    let mut added = discover(run, &baseline, &Options::default(), 6).unwrap().model;
    added.retain(|effect| !baseline.contains(effect));
    added.sort();
    added
}

fn found(joint: Joint, id: &str, parameters: Value) -> Vec<String> {
    shown(&run(joint, &[], id, parameters))
}

fn diagnosis(run: &RunTable) -> Diagnosis {
    diagnose(run, &ModelSpec::baseline(run).unwrap(), &Options::default()).unwrap()
}

#[test]
fn a_brake_saturates_and_remembers() {
    // The supply reports the current at most ten times a second: held readings would hide both.
    let given = json!({"levels": 6, "loops": 1, "random_turns": 6, "speed_rad_s": 3.0});
    assert_eq!(found(Joint::JointA, "brake_hysteresis", given), ["hysteresis", "saturation"]);
    // At one speed a speed dependence equals the torque itself, and only the largest loop determines its own
    // remanence.
    assert_eq!(found(Joint::JointB, "brake_hysteresis", json!({})), ["hysteresis", "saturation"]);
}

#[test]
fn what_a_brake_of_the_bench_reaches_is_no_slip_of_a_unit() {
    for joint in [Joint::JointA, Joint::JointB] {
        for id in ["brake_hysteresis", "brake_speed_independence", "demagnetise"] {
            let run = run(joint, &[], id, json!({}));
            assert_eq!(attention(&run), Vec::<String>::new(), "{id} of {joint:?}");
        }
    }
}

#[test]
fn an_encoder_has_waves_over_the_turn_and_over_the_pole_pair_and_a_play() {
    let expected = ["direction_hysteresis", "harmonic_1", "harmonic_2", "pole_period"];
    assert_eq!(found(Joint::EncoderShaft, "encoder_linearity", json!({})), expected);
    // At 52 rad/s there are 30 samples in a turn, where 64 periods look like four.
    assert_eq!(found(Joint::EncoderShaft, "encoder_delay", json!({})), expected);
}

#[test]
fn a_stiff_joint_lacks_nothing_and_a_soft_one_hardens() {
    assert_eq!(found(Joint::JointA, "stiffness", json!({"load_levels": 4})), Vec::<String>::new());
    // With the default number of loads, any form error would be named.
    // A delay of its sensors is named in addition.
    assert_eq!(found(Joint::JointB, "stiffness", json!({})), ["delay", "hardening"]);
}

#[test]
fn a_joint_that_starts_from_rest_shows_its_contacts_and_no_substitute() {
    for joint in [Joint::JointA, Joint::JointB] {
        // The drive reports the speed 2 ms later than the angle, and friction at low speed is no delay either.
        for hidden in [&[][..], &["stribeck"]] {
            assert_eq!(shown(&run(joint, hidden, "presliding", json!({}))), ["presliding"], "{joint:?} {hidden:?}");
        }
        let breakaway = run(joint, &[], "breakaway", json!({}));
        assert_eq!(shown(&breakaway), ["presliding"], "{joint:?}");
        let summary = diagnosis(&breakaway).summary;
        assert!(
            !summary.contains("Attention"),
            "nothing contradicts the link's sensor, which bears no load: {summary}"
        );
    }
}

#[test]
fn teeth_on_the_way_from_rest_are_named_without_an_impossible_effect() {
    // A Stribeck effect of −20 mNm had stayed after the removal of the effect that made it possible.
    let run = seeded(9314, Joint::JointB, &["cogging"], "breakaway", json!({}));
    let found: Vec<String> = diagnosis(&run).suggestions.into_iter().map(|s| s.effect).collect();
    assert!(found.contains(&"cogging".to_owned()), "{found:?}");
    assert!(!found.contains(&"stribeck".to_owned()), "{found:?}");
}

#[test]
fn teeth_under_a_soft_drive_are_the_only_finding() {
    // Two waves had caused a friction ripple, three and five a structure that was the rotor's own acceleration.
    for seed in [32003, 32005, 32009] {
        let run = seeded(seed, Joint::JointA, &["cogging"], "friction", json!({}));
        let found = diagnosis(&run);
        let named: Vec<&str> = found.suggestions.iter().map(|s| s.effect.as_str()).collect();
        assert_eq!((named.as_slice(), found.structure_remains), (["cogging"].as_slice(), false), "{}", found.summary);
    }
}

#[test]
fn a_square_of_speed_that_a_stribeck_effect_imitates_is_named_or_left_open() {
    let quadratic = |seed| seeded(seed, Joint::JointA, &["stribeck", "viscous_quadratic"], "friction", json!({}));
    // A Stribeck effect with the exponent 0.5 has a squared error that is 1 % larger, with 12 mNm of Coulomb friction
    // instead of 30.
    let clear = diagnosis(&quadratic(14007));
    let named: Vec<&str> = clear.suggestions.iter().map(|s| s.effect.as_str()).collect();
    assert_eq!(named, ["stribeck", "viscous_quadratic"], "{}", clear.summary);
    let why = &clear.suggestions[1].why;
    assert!(why.contains("without it coulomb.tau_c would be 11."), "{why}");
    // If the validation error does not decide, the effect is reported as open, and the run that would decide is
    // recommended.
    let run = quadratic(14006);
    let open = diagnosis(&run);
    let imitated = open.imitated.as_ref().unwrap();
    assert_eq!((imitated.effect.as_str(), imitated.parameter.as_str()), ("viscous_quadratic", "coulomb.tau_c"));
    assert!(imitated.without < 0.022 && (0.027..0.030).contains(&imitated.with), "{imitated:?}");
    assert!(open.summary.contains("does not determine whether viscous_quadratic is present"), "{}", open.summary);
    let spec = ModelSpec::baseline(&run).unwrap().with("stribeck").unwrap();
    let fit = diagnose(&run, &spec, &Options::default()).unwrap().fit;
    let tau_c = fit.parameters.iter().find(|p| p.name == "tau_c").unwrap();
    assert!(tau_c.ci95[0] < 0.022 && tau_c.ci95[1] > 0.99 * imitated.with, "{tau_c:?}");
    assert!(tau_c.note.as_ref().is_some_and(|note| note.contains("viscous_quadratic")), "{tau_c:?}");
    let offered = menu(&BenchFacts::shown_by(&run), &run, &Map::new());
    let next = next_run(&run, &Open::from(&open), &offered, &Options::default()).unwrap().experiment.unwrap();
    assert_eq!(next.separates, ["viscous_quadratic"], "{}", next.why);
    assert!(next.expected_z.unwrap() > 2.0, "{}", next.why);
}

#[test]
fn an_arm_is_heavy_and_its_directions_differ() {
    // A fiftieth of the share of gravity, but the formula of gravity has no form error that it could be.
    assert_eq!(found(Joint::Puma, "puma_friction", json!({})), ["gravity", "viscous_asymmetry"]);
}

#[test]
fn teeth_transmit_the_weight_of_an_arm_and_its_load() {
    // With the load alone, a load_quadratic and a friction_ripple remained at twice the noise floor, and were
    // reported as an explanation.
    for hidden in [["gravity", "load_linear"], ["gravity", "load_quadratic"]] {
        let run = seeded(1, Joint::JointA, &hidden, "friction", json!({}));
        assert_eq!(shown(&run), hidden);
    }
}

#[test]
fn confounded_effects_of_an_arm_are_reported() {
    // Around the upright pose gravity's cosine is a constant torque: the difference of the directions, 27 mNm, could
    // be gravity.
    let alone = diagnosis(&run(Joint::Puma, &[], "puma_friction", json!({})));
    let offset = alone.silent.iter().find(|silent| silent.effect == "direction_offset").unwrap();
    assert!(offset.minimum_detectable_rms > 0.027, "{offset:?}");
    // With a quadratic drag, which is added later, saturation explains as much as asymmetry.
    let quadratic = diagnosis(&run(Joint::Puma, &["viscous_quadratic"], "puma_friction", json!({})));
    let named = |effect: &str| quadratic.suggestions.iter().any(|s| s.effect == effect);
    let tied = quadratic.suggestions.iter().any(|s| s.confounded_with.iter().any(|e| e == "viscous_asymmetry"));
    assert!(named("viscous_quadratic") && (named("viscous_asymmetry") || tied), "{}", quadratic.summary);
}
