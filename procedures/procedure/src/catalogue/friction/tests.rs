//! Tests of the plan of a friction run against the requirements on its data.

use super::super::legs::testing::{joint_a, joint_b};
use super::*;
use crate::plan::{Phase, Step};
use serde_json::{Map, Value, json};
use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::TAU;

fn plan(given: Value, bench: &BenchFacts) -> Plan {
    Friction.plan(given.as_object().unwrap(), bench).unwrap()
}

/// Steps at constant load, by their speed in mrad/s and their current in mA.
fn points(plan: &Plan) -> BTreeMap<(i64, i64), Vec<&Step>> {
    let mut points = BTreeMap::<_, Vec<_>>::new();
    let measured = plan.steps.iter().filter(|step| step.phase == Phase::Measure);
    for step in measured.filter(|step| step.brake.knots().len() == 1) {
        let speed = step.velocity.knots()[1].1;
        points.entry(((speed * 1e3) as i64, (step.brake.end() * 1e3) as i64)).or_default().push(step);
    }
    points
}

#[test]
fn the_defaults_fit_both_joints_and_five_minutes() {
    for facts in [joint_a(), joint_b()] {
        let plan = plan(json!({}), &facts);
        let preview = plan.preview(&facts);
        assert!(preview.is_allowed(), "{:?}", preview.checks);
        assert!((150.0..=300.0).contains(&preview.duration_s), "{}: {} s", facts.name, preview.duration_s);
        let (lowest, highest) = plan.travel_rad();
        let turns = lowest.abs().max(highest) / facts.constants.gear_ratio / TAU;
        assert!(turns < 2.0, "{}: {turns} turns of the link from the start", facts.name);
        let back_rad: f64 = plan.steps.iter().map(|step| step.velocity.integral().last().unwrap().to_owned()).sum();
        assert!(back_rad.abs() < 1e-6, "{}: ends {back_rad} rad from the start", facts.name);
    }
}

/// Four speeds below the Stribeck velocity of the documents, both directions, every load, every repeat.
#[test]
fn the_grid_is_complete() {
    for (facts, stribeck_rad_s) in [(joint_a(), 0.06 * 177.8), (joint_b(), 0.08 * 50.0)] {
        let plan = plan(json!({}), &facts);
        let points = points(&plan);
        let loads: BTreeSet<i64> = points.keys().map(|(_, load)| *load).collect();
        assert_eq!(loads.len(), 3);
        for load in loads {
            let speeds: Vec<i64> = points.keys().filter(|(_, l)| *l == load).map(|(speed, _)| *speed).collect();
            for sign in [1, -1] {
                let below = |speed: &&i64| **speed * sign > 0 && (**speed as f64).abs() < 1e3 * stribeck_rad_s;
                assert!(speeds.iter().filter(below).count() >= 4, "{} at {load} mA: {speeds:?}", facts.name);
                assert!(speeds.iter().filter(|speed| **speed * sign > 0).count() >= 9);
            }
        }
        for ((speed, load), steps) in &points {
            let repeats: BTreeSet<u32> = steps.iter().map(|step| step.repeat).collect();
            assert_eq!(repeats, BTreeSet::from([0, 1]), "{speed} mrad/s at {load} mA");
        }
    }
}

/// The fastest leg covers a whole turn of the link in both directions at every load, and slow legs have different
/// positions.
#[test]
fn the_angle_of_the_link_is_covered() {
    for facts in [joint_a(), joint_b()] {
        let plan = plan(json!({}), &facts);
        let mut at_rad = 0.0;
        let mut whole_turns = BTreeSet::new();
        let mut slow_at = BTreeSet::new();
        for step in &plan.steps {
            let moved_rad = step.velocity.integral().last().unwrap() / facts.constants.gear_ratio;
            if step.phase == Phase::Measure && moved_rad.abs() >= TAU {
                whole_turns.insert((moved_rad > 0.0, (step.brake.end() * 1e3) as i64));
            }
            if step.velocity.largest() < 0.07 * facts.constants.gear_ratio {
                let turn: f64 = at_rad / TAU;
                slow_at.insert((turn.rem_euclid(1.0) * 12.0) as u32);
            }
            at_rad += moved_rad;
        }
        assert_eq!(whole_turns.len(), 6, "{}", facts.name);
        assert!(slow_at.len() >= 6, "{}: slow legs in {} of 12 sectors", facts.name, slow_at.len());
    }
}

