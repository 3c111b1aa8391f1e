//! Tests of the plan and of refusals.

use super::super::legs::testing::joint_a;
use super::*;
use jointbench_instrument::Limits;
use jointbench_instrument::roles::SetpointInterval;
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
        setpoint_interval: Some(SetpointInterval { tick_s: 0.875e-3, ticks: 32 }),
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
fn commands_are_at_least_as_frequent_as_set_points_are_reached() {
    let planned = |ticks: u8, rate_hz: f64| {
        let facts = BenchFacts { setpoint_interval: Some(SetpointInterval { tick_s: 0.875e-3, ticks }), ..puma() };
        let plan = PumaFriction.plan(json!({"sample_rate_hz": rate_hz}).as_object().unwrap(), &facts).unwrap();
        let refusal = plan.preview(&facts).checks.into_iter().find(|check| !check.ok).map(|check| check.refusal());
        assert_eq!(plan.meta.sample_rate_hz, Some(plan.rate_hz));
        (refusal, (1e3 * plan.rate_hz).round())
    };
    let refused = planned(8, 100.0).0.unwrap();
    assert!(refused.contains("every 10.000 ms") && refused.contains("set sample_rate_hz = 143 or more"), "{refused}");
    // Ten ticks or more are free, fewer are a whole number.
    for (ticks, wanted_hz, rate_mhz) in
        [(16, 100.0, 1e5), (32, 114.0, 1.14e5), (8, 143.0, 142_857.0), (8, 200.0, 190_476.0)]
    {
        assert_eq!(planned(ticks, wanted_hz), (None, rate_mhz));
    }
}

#[test]
fn a_long_set_point_interval_needs_a_longer_arc_or_a_lower_speed() {
    let facts = BenchFacts { setpoint_interval: Some(SetpointInterval { tick_s: 0.875e-3, ticks: 128 }), ..puma() };
    let plan = |top_speed: f64| PumaFriction.plan(json!({"top_speed_rad_s": top_speed}).as_object().unwrap(), &facts);
    let refused = plan(0.698).unwrap_err().to_string();
    let most: f64 =
        refused.split("on this arc, ").nth(1).and_then(|rest| rest.split(' ').next()).unwrap().parse().unwrap();
    assert!(plan(most).is_ok() && plan(most + 2e-3).is_err(), "{refused}");
    assert!(most > 0.4 && most < 0.6, "{refused}");
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
