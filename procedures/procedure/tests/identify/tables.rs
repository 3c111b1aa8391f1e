//! Simulated runs without a bench, with known parameters and noise.

use jointbench_instrument::{Channel, Kind, Meta, RunTable, Trace};
use jointbench_procedure::identification::{Identification, Verdict};
use jointbench_procedure::parameter::Values;
use jointbench_procedure::procedure;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};
use serde_json::json;
use std::cell::Cell;

const GEAR: f64 = 177.8;
const TORQUE_CONSTANT: f64 = 0.0406;

/// Two repeats of eleven speeds in both directions, 0.8 s each at 250 Hz; the torque is a function of speed.
fn staircase(torque_nm: impl Fn(f64) -> f64) -> RunTable {
    let names = ["time_s", "motor_position_rad", "motor_velocity_rad_s", "motor_current_a", "segment", "repeat"];
    let mut trace = Trace::new(names.iter().map(|name| Channel::new(*name)).collect());
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let noise = Normal::new(0.0, 0.1 * TORQUE_CONSTANT).unwrap();
    let scatter = Normal::new(0.0, 1e-4).unwrap();
    let (mut time_s, mut position, mut segment) = (0.0, 0.0, 0.0);
    for repeat in 0..2 {
        for speed in [1.6, 3.2, 5.0, 8.0, 12.0, 17.0, 25.0, 40.0, 65.0, 110.0, 180.0] {
            for velocity in [speed, -speed] {
                let offset = scatter.sample(&mut random);
                for _ in 0..200 {
                    time_s += 0.004;
                    position += velocity * 0.004;
                    let torque = torque_nm(velocity) + offset + noise.sample(&mut random);
                    let current = torque / TORQUE_CONSTANT;
                    trace.push_row(&[time_s, position, velocity, current, segment, f64::from(repeat)]);
                }
                segment += 1.0;
            }
        }
    }
    let meta = Meta {
        kind: Some(Kind::Friction),
        torque_constant_nm_per_a: Some(TORQUE_CONSTANT),
        gear_ratio: Some(GEAR),
        ..Meta::default()
    };
    RunTable::new(meta, trace).unwrap()
}

fn identified(id: &str, run: &RunTable) -> Identification {
    identified_with(id, json!({}), run)
}

fn identified_with(id: &str, given: serde_json::Value, run: &RunTable) -> Identification {
    let procedure = procedure(id).unwrap();
    let values = Values::parse(procedure.schema(), given.as_object().unwrap()).unwrap();
    procedure.identify(&values, run).unwrap()
}

/// The interval contains the truth, with a half width of at most `share` of it.
fn check(found: &Identification, name: &str, truth: f64, share: f64) {
    let quantity = found.quantity(name).unwrap_or_else(|| panic!("no {name}"));
    let [low, high] = quantity.ci95.unwrap();
    assert!(low <= truth && truth <= high, "{name}: [{low}, {high}] without {truth}");
    assert!(high - low <= 2.0 * share * truth, "{name}: [{low}, {high}] is wider than {share} of {truth}");
}

/// Joint A of docs/documents.md.
fn joint_a(velocity: f64) -> f64 {
    let speed = velocity.abs();
    let rise = 0.009 * (-(speed / (0.06 * GEAR)).powf(0.8)).exp();
    (0.030 + 1.512e-4 * speed + rise) * velocity.signum()
}

#[test]
fn friction_finds_every_figure_of_the_document() {
    let found = identified("friction", &staircase(joint_a));
    assert_eq!(found.verdict, Verdict::Identified, "{}", found.summary);
    for (name, truth, share) in
        [("tau_c", 0.030, 0.03), ("c_v", 1.512e-4, 0.04), ("tau_h", 0.039, 0.10), ("omega_s", 0.06, 0.4)]
    {
        check(&found, name, truth, share);
    }
    assert!(
        found.summary.contains("Coulomb friction does not differ significantly between directions (95 %): "),
        "{}",
        found.summary
    );
    assert!(found.quantity("r2_positive").unwrap().value > 0.99);
}

#[test]
fn directions_that_differ_are_distinguished() {
    let found = identified("friction", &staircase(|v| joint_a(v) + 0.002));
    assert!(found.summary.contains("Coulomb friction differs between directions (95 %): "), "{}", found.summary);
    let positive = found.quantity("tau_c_positive").unwrap().value;
    let negative = found.quantity("tau_c_negative").unwrap().value;
    assert!((positive - negative - 0.004).abs() < 0.001, "{positive} {negative}");
}

