//! A hump over the speed, where friction has none, is outside the library, whatever two effects that cancel make of it.

mod common;

use common::tables::{meta, scatter};
use jointbench_instrument::{Channel, Kind, RunTable, Trace};
use jointbench_model::{ModelSpec, Options, Verdict, discover};

const STEP_S: f64 = 0.004;
const ROWS: usize = 220;
const SPEEDS_RAD_S: [f64; 13] = [0.8, 1.2, 1.8, 2.7, 4.1, 6.1, 9.1, 13.7, 20.5, 30.8, 46.1, 69.2, 103.8];
const REPEATS: usize = 3;

/// Friction in steps both ways with `height_nm` more about one speed, `wide` in its logarithm.
fn run(speed_rad_s: f64, wide: f64, height_nm: f64, seed: u64) -> RunTable {
    let names = ["time_s", "motor_position_rad", "motor_velocity_rad_s", "motor_current_a", "segment", "repeat"];
    let mut trace = Trace::new(names.map(Channel::new).into());
    let (mut angle, mut at) = (0.0f64, 0);
    for leg in 0..2 * REPEATS * SPEEDS_RAD_S.len() {
        let way = if leg % 2 == 0 { 1.0 } else { -1.0 };
        let speed = SPEEDS_RAD_S[leg / 2 % SPEEDS_RAD_S.len()];
        for _ in 0..ROWS {
            angle += way * speed * STEP_S;
            let hump = height_nm * (-0.5 * ((speed / speed_rad_s).ln() / wide).powi(2)).exp();
            let torque = way * (0.016 + 4e-5 * speed + hump) + 4e-3 * scatter(at, seed) + 4e-4 * scatter(leg, seed + 9);
            let (segment, repeat) = (leg as f64, (leg / (2 * SPEEDS_RAD_S.len())) as f64);
            trace.push_row(&[at as f64 * STEP_S, angle, way * speed, torque, segment, repeat]);
            at += 1;
        }
    }
    let mut meta = meta(Kind::Friction);
    (meta.torque_constant_nm_per_a, meta.gear_ratio) = (Some(1.0), Some(1.0));
    RunTable::new(meta, trace).unwrap()
}

#[test]
fn a_hump_over_the_speed_is_structure() {
    for (speed, wide, height, seed) in [(8.0, 0.3, 2.5e-3, 1), (8.0, 0.3, 2.5e-3, 2), (14.0, 0.2, 1.5e-3, 2)] {
        let run = run(speed, wide, height, seed);
        let spec = ModelSpec::parse(Kind::Friction, "coulomb,viscous").unwrap();
        let found = discover(&run, &spec, &Options::default(), 4, |_| {}).unwrap();
        assert_eq!(found.verdict, Verdict::UnexplainedStructure, "{speed} rad/s: {}", found.summary);
        // Once viscous_sublinear and viscous_quadratic were named, with Coulomb friction below zero between them.
        assert_eq!(found.model, ["coulomb", "viscous"], "{speed} rad/s, {seed}");
    }
}
