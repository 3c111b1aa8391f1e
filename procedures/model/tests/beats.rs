//! A signal that repeats with time at one speed is no wave over the angle, although it looks like one there.

mod common;

use common::tables::{friction_in_steps, meta, scatter};
use jointbench_instrument::{Channel, Kind, RunTable, Trace};
use jointbench_model::{ModelSpec, Options, discover};
use std::f64::consts::TAU;

const STEP_S: f64 = 0.004;
const ROWS: usize = 220;
const SPEEDS_RAD_S: [f64; 6] = [2.2, 3.3, 4.9, 7.3, 11.0, 16.4];
const REPEATS: usize = 10;
const NOISE_NM: f64 = 0.8e-3;

/// Friction in steps in both directions, twice, with an additional torque as a function of the motor angle [rad], the
/// speed [rad/s] and the time since the start of the step [s].
fn named(torque_nm: impl Fn(f64, f64, f64) -> f64) -> Vec<String> {
    let run = friction_in_steps(&SPEEDS_RAD_S, REPEATS, ROWS, |now| {
        let friction = 0.08 * now.velocity.signum() + 4e-4 * now.velocity;
        friction + torque_nm(now.angle, now.velocity, now.step_s) + NOISE_NM * scatter(now.row, 1)
    });
    let spec = ModelSpec::parse(Kind::Friction, "coulomb,viscous").unwrap();
    let found = discover(&run, &spec, &Options::default(), 4).unwrap();
    found.model[2..].to_vec()
}

#[test]
fn counts_that_beat_with_the_samples_are_no_wave() {
    // 62.5 Hz at the slowest speed: means over 40 ms look like those of 36 waves in a turn, in both directions.
    let beat = |_: f64, velocity: f64, t_s: f64| {
        if velocity.abs() < 3.0 { 4e-3 * velocity.signum() * (TAU * 62.5 * t_s).cos() } else { 0.0 }
    };
    assert_eq!(named(beat), [""; 0]);
}

#[test]
fn what_only_one_of_six_speeds_shows_is_no_wave() {
    let at_one = |angle: f64, velocity: f64, _: f64| {
        if (4.0..5.5).contains(&velocity.abs()) { 1.5e-3 * (5.0 * angle).cos() } else { 0.0 }
    };
    assert_eq!(named(at_one), [""; 0]);
}

#[test]
fn waves_over_the_angle_are_found_where_means_hardly_follow() {
    for order in [5.0, 30.0] {
        assert_eq!(named(|angle, _, _| 2e-3 * (order * angle).cos()), ["cogging"], "{order} waves a turn");
    }
}

/// An encoder bench at the same speeds, with an additional error as a function of the angle [rad].
fn named_of_encoder(error_rad: impl Fn(f64) -> f64) -> Vec<String> {
    let names = ["time_s", "reference_position_rad", "test_position_rad", "velocity_rad_s", "segment", "repeat"];
    let mut trace = Trace::new(names.map(Channel::new).into());
    let (mut angle, mut at) = (0.0f64, 0);
    for leg in 0..2 * REPEATS * SPEEDS_RAD_S.len() {
        let velocity = if leg % 2 == 0 { 1.0 } else { -1.0 } * SPEEDS_RAD_S[leg / 2 % SPEEDS_RAD_S.len()];
        for _ in 0..ROWS {
            angle += velocity * STEP_S;
            let test = angle + 0.3 + error_rad(angle) + 1e-4 * scatter(at, 2);
            let (segment, repeat) = (leg as f64, (leg / (2 * SPEEDS_RAD_S.len())) as f64);
            trace.push_row(&[at as f64 * STEP_S, angle, test, velocity, segment, repeat]);
            at += 1;
        }
    }
    let mut meta = meta(Kind::Encoder);
    meta.pole_pairs = Some(24);
    let run = RunTable::new(meta, trace).unwrap();
    let spec = ModelSpec::parse(Kind::Encoder, "offset").unwrap();
    let found = discover(&run, &spec, &Options::default(), 4).unwrap();
    found.model[1..].to_vec()
}

#[test]
fn a_harmonic_sought_among_a_hundred_is_named_from_the_practical_share_on() {
    // 0, 0.8 and 3 % of the squared error. The permutation test takes the largest score over all orders.
    assert_eq!(named_of_encoder(|_| 0.0), [""; 0]);
    assert_eq!(named_of_encoder(|angle| 2.0e-6 * (7.0 * angle).cos()), [""; 0]);
    assert_eq!(named_of_encoder(|angle| 3.8e-6 * (7.0 * angle).cos()), ["harmonic_n"]);
}
