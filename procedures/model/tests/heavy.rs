//! An arm whose weight the torque sensor does not measure: the gear teeth transmit it in addition to the load.

mod common;

use common::bench::{Moment, Staircase};
use jointbench_instrument::RunTable;
use jointbench_model::{Discovery, ModelSpec, Options, Verdict, diagnose, discover};

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
    discover(run, &ModelSpec::baseline(run).unwrap(), &Options::default(), 4, |_| {}).unwrap()
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
