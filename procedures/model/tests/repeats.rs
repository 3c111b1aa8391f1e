//! Validation of repeats.

mod common;

use common::tables::meta;
use jointbench_instrument::{Channel, Kind, RunTable, Trace};
use jointbench_model::{Diagnosis, ModelSpec, Options, Verdict, diagnose};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};

/// Three repeats of swings with a phase difference of `shift` between repeats, each starting at its own position.
fn swings(shift: f64) -> Diagnosis {
    const STEP_S: f64 = 0.01;
    let names = "time_s motor_position_rad motor_current_a repeat";
    let mut trace = Trace::new(names.split(' ').map(Channel::new).collect());
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let noise = Normal::new(0.0, 1.0).unwrap();
    for i in 0..4_500 {
        let (repeat, t) = (i / 1_500, STEP_S * (i % 1_500) as f64);
        let phase = shift * repeat as f64;
        let waves = [(9.0, 0.9, 0.0), (4.0, 2.1, phase), (1.5, 3.7, 2.0 * phase)];
        let position: f64 = waves.iter().map(|(a, w, p)| a * (w * t + p).sin()).sum();
        let velocity: f64 = waves.iter().map(|(a, w, p)| a * w * (w * t + p).cos()).sum();
        let torque = 2e-3 * velocity + 1e-3 * noise.sample(&mut random);
        trace.push_row(&[STEP_S * i as f64, position, torque / 0.08, repeat as f64]);
    }
    let run = RunTable::new(meta(Kind::Friction), trace).unwrap();
    diagnose(&run, &ModelSpec::baseline(&run).unwrap(), &Options::default()).unwrap()
}

#[test]
fn repeats_of_one_motion_determine_the_noise() {
    let found = swings(0.0);
    assert!(found.noise_floor_rms.is_some_and(|rms| rms < 1e-3), "{:?}", found.noise_floor);
    assert_eq!((found.verdict, &found.undecided), (Verdict::Adequate, &None), "{}", found.summary);
}

#[test]
fn repeats_of_different_motions_determine_no_noise() {
    let found = swings(1.3);
    assert_eq!(found.noise_floor_rms, None);
    assert!(found.noise_floor.source.contains("different motions; their"), "{}", found.noise_floor.source);
    assert!(found.undecided.is_some() && found.suggestions.is_empty(), "{}", found.summary);
    assert!(found.experiment.is_some(), "the run that would tell");
}

/// Without a load, the torque sensor reads only noise in each leg, and no two legs have the same.
#[test]
fn noise_of_a_torque_sensor_makes_no_other_condition() {
    const STEP_S: f64 = 0.004;
    let names = "time_s motor_position_rad motor_velocity_rad_s motor_current_a link_torque_nm segment repeat";
    let mut trace = Trace::new(names.split(' ').map(Channel::new).collect());
    let mut random = ChaCha8Rng::seed_from_u64(6);
    let noise = Normal::new(0.0, 1.0).unwrap();
    let (mut i, mut position) = (0, 0.7);
    for leg in 0..48 {
        let sign = if leg % 2 == 0 { 1.0 } else { -1.0 };
        let velocity = sign * 2.5 * 1.52f64.powi(leg % 24 / 2);
        let reading = 1e-3 * noise.sample(&mut random);
        for _ in 0..150 {
            let torque = 0.03 * sign + 1.5e-4 * velocity + 1e-3 * noise.sample(&mut random);
            let segment = f64::from(leg);
            let repeat = f64::from(leg / 24);
            trace.push_row(&[STEP_S * f64::from(i), position, velocity, torque / 0.08, reading, segment, repeat]);
            (i, position) = (i + 1, position + STEP_S * velocity);
        }
    }
    let run = RunTable::new(meta(Kind::Friction), trace).unwrap();
    let found = diagnose(&run, &ModelSpec::baseline(&run).unwrap(), &Options::default()).unwrap();
    // 48 legs of at most 15 chunks of ten samples.
    let (rms, floor) = (1e-3 / 10f64.sqrt(), &found.noise_floor);
    assert!(floor.rms.is_some_and(|found| (found / rms - 1.0).abs() < 0.15), "{floor:?}");
    assert!(floor.ci95.is_some_and(|[low, high]| high < 1.5 * low), "{floor:?}");
    assert_eq!((found.verdict, &found.undecided), (Verdict::Adequate, &None), "{}", found.summary);
}