#[test]
fn without_a_rise_towards_standstill_none_is_made_up() {
    let found = identified("friction", &staircase(|v| 0.030 * v.signum() + 1.512e-4 * v));
    assert_eq!(found.verdict, Verdict::Identified, "{}", found.summary);
    assert!(found.quantity("tau_h").is_none() && found.advice.is_none(), "{found:?}");
    check(&found, "tau_c", 0.030, 0.02);
    let most_nm = found.quantity("tau_s_most").unwrap().value;
    assert!(most_nm > 1e-5 && most_nm < 1e-3, "{most_nm}");
}

#[test]
fn a_rise_that_could_hide_is_not_decided() {
    // A wave over speed that is so small that speed explains nearly all of it.
    let wave = |v: f64| 0.002 * (7.0 * v.ln_1p()).sin();
    let found = identified("friction", &staircase(|v| (0.030 + wave(v.abs())) * v.signum() + 1.512e-4 * v));
    assert_eq!(found.verdict, Verdict::Inconclusive, "{}", found.summary);
    assert!(found.advice.is_some_and(|advice| advice.contains("may mask the Stribeck effect")), "{}", found.summary);
}

#[test]
fn scatter_that_speed_does_not_explain_is_reported() {
    // A different torque in every leg.
    let sample = Cell::new(0_u32);
    let found = identified(
        "friction",
        &staircase(|v| {
            let leg = f64::from(sample.replace(sample.get() + 1) / 200);
            joint_a(v) + 0.008 * (2.4 * leg).sin()
        }),
    );
    assert!(found.summary.contains("speed explains only"), "{}", found.summary);
    assert!(found.advice.is_some_and(|advice| advice.contains("jointbench diagnose")));
}

#[test]
fn friction_that_drowns_in_something_else_is_not_asked_for_a_higher_speed() {
    let sample = Cell::new(0);
    let leg = || f64::from(sample.replace(sample.get() + 1_u32) / 200);
    let found = identified("friction", &staircase(|v| joint_a(v) + 0.3 * (2.4 * leg()).sin()));
    assert_eq!(found.verdict, Verdict::Failed, "{}", found.summary);
    assert!(found.summary.contains("mNm RMS of the torque is unexplained"), "{}", found.summary);
    assert!(found.advice.is_some_and(|advice| advice.contains("jointbench diagnose")));
}

#[test]
fn strokes_draw_a_line_through_each_direction() {
    let strokes = |run: &RunTable| identified_with("strokes", json!({"top_speed_rad_s": 180.0}), run);
    let found = strokes(&staircase(|v| 0.030 * v.signum() + 1.512e-4 * v));
    check(&found, "slope_positive", 1.512e-4, 0.03);
    check(&found, "offset_positive", 0.030, 0.02);
    assert_eq!((found.verdict, found.advice), (Verdict::Identified, None));
    let found = strokes(&staircase(|v| 0.030 * v.signum() + 0.002 * (7.0 * v).sin()));
    assert_eq!(found.verdict, Verdict::Inconclusive, "{}", found.summary);
    let advice = found.advice.unwrap();
    assert!(
        advice.contains("no significant linear effect in positive motion (r² 0.") && advice.contains("Diagnose"),
        "{advice}"
    );
}

#[test]
fn an_unusable_run_gets_a_verdict_with_a_cure() {
    let mut trace = Trace::new(
        ["time_s", "motor_position_rad", "motor_current_a", "segment"].map(Channel::new).into_iter().collect(),
    );
    (0..100).for_each(|i| trace.push_row(&[f64::from(i) * 0.004, 0.0, 0.1, 0.0]));
    let meta = Meta {
        kind: Some(Kind::Friction),
        torque_constant_nm_per_a: Some(0.04),
        gear_ratio: Some(50.0),
        ..Meta::default()
    };
    let run = RunTable::new(meta, trace).unwrap();
    for id in ["friction", "friction_load", "friction_temperature", "warm_up", "strokes", "torque_sensor_zero"] {
        let found = identified(id, &run);
        assert_eq!(found.verdict, Verdict::Failed, "{id}: {}", found.summary);
        assert!(found.advice.is_some_and(|advice| !advice.is_empty()), "{id}");
    }
}
