//! Tests of the plan and of refusals.

use super::super::legs::testing::joint_a;
use super::*;
use jointbench_instrument::Limits;
use serde_json::{Map, json};

fn puma() -> BenchFacts {
    let mut facts = joint_a();
    facts.name = "puma".into();
    facts.limits = Limits { motor_velocity_rad_s: 120.0, motor_current_a: 5.0, link_torque_nm: 0.0, ..facts.limits };
    facts.constants.torque_constant_nm_per_a = 0.231;
    facts.constants.gear_ratio = 107.815;
    facts.constants.rotor_inertia_kg_m2 = 2e-4;
    facts.constants.link_range_rad = Some(1.6);
    BenchFacts {
        has_torque_sensor: false,
        has_two_ranges: false,
        has_brake: false,
        amperes_per_volt: Some(1.0),
        feeds_forward: false,
        ..facts
    }
}

#[test]
fn every_speed_passes_the_upright_pose_both_ways_and_the_run_ends_there() {
    let plan = PumaFriction.plan(&Map::new(), &puma()).unwrap();
    let preview = plan.preview(&puma());
    assert!(preview.is_allowed(), "{:?}", preview.checks);
    let (lowest, highest) = plan.travel_rad();
    let arc_rad = 0.45 * 107.815;
    assert!((lowest + arc_rad).abs() < 1e-6 && (highest - arc_rad).abs() < 1e-6, "{lowest} to {highest}");
    let end: f64 = plan.steps.iter().filter_map(|step| step.velocity.integral().last().copied()).sum();
    assert!(end.abs() < 1e-6, "{end} rad");
    let fact = |name: &str| plan.meta.other[name].as_u64().unwrap() as usize;
    assert_eq!(fact("line_segments"), 3 * 8 * 2);
    let lines = &plan.steps[fact("warm_up_segments")..][..fact("line_segments")];
    let top = |sign: f64| lines.iter().filter(|s| s.velocity.integral().last().unwrap() * sign > 0.0).count();
    assert_eq!((top(1.0), top(-1.0)), (24, 24));
    assert_eq!(plan.steps.iter().filter(|step| matches!(step.drive, Drive::Current { .. })).count(), 8);
}

#[test]
fn what_cannot_be_measured_is_refused_with_its_cure() {
    let refusal = |given: serde_json::Value, facts: &BenchFacts| {
        PumaFriction.plan(given.as_object().unwrap(), facts).unwrap_err().to_string()
    };
    assert!(refusal(json!({}), &joint_a()).contains("bench a does not measure the motor current as shunt voltage"));
    assert!(refusal(json!({"top_speed_rad_s": 0.1}), &puma()).contains("is too close to lowest_speed_rad_s"));
    assert!(refusal(json!({"arc_rad": 0.03}), &puma()).contains("cannot be held on this arc"));
}
