//! A Stribeck effect whose exponent is free bends into the place of a square of speed, at the cost of Coulomb friction.

mod common;

use common::tables::{meta, scatter};
use jointbench_instrument::{Channel, Kind, RunTable, Trace};
use jointbench_model::{Discovery, ModelSpec, Options, Verdict, discover};

const STEP_S: f64 = 0.004;
const ROWS: usize = 250;
const REPEATS: usize = 5;
const SPEEDS_RAD_S: [f64; 11] = [2.4, 3.5, 5.1, 7.6, 11.5, 16.6, 24.1, 35.0, 50.3, 105.0, 152.0];
const NOISE_NM: f64 = 3e-3;

/// Friction in steps both ways, with a Stribeck effect and so much of the square of speed [Nm·s²/rad²].
fn found(square: f64) -> Discovery {
    let names = ["time_s", "motor_position_rad", "motor_velocity_rad_s", "motor_current_a", "segment", "repeat"];
    let mut trace = Trace::new(names.map(Channel::new).into());
    let (mut angle, mut at) = (0.0f64, 0);
    for leg in 0..2 * REPEATS * SPEEDS_RAD_S.len() {
        let way = if leg % 2 == 0 { 1.0 } else { -1.0 };
        let speed = SPEEDS_RAD_S[leg / 2 % SPEEDS_RAD_S.len()];
        for _ in 0..ROWS {
            angle += way * speed * STEP_S;
            let stribeck = 6.7e-3 * (-(speed / 17.7).powi(2)).exp();
            let friction = way * (0.019 + 4.6e-5 * speed + stribeck + square * speed * speed);
            let (segment, repeat) = (leg as f64, (leg / (2 * SPEEDS_RAD_S.len())) as f64);
            trace.push_row(&[
                at as f64 * STEP_S,
                angle,
                way * speed,
                friction + NOISE_NM * scatter(at, 1),
                segment,
                repeat,
            ]);
            at += 1;
        }
    }
    let mut meta = meta(Kind::Friction);
    meta.torque_constant_nm_per_a = Some(1.0);
    let run = RunTable::new(meta, trace).unwrap();
    let spec = ModelSpec::parse(Kind::Friction, "coulomb,viscous").unwrap();
    discover(&run, &spec, &Options::default(), 4, |_| {}).unwrap()
}

#[test]
fn a_square_of_speed_that_a_stribeck_effect_has_bent_into_is_named() {
    for square in [1.7e-7, 6e-7] {
        let end = found(square);
        assert_eq!(end.model[2..], ["stribeck", "viscous_quadratic"], "{}", end.summary);
        assert_eq!(end.verdict, Verdict::Adequate, "{}", end.summary);
        let tau_c = end.fit.parameters.iter().find(|p| p.name == "tau_c").unwrap().value;
        assert!((tau_c - 0.019).abs() < 0.001, "{tau_c}");
    }
}

#[test]
fn a_stribeck_effect_alone_stays_alone() {
    assert_eq!(found(0.0).model[2..], ["stribeck"]);
}
