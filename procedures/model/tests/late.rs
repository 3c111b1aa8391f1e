//! A torque delay in a run in steps: only its ramps can show it.

mod common;

use common::tables::{meta, scatter};
use jointbench_instrument::{Channel, Kind, RunTable, Trace};
use jointbench_model::{Diagnosis, ModelSpec, Options, diagnose, discover};

const STEP_S: f64 = 0.004;
const RAMP: usize = 40;
const PLATEAU: usize = 200;
const REPEATS: usize = 2;
const SPEEDS_RAD_S: [f64; 8] = [2.0, 4.0, 7.0, 12.0, 20.0, 35.0, 60.0, 90.0];
const INERTIA_KG_M2: f64 = 3e-5;
const NOISE_NM: f64 = 4e-3;

/// Speed at every sample: up to each of the speeds and down again, in both directions.
fn velocities() -> Vec<f64> {
    let mut out = Vec::new();
    for leg in 0..2 * REPEATS * SPEEDS_RAD_S.len() {
        let way = if leg % 2 == 0 { 1.0 } else { -1.0 };
        let top = way * SPEEDS_RAD_S[leg / 2 % SPEEDS_RAD_S.len()];
        let ramp = |i: usize| top * i as f64 / RAMP as f64;
        out.extend((0..RAMP).map(ramp).chain(std::iter::repeat_n(top, PLATEAU)).chain((0..RAMP).rev().map(ramp)));
    }
    out
}

/// The torque is read with a delay of this many samples against the angle, the speed with that of its filter.
fn run(torque_delay: usize, speed_delay: usize) -> RunTable {
    let velocity = velocities();
    let names = ["time_s", "motor_position_rad", "motor_velocity_rad_s", "motor_current_a", "segment", "repeat"];
    let mut trace = Trace::new(names.map(Channel::new).into());
    let torque = |i: usize| {
        let ahead = velocity.get(i + 1).copied().unwrap_or_default();
        INERTIA_KG_M2 * (ahead - velocity[i]) / STEP_S + 0.03 * velocity[i].signum() + 2e-4 * velocity[i]
    };
    let mut angle = 0.0;
    for (i, v) in velocity.iter().enumerate() {
        angle += v * STEP_S;
        let leg = i / (2 * RAMP + PLATEAU);
        let (felt, reported) = (torque(i.saturating_sub(torque_delay)), velocity[i.saturating_sub(speed_delay)]);
        let (segment, repeat) = (leg as f64, (leg / (2 * SPEEDS_RAD_S.len())) as f64);
        trace.push_row(&[i as f64 * STEP_S, angle, reported, felt + NOISE_NM * scatter(i, 1), segment, repeat]);
    }
    let mut meta = meta(Kind::Friction);
    meta.torque_constant_nm_per_a = Some(1.0);
    RunTable::new(meta, trace).unwrap()
}

fn diagnosed(run: &RunTable) -> Diagnosis {
    let spec = ModelSpec::parse(Kind::Friction, "inertia,coulomb,viscous").unwrap();
    diagnose(run, &spec, &Options::default()).unwrap()
}

#[test]
fn a_delayed_torque_is_named_with_its_delay() {
    let run = run(3, 0);
    let found = diagnosed(&run);
    let named: Vec<&str> = found.suggestions.iter().map(|s| s.effect.as_str()).collect();
    assert_eq!(named, ["signal_delay"], "{}", found.summary);
    assert!(found.summary.contains("signal_delay acts on ramps"), "{}", found.summary);
    let spec = ModelSpec::parse(Kind::Friction, "inertia,coulomb,viscous").unwrap();
    let end = discover(&run, &spec, &Options::default(), 4).unwrap();
    let of = |effect: &str| end.fit.parameters.iter().find(|p| p.effect == effect).unwrap();
    let delay_s = -of("signal_delay").value / of("inertia").value;
    assert!((0.7..1.4).contains(&(delay_s / (3.0 * STEP_S))), "{delay_s}");
}

#[test]
fn a_torque_in_time_and_a_speed_that_is_filtered_are_no_delay() {
    for speed_delay in [0, 1, 3] {
        let found = diagnosed(&run(0, speed_delay));
        assert!(found.suggestions.is_empty(), "{speed_delay}: {}", found.summary);
        let silent = found.silent.iter().find(|s| s.effect == "signal_delay");
        assert!(silent.is_some_and(|s| s.minimum_detectable_rms > 0.0), "{:?}", found.not_visible);
    }
}
