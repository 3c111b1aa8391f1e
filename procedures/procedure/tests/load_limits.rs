//! A plan beyond a limit is refused with the largest value that keeps it: of the load behind the second brake, and of
//! speed and arc on an arm.

use jointbench_devices::sim::{Load, MockInstrument};
use jointbench_devices::{Joint, MockBench, MockSettings};
use jointbench_instrument::Bench;
use jointbench_procedure::in_memory_run::run_in_memory;
use jointbench_procedure::{BenchFacts, Plan, catalogue, procedure};
use serde_json::json;

fn behind_the_gear() -> (MockBench, Bench) {
    of_joint(Joint::JointA)
}

fn of_joint(joint: Joint) -> (MockBench, Bench) {
    let settings = MockSettings { load: Load::GearAndBrakeB, ..MockSettings::new(joint, 1) };
    let mock = MockBench::start(settings).expect("a mock bench");
    let bench = mock.open_bench("mock").expect("its instruments answer");
    (mock, bench)
}

/// What stands in the way of a plan.
fn refusal(plan: &Plan, bench: &BenchFacts) -> Option<String> {
    plan.preview(bench).checks.into_iter().find(|check| !check.ok).map(|check| check.refusal())
}

/// The load that the refusal of a plan with its defaults names.
fn named(id: &str, name: &str, bench: &BenchFacts) -> f64 {
    let plan = procedure(id).expect("a procedure").plan(&Default::default(), bench).expect("a plan");
    let message = refusal(&plan, bench).unwrap_or_else(|| panic!("{id} is allowed with its defaults"));
    let share = message.split(&format!("set {name} = ")).nth(1).and_then(|rest| rest.split(' ').next());
    share.and_then(|share| share.parse().ok()).unwrap_or_else(|| panic!("{id}: {message}"))
}

#[test]
fn a_refused_load_comes_with_one_that_leaves_room_for_friction() {
    let (_mock, bench) = behind_the_gear();
    let facts = BenchFacts::of(&bench);
    for (id, name) in [
        ("stiffness", "top_load"),
        ("friction", "top_load"),
        ("brake_speed_independence", "top_current"),
        ("brake_hysteresis", "top_current"),
    ] {
        let share = named(id, name, &facts);
        let current = |share: f64| {
            let choices = json!({ name: share });
            let plan = procedure(id).unwrap().plan(choices.as_object().unwrap(), &facts).expect("a plan");
            assert!(share > named(id, name, &facts) || refusal(&plan, &facts).is_none(), "{id} at {share}");
            let extremes = plan.extremes(&facts);
            let current = extremes.iter().find(|one| one.quantity.starts_with("motor current")).expect("a current");
            current.value / current.limit.expect("a limit")
        };
        assert!(current(share) <= 0.9 && current(share + 0.01) > 0.9, "{id}: {share}");
    }
}

#[test]
fn every_refused_load_behind_the_gear_comes_with_one_that_passes() {
    for joint in [Joint::JointA, Joint::JointB] {
        let (_mock, bench) = of_joint(joint);
        let facts = BenchFacts::of(&bench);
        for procedure in catalogue() {
            // Planning itself names what is missing.
            let Ok(plan) = procedure.plan(&Default::default(), &facts) else { continue };
            let refused = refusal(&plan, &facts);
            let is_named = refused.as_ref().is_none_or(|message| message.contains("(set top_"));
            assert!(is_named, "{} of {joint:?}: {refused:?}", procedure.id());
        }
    }
}

#[test]
fn a_run_with_the_named_load_keeps_the_limits() {
    let (_mock, mut bench) = behind_the_gear();
    let share = named("brake_speed_independence", "top_current", &BenchFacts::of(&bench));
    let choices = json!({ "top_current": share });
    let run = run_in_memory(&mut bench, procedure("brake_speed_independence").unwrap(), choices.as_object().unwrap());
    assert!(run.is_ok(), "{:?}", run.err());
}

#[test]
fn an_arm_is_measured_with_the_values_that_its_refusals_name() {
    let others = vec![MockInstrument::Thermometer];
    let settings = MockSettings { others, ..MockSettings::new(Joint::Puma, 1) }.hiding(&["stribeck"]);
    let mock = MockBench::start(settings).expect("a mock bench");
    let mut bench = mock.open_bench("mock").expect("its instruments answer");
    let facts = BenchFacts::of(&bench);
    for (id, name, more) in [
        ("warm_up", "top_speed_rad_s", json!({"longest_s": 60.0})),
        ("friction_temperature", "top_speed_rad_s", json!({"heat_s": 60.0, "cool_s": 60.0})),
        ("breakaway", "arc_rad", json!({"positions": 2})),
    ] {
        let most = named(id, name, &facts);
        let planned = |value: f64| {
            let mut choices = more.as_object().unwrap().clone();
            choices.insert(name.to_owned(), value.into());
            let plan = procedure(id).unwrap().plan(&choices, &facts).expect("a plan");
            (refusal(&plan, &facts), choices)
        };
        let (refused, choices) = planned(most);
        assert_eq!(refused, None, "{id} at {most}");
        assert!(planned(1.02 * most).0.is_some(), "{id}: {most}");
        let run = run_in_memory(&mut bench, procedure(id).unwrap(), &choices);
        assert!(run.is_ok(), "{id} at {most}: {:?}", run.err());
    }
}

#[test]
fn where_no_load_is_within_the_limits_none_is_named() {
    let (_mock, bench) = behind_the_gear();
    let (facts, fast) = (BenchFacts::of(&bench), json!({"speed_rad_s": 19.0}));
    let plan = procedure("stiffness").unwrap().plan(fast.as_object().unwrap(), &facts).expect("a plan");
    let message = refusal(&plan, &facts).expect("too fast");
    assert!(message.contains("reduce speed or load"), "{message}");
}
