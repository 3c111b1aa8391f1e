//! The second brake loads a joint beyond its limits: a refused plan names the load that does not.

use jointbench_devices::sim::Load;
use jointbench_devices::{Joint, MockBench, MockSettings};
use jointbench_procedure::{BenchFacts, Plan, procedure};
use serde_json::json;

fn behind_the_gear() -> BenchFacts {
    let settings = MockSettings { load: Load::GearAndBrakeB, ..MockSettings::new(Joint::JointA, 1) };
    let mock = MockBench::start(settings).expect("a mock bench");
    BenchFacts::of(&mock.open_bench("mock").expect("its instruments answer"))
}

/// What stands in the way of a plan.
fn refusal(plan: &Plan, bench: &BenchFacts) -> Option<String> {
    plan.preview(bench).checks.into_iter().find(|check| !check.ok).map(|check| check.refusal())
}

#[test]
fn a_refused_load_comes_with_the_largest_one_that_passes() {
    let bench = behind_the_gear();
    for (id, name) in [
        ("stiffness", "top_load"),
        ("friction", "top_load"),
        ("brake_speed_independence", "top_current"),
        ("brake_hysteresis", "top_current"),
    ] {
        let procedure = procedure(id).expect("a procedure");
        let plan = |choices: serde_json::Value| procedure.plan(choices.as_object().unwrap(), &bench).expect("a plan");
        let Some(said) = refusal(&plan(json!({})), &bench) else { panic!("{id} passes with its defaults") };
        let share = said.split(&format!("set {name} = ")).nth(1).and_then(|rest| rest.split(' ').next());
        let share: f64 = share.and_then(|share| share.parse().ok()).unwrap_or_else(|| panic!("{id}: {said}"));
        assert_eq!(refusal(&plan(json!({ name: share })), &bench), None, "{id}: {said}");
        assert!(refusal(&plan(json!({ name: share + 0.01 })), &bench).is_some(), "{id}: {said}");
    }
}

#[test]
fn where_no_load_passes_none_is_named() {
    let bench = behind_the_gear();
    let fast = json!({"speed_rad_s": 19.0});
    let plan = procedure("stiffness").unwrap().plan(fast.as_object().unwrap(), &bench).expect("a plan");
    let said = refusal(&plan, &bench).expect("too fast");
    assert!(said.contains("reduce speed or load"), "{said}");
}
