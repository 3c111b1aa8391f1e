//! A brake whose current changes in steps: during a change, its reading and the torque are delayed.

mod common;

use common::tables::meta;
use jointbench_instrument::{Channel, Kind, RunTable, Trace};
use jointbench_model::{ModelSpec, Options, Verdict, diagnose};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};

/// Sweeps of 20 steps up and 20 down, in alternating direction. The torque follows the current, which follows its
/// command. Both are read, the current at every tenth sample. All sweeps have the same segment numbers.
fn staircase() -> RunTable {
    const STEP_S: f64 = 0.01;
    let names = "time_s brake_current_a brake_torque_nm velocity_rad_s segment repeat";
    let mut trace = Trace::new(names.split(' ').map(Channel::new).collect());
    let (mut current, mut torque, mut read) = (0.0, 0.0, 0.0);
    let mut random = ChaCha8Rng::seed_from_u64(8);
    let noise = Normal::new(0.0, 1.0).unwrap();
    for i in 0..4 * 40 * 80 {
        let (sweep, step) = (i / 3200, i % 3200 / 80);
        let command = 0.03 * (if step < 20 { step + 1 } else { 40 - step }) as f64;
        current += 0.12 * (command - current);
        torque += 0.3 * (20.0 * current - torque);
        if i % 10 == 0 {
            read = current + 1e-4 * noise.sample(&mut random);
        }
        let velocity = if sweep % 2 == 0 { 0.8 } else { -0.8 };
        let measured = 0.05 + torque + 0.01 * noise.sample(&mut random);
        trace.push_row(&[STEP_S * i as f64, read, measured, velocity, sweep as f64, 1.0]);
    }
    RunTable::new(meta(Kind::Brake), trace).unwrap()
}

#[test]
fn steps_of_the_current_are_no_hysteresis() {
    let run = staircase();
    let found = diagnose(&run, &ModelSpec::baseline(&run).unwrap(), &Options::default()).unwrap();
    assert_eq!((found.verdict, &found.undecided), (Verdict::Adequate, &None), "{}", found.summary);
    assert!(found.noise_floor.source.contains("sections with the same profile"), "{}", found.noise_floor.source);
    assert!(found.fit.validation_rms < 0.01, "{}", found.summary);
    let drag = found.fit.parameters.iter().find(|p| p.effect == "drag").unwrap();
    assert!((drag.value - 0.05).abs() < 5e-3, "{drag:?}");
}
