//! Encoder errors of very different size in one run: the smallest is no form error of the largest.

mod common;

use common::tables::{meta, scatter};
use jointbench_instrument::{Channel, Kind, RunTable, Trace};
use jointbench_model::{ModelSpec, Options, Verdict, discover};

const STEP_S: f64 = 0.001;
/// Speeds of the four legs of one repeat [rad/s], and their numbers of samples.
const LEGS: [(f64, usize); 4] = [(5.0, 4000), (-5.0, 4000), (50.0, 1000), (-50.0, 1000)];
/// One count of a reference of 14 bit.
const COUNT_RAD: f64 = std::f64::consts::TAU / 16384.0;

/// Eccentricity of 4.5 mrad, 64 periods of 0.28 mrad, and a direction hysteresis of 0.14 mrad.
fn run() -> RunTable {
    let names = ["time_s", "reference_position_rad", "test_position_rad", "velocity_rad_s", "segment", "repeat"]
        .map(Channel::new);
    let mut trace = Trace::new(names.into());
    let (mut angle, mut at) = (0.3f64, 0);
    for leg in 0..2 * LEGS.len() {
        let (speed, rows) = LEGS[leg % LEGS.len()];
        for _ in 0..rows {
            angle += speed * STEP_S;
            let error = 4.5e-3 * (angle - 0.5).sin() + 2.8e-4 * (64.0 * angle).sin() - 1.4e-4 * speed.signum();
            let test = angle + error + 5e-5 * scatter(at, 1);
            let reference = (angle / COUNT_RAD).round() * COUNT_RAD;
            let (segment, repeat) = (leg as f64, (leg / LEGS.len()) as f64);
            trace.push_row(&[at as f64 * STEP_S, reference, test, speed, segment, repeat]);
            at += 1;
        }
    }
    RunTable::new(meta(Kind::Encoder), trace).unwrap()
}

#[test]
fn small_waves_are_found_next_to_a_large_eccentricity() {
    let run = run();
    let spec = ModelSpec::parse(Kind::Encoder, "offset,delay").unwrap();
    let found = discover(&run, &spec, &Options::default(), 6).unwrap();
    let mut effects = found.model.clone();
    effects.sort();
    assert_eq!(effects, ["delay", "direction_hysteresis", "harmonic_1", "offset", "pole_period"]);
    assert_eq!(found.verdict, Verdict::Adequate, "{}", found.summary);
    let pole_pairs = found.fit.parameters.iter().find(|p| p.name == "pole_pairs").map(|p| p.value);
    assert_eq!(pole_pairs, Some(64.0), "one wave is the fundamental, not the second harmonic of 32");
    // Every detection limit states its search range.
    let sought = |effect: &str| found.silent.iter().find(|s| s.effect == effect).unwrap().sought.clone();
    assert_eq!((sought("harmonic_n").as_deref(), sought("harmonic_2")), (Some("3 to 15 waves a turn"), None));
}
