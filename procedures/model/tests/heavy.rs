//! An arm whose weight no torque sensor measures: the gear teeth transmit it, in addition to the load if there is one.

mod common;

use common::bench::{Moment, Staircase};
use common::tables::{meta, scatter};
use jointbench_instrument::{Channel, Kind, Meta, RunTable, Trace};
use jointbench_model::{Discovery, ModelSpec, Options, Verdict, diagnose, discover};
use std::f64::consts::TAU;

/// Gravity torque on the motor side of an arm that hangs down at the link angle `down` [rad].
fn weight(moment: Moment, down: f64) -> f64 {
    0.05 * (moment.link - down).sin()
}

fn run(seed: u64, down: f64, rub: impl Fn(f64) -> f64) -> RunTable {
    Staircase { noise_nm: 2e-3, scatter_nm: 1e-4, seed }.run(|moment| {
        let borne = moment.load / common::bench::GEAR + weight(moment, down);
        (0.03 + rub(borne.abs())) * moment.velocity.signum() + 1.5e-4 * moment.velocity + weight(moment, down)
    })
}

fn end(run: &RunTable) -> Discovery {
    discover(run, &ModelSpec::baseline(run).unwrap(), &Options::default(), 4).unwrap()
}

/// Added effects, sorted by name.
fn added(found: &Discovery) -> Vec<&str> {
    let mut added: Vec<&str> = found.model[3..].iter().map(String::as_str).collect();
    added.sort_unstable();
    added
}

fn value(found: &Discovery, effect: &str, name: &str) -> f64 {
    found.fit.parameters.iter().find(|p| p.effect == effect && p.name == name).unwrap().value
}

#[test]
fn teeth_that_bear_load_and_weight_rub_by_both() {
    for (seed, down) in [(1, 0.3), (2, 2.0), (3, -1.2), (4, 3.5), (5, 0.9)] {
        let found = end(&run(seed, down, |borne| 0.15 * borne));
        assert_eq!(added(&found), ["gravity", "load_linear"], "{}", found.summary);
        assert_eq!(found.verdict, Verdict::Adequate, "{}", found.summary);
        let mu = value(&found, "load_linear", "mu");
        assert!((mu / 0.15 - 1.0).abs() < 0.03, "{mu}");
        for name in ["g_c", "g_s"] {
            let [one, other] = ["gravity", "load_linear"].map(|effect| value(&found, effect, name));
            assert!((one - other).abs() < 5e-3, "one weight: {one} {other}");
        }
        let text = "load_linear is μ·|τ_link/N + g_c·cos θ_link + g_s·sin θ_link|·sign ω in this data";
        assert!(found.fit.notes.iter().any(|note| note == text), "{:?}", found.fit.notes);
    }
}

#[test]
fn friction_that_grows_with_the_square_of_both_is_named() {
    let run = run(6, 0.3, |borne| 0.5 * borne * borne);
    let missing = diagnose(&run, &ModelSpec::baseline(&run).unwrap(), &Options::default()).unwrap();
    let why = |effect: &str| missing.suggestions.iter().find(|s| s.effect == effect).unwrap().why.clone();
    let text = " load_quadratic is μ_2·(τ_link/N + g_c·cos θ_link + g_s·sin θ_link)²·sign ω in this data.";
    assert!(why("load_quadratic").ends_with(text), "{}", why("load_quadratic"));
    assert!(!why("gravity").contains("in this data"), "{}", why("gravity"));
    let found = end(&run);
    assert_eq!(added(&found), ["gravity", "load_quadratic"], "{}", found.summary);
    assert_eq!(found.verdict, Verdict::Adequate, "{}", found.summary);
}

/// If the sensor measures the weight, the load contains it and there is no other.
#[test]
fn a_weight_that_the_sensor_feels_is_load() {
    let bench = Staircase { noise_nm: 2e-3, scatter_nm: 1e-4, seed: 7 };
    let found = end(&bench.run(|moment| {
        (0.03 + 0.15 * moment.load.abs() / common::bench::GEAR) * moment.velocity.signum() + 1.5e-4 * moment.velocity
    }));
    assert_eq!(added(&found), ["load_linear"], "{}", found.summary);
    assert!(found.fit.parameters.iter().all(|p| p.name != "g_c"), "{:?}", found.fit.parameters);
    assert!(!found.fit.notes.iter().any(|note| note.starts_with("load_linear")), "{:?}", found.fit.notes);
}

/// A pendulum without a torque sensor, whose friction grows by `mu` with the gravity torque: three repeats of a swing.
fn pendulum(mu: f64) -> RunTable {
    const STEP_S: f64 = 0.005;
    const PERIOD: usize = 4000;
    let names = ["time_s", "motor_position_rad", "motor_current_a", "repeat"];
    let mut trace = Trace::new(names.map(Channel::new).into());
    let swings = [(1.1, 3.0, 0.4), (0.5, 7.0, 1.9), (0.2, 16.0, 4.0)];
    for i in 0..3 * PERIOD {
        let at = |times: f64, phase: f64| TAU * times * i as f64 / PERIOD as f64 + phase;
        let rate = |times: f64| TAU * times / (PERIOD as f64 * STEP_S);
        let sum = |of: &dyn Fn(f64, f64, f64) -> f64| {
            swings.iter().map(|(size, n, phase)| of(*size, *n, *phase)).sum::<f64>()
        };
        let angle = sum(&|size, n, phase| size * at(n, phase).sin());
        let speed = sum(&|size, n, phase| size * rate(n) * at(n, phase).cos());
        let acceleration = sum(&|size, n, phase| -size * rate(n) * rate(n) * at(n, phase).sin());
        let weight = 1.5 * (angle - 0.1).sin();
        let friction = (0.1 + mu * weight.abs()) * speed.signum() + 0.05 * speed;
        let torque = 0.02 * acceleration + friction + weight + 0.1 * scatter(i, 3);
        trace.push_row(&[i as f64 * STEP_S, angle, torque / 1.6, (i / PERIOD) as f64]);
    }
    let baseline = ["inertia", "gravity", "coulomb", "viscous"].map(String::from).into();
    let meta = Meta { torque_constant_nm_per_a: Some(1.6), gear_ratio: Some(1.0), baseline, ..meta(Kind::Friction) };
    RunTable::new(meta, trace).unwrap()
}

#[test]
fn without_a_torque_sensor_the_weight_is_the_load() {
    for (mu, expected) in [(0.08, &["load_linear"][..]), (0.0, &[])] {
        let run = pendulum(mu);
        let found = end(&run);
        assert_eq!(&found.model[4..], expected, "{}", found.summary);
        if mu > 0.0 {
            let fitted = value(&found, "load_linear", "mu");
            assert!((fitted / mu - 1.0).abs() < 0.1, "{fitted}");
        }
    }
}