#[test]
fn the_brake_rises_from_zero_and_falls_only_while_turning() {
    let facts = joint_a();
    let plan = plan(json!({}), &facts);
    let mut before_a = 0.0;
    for step in &plan.steps {
        assert!((step.brake.at(0.0) - before_a).abs() < 1e-9, "{}", step.label);
        let knots = step.brake.knots();
        for pair in knots.windows(2).filter(|pair| pair[1].1 < pair[0].1) {
            let turned = step.velocity.largest() * (pair[1].0 - pair[0].0) / facts.constants.gear_ratio;
            assert!(turned >= TAU - 1e-9, "{}: {turned} rad", step.label);
            assert_eq!(step.velocity.at(pair[0].0).abs(), step.velocity.largest());
            assert_eq!(step.velocity.at(pair[1].0 + 0.3).abs(), step.velocity.largest());
        }
        before_a = step.brake.end();
    }
    assert_eq!(before_a, 0.0);
}

/// Rank correlation of speed and of load with time: both must be small.
#[test]
fn time_is_not_speed_and_not_load() {
    let plan = plan(json!({}), &joint_a());
    let measured: Vec<&Step> = plan.steps.iter().filter(|step| step.phase == Phase::Measure).collect();
    let correlation = |value: fn(&Step) -> f64| {
        let n = measured.len() as f64;
        let times: Vec<f64> = (0..measured.len()).map(|i| i as f64 - 0.5 * (n - 1.0)).collect();
        let mean = measured.iter().map(|step| value(step)).sum::<f64>() / n;
        let values: Vec<f64> = measured.iter().map(|step| value(step) - mean).collect();
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        dot(&times, &values) / (dot(&times, &times) * dot(&values, &values)).sqrt()
    };
    let (speed, load) = (correlation(|step| step.velocity.largest()), correlation(|step| step.brake.end()));
    assert!(speed.abs() < 0.3, "speed against time {speed}");
    // Loads rise within a repeat (hysteresis), so with two repeats half of the trend remains.
    assert!(load.abs() < 0.5, "load against time {load}");
}

#[test]
fn a_plan_is_deterministic_and_its_order_has_a_seed() {
    let facts = joint_b();
    assert_eq!(plan(json!({}), &facts), plan(json!({"order_seed": 1}), &facts));
    let labels = |plan: &Plan| plan.steps.iter().map(|step| step.label.clone()).collect::<Vec<_>>();
    let (one, two) = (plan(json!({}), &facts), plan(json!({"order_seed": 2}), &facts));
    assert_ne!(labels(&one), labels(&two));
    let sorted = |plan: &Plan| {
        let mut labels = labels(plan);
        labels.sort();
        labels
    };
    assert_eq!(sorted(&one), sorted(&two));
}

#[test]
fn segments_are_unique_and_the_meta_facts_complete() {
    let facts = joint_a();
    let plan = plan(json!({}), &facts);
    assert!(plan.steps.iter().enumerate().all(|(index, step)| step.segment == index as u32));
    let warm_up = plan.steps.iter().filter(|step| step.phase == Phase::WarmUp).count();
    assert_eq!(plan.meta.other["warm_up_segments"], warm_up);
    assert_eq!(plan.meta.baseline, ["inertia", "load_transmission", "coulomb", "viscous"]);
    assert_eq!(plan.meta.gear_ratio, Some(177.8));
    assert_eq!(plan.parameters["repeats"], 2.0);
}