/// Every leg begins at a random link position, and one tooth is damaged.
#[test]
fn repeats_that_begin_at_other_angles_meet_where_they_pass_the_same() {
    const STEP_S: f64 = 0.004;
    let names = "time_s motor_position_rad motor_velocity_rad_s motor_current_a segment repeat";
    let mut trace = Trace::new(names.split(' ').map(Channel::new).collect());
    let mut random = ChaCha8Rng::seed_from_u64(9);
    let noise = Normal::new(0.0, 1.0).unwrap();
    let gear = meta(Kind::Friction).gear_ratio.unwrap();
    let mut i = 0;
    for leg in 0..80 {
        let sign = if leg % 2 == 0 { 1.0 } else { -1.0 };
        let velocity = sign * gear * 0.25 * 1.35f64.powi(leg % 20 / 2 * 7 % 10);
        let mut position = gear * 3.9 * f64::from(leg);
        for _ in 0..300 {
            let bad = (-(((position / gear).rem_euclid(std::f64::consts::TAU) - 2.0) / 0.15).powi(2)).exp();
            let torque = (0.03 + 6e-3 * bad) * sign + 1.5e-4 * velocity + 1e-3 * noise.sample(&mut random);
            let (segment, repeat) = (f64::from(leg), f64::from(leg / 20));
            trace.push_row(&[STEP_S * f64::from(i), position, velocity, torque / 0.08, segment, repeat]);
            (i, position) = (i + 1, position + STEP_S * velocity);
        }
    }
    let run = RunTable::new(meta(Kind::Friction), trace).unwrap();
    let found = diagnose(&run, &ModelSpec::baseline(&run).unwrap(), &Options::default()).unwrap();
    assert_eq!(found.verdict, Verdict::UnexplainedStructure, "{}", found.summary);
    assert!(found.noise_floor.source.contains("at other angles"), "{:?}", found.noise_floor);
    assert!(found.noise_floor.repeatable_share.is_some_and(|share| share > 0.5), "{:?}", found.noise_floor);
}

/// An industrial robot whose three repeats are three different motions.
#[test]
fn kr300_repeats_are_different_motions() {
    let Some(data) = common::shared("data") else { return };
    for axis in ["kr300-axis1", "kr300-axis2", "kr300-axis3"] {
        let run = common::read(&data.join(axis));
        let found = diagnose(&run, &ModelSpec::baseline(&run).unwrap(), &Options::default()).unwrap();
        assert!(found.noise_floor.source.contains("different motions"), "{axis}: {}", found.noise_floor.source);
        assert!(found.verdict != Verdict::Adequate || found.undecided.is_some(), "{axis}: {}", found.summary);
    }
}

/// Slow legs with repeats, and fast legs with 50 % more noise without repeats.
#[test]
fn an_error_above_the_noise_floor_is_reported() {
    const STEP_S: f64 = 0.004;
    let names = "time_s motor_position_rad motor_velocity_rad_s motor_current_a segment repeat";
    let mut trace = Trace::new(names.split(' ').map(Channel::new).collect());
    let mut random = ChaCha8Rng::seed_from_u64(7);
    let noise = Normal::new(0.0, 1.0).unwrap();
    let (mut i, mut position) = (0, 0.7);
    for leg in 0..72 {
        let sign = if leg % 2 == 0 { 1.0 } else { -1.0 };
        let again = leg < 48;
        let velocity = sign * if again { 2.5 * 1.2f64.powi(leg % 24 / 2) } else { 20.0 * 1.1f64.powi(leg % 24 / 2) };
        for _ in 0..150 {
            let rough = if again { 1e-3 } else { 1.5e-3 };
            let torque = 0.03 * sign + 1.5e-4 * velocity + rough * noise.sample(&mut random);
            let repeat = f64::from(leg / 24 % 2);
            trace.push_row(&[STEP_S * f64::from(i), position, velocity, torque / 0.08, f64::from(leg), repeat]);
            (i, position) = (i + 1, position + STEP_S * velocity);
        }
    }
    let run = RunTable::new(meta(Kind::Friction), trace).unwrap();
    let found = diagnose(&run, &ModelSpec::baseline(&run).unwrap(), &Options::default()).unwrap();
    assert_eq!((found.verdict, found.suggestions.len()), (Verdict::Adequate, 0), "{}", found.summary);
    assert!(found.fit.validation_rms > found.noise_floor.ci95.unwrap()[1], "{:?}", found.noise_floor);
    assert!(found.summary.contains("The difference is not repeatable"), "{}", found.summary);
}