#[test]
fn a_bench_without_brake_can_do_with_one_load() {
    let mut facts = joint_a();
    (facts.has_brake, facts.has_torque_sensor) = (false, false);
    let refused = Friction.plan(&Map::new(), &facts).unwrap_err();
    assert_eq!(refused.to_string(), "bench a has no brake: set load_levels = 1, or connect it");
    let arm = BenchFacts { amperes_per_volt: Some(1.0), ..facts.clone() };
    let refused = Friction.plan(&Map::new(), &arm).unwrap_err();
    assert_eq!(refused.to_string(), "bench a has no brake: use puma_friction for the axis of an arm");
    let free = plan(json!({"load_levels": 1}), &facts);
    assert_eq!(free.top_brake_current_a(), 0.0);
    assert!(free.preview(&facts).is_allowed());
    assert!(!free.meta.baseline.contains(&"load_transmission".to_owned()));
}

#[test]
fn speeds_that_contradict_are_refused() {
    let given = json!({"top_speed_rad_s": 20.0});
    let refused = Friction.plan(given.as_object().unwrap(), &joint_a()).unwrap_err();
    assert!(refused.to_string().contains("increase top_speed_rad_s"), "{refused}");
}

proptest::proptest! {
    #![proptest_config(proptest::prelude::ProptestConfig {
        cases: 48, failure_persistence: None, ..Default::default()
    })]

    /// Any choice within the schema gives a plan or a refusal, and a plan returns to its start.
    #[test]
    fn any_choice_is_planned_or_refused(shares in proptest::collection::vec(0.0..=1.0f64, INFO.schema.len())) {
        let mut given = Map::new();
        for (parameter, share) in INFO.schema.iter().zip(shares) {
            // Limited to a multiple of the default, because the longest plans only cost time.
            let max = parameter.max.min(4.0 * parameter.default);
            let value = parameter.min + share * (max - parameter.min);
            let whole = parameter.kind == crate::parameter::ParameterKind::Integer;
            given.insert(parameter.name.into(), if whole { value.floor() } else { value }.into());
        }
        if let Ok(plan) = Friction.plan(&given, &joint_a()) {
            let back_rad: f64 = plan.steps.iter().map(|step| step.velocity.integral().last().unwrap().to_owned()).sum();
            proptest::prop_assert!(back_rad.abs() < 1e-3);
            proptest::prop_assert!(plan.preview(&joint_a()).checks[2].ok);
        }
    }
}

/// Under load a slow leg never reverses, because the wind-up of joint and brake would last longer than the leg.
#[test]
fn loaded_slow_legs_go_on_in_the_direction_before() {
    for facts in [joint_a(), joint_b()] {
        let plan = plan(json!({}), &facts);
        let speed = |step: &Step| step.velocity.knots()[1].1;
        let wound_up_rad = 0.06 * facts.constants.gear_ratio;
        for pair in plan.steps.windows(2).filter(|pair| pair[1].brake.knots().len() == 1) {
            let is_slow = speed(&pair[1]).abs() < 0.07 * facts.constants.gear_ratio;
            if is_slow && pair[1].brake.end() > 0.0 {
                assert_eq!(
                    speed(&pair[0]).signum(),
                    speed(&pair[1]).signum(),
                    "{} then {}",
                    pair[0].label,
                    pair[1].label
                );
            } else if !is_slow && pair[1].brake.end() > 0.0 && speed(&pair[0]) * speed(&pair[1]) < 0.0 {
                let travelled_rad = pair[1].velocity.integral().last().unwrap().abs();
                assert!(travelled_rad > 2.0 * wound_up_rad, "{} after a reversal: {travelled_rad} rad", pair[1].label);
            }
        }
    }
}

#[test]
fn the_order_differs_from_tour_to_tour() {
    let facts = joint_a();
    let plan = plan(json!({}), &facts);
    let mut tours = BTreeMap::<_, Vec<i64>>::new();
    for step in plan.steps.iter().filter(|step| step.phase == Phase::Measure && step.brake.knots().len() == 1) {
        let speed = step.velocity.knots()[1].1.abs();
        if speed > 0.07 * facts.constants.gear_ratio {
            tours.entry((step.repeat, (step.brake.end() * 1e3) as i64)).or_default().push(speed as i64);
        }
    }
    let orders: BTreeSet<&[i64]> = tours.values().map(|speeds| &speeds[..5]).collect();
    assert!(orders.len() >= 5, "{orders:?}");
}
