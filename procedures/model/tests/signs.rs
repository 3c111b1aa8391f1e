//! A column with the wrong sign fits as well as the right one. The resulting parameters are impossible, which is
//! reported first.

mod common;

use common::bench::Staircase;
use common::tables::{meta, scatter};
use jointbench_instrument::{Channel, Kind, RunTable, Trace};
use jointbench_model::{Diagnosis, ModelSpec, Options, diagnose};

/// A brake that saturates, up and down three times, with its torque times `sign`.
fn brake(sign: f64) -> Diagnosis {
    let names = ["time_s", "brake_current_a", "brake_torque_nm", "velocity_rad_s", "position_rad", "segment", "repeat"];
    let mut trace = Trace::new(names.map(Channel::new).into());
    for row in 0..3600 {
        let (leg, time) = (row / 300, 0.02 * row as f64);
        let way = (row % 300) as f64 / 300.0;
        let current = if leg % 2 == 0 { way } else { 1.0 - way };
        let torque = 0.1 + 9.0 * (current / 0.6).tanh() + 0.03 * scatter(row, 1);
        trace.push_row(&[time, current, sign * torque, 5.0, 5.0 * time, leg as f64, (leg / 4) as f64]);
    }
    let run = RunTable::new(meta(Kind::Brake), trace).unwrap();
    diagnose(&run, &ModelSpec::baseline(&run).unwrap(), &Options::default()).unwrap()
}

#[test]
fn an_impossible_size_is_reported_before_the_named_effect() {
    let right = brake(1.0);
    assert_eq!(right.suggestions.first().map(|s| s.effect.as_str()), Some("saturation"), "{}", right.summary);
    assert_eq!(right.undecided, None);
    let turned = brake(-1.0);
    assert!(turned.summary.starts_with("Implausible: "), "{}", turned.summary);
    assert!(turned.undecided.is_some_and(|why| why.contains("is outside its physical range")));
}

#[test]
fn nothing_is_named_of_columns_that_cannot_be_right() {
    let bench = Staircase { noise_nm: 2e-3, scatter_nm: 2e-4, seed: 1 };
    let run = bench.run(|m| m.velocity.signum() * (0.03 + 4e-4 * m.load * m.load) + 2e-4 * m.velocity);
    let named = |sign: f64| {
        let channels = run.trace().channels().to_vec();
        let columns = channels.iter().map(|c| {
            let scale = if c.name == "motor_current_a" { sign } else { 1.0 };
            run.column(&c.name).unwrap().iter().map(|v| scale * v).collect()
        });
        let trace = Trace::from_columns(channels.clone(), columns.collect());
        let run = RunTable::new(run.meta().clone(), trace).unwrap();
        let spec = ModelSpec::parse(Kind::Friction, "coulomb,viscous").unwrap();
        diagnose(&run, &spec, &Options::default()).unwrap()
    };
    assert!(!named(1.0).suggestions.is_empty());
    let turned = named(-1.0);
    assert_eq!(turned.suggestions.len(), 0, "{}", turned.summary);
    assert!(turned.summary.contains("no effect is suggested until then"), "{}", turned.summary);
    assert_eq!(turned.undecided.as_deref(), Some("the recording has the data problem above"));
}

/// A joint that a sine moves in both directions; `recorded`: the current in the file from the current in the motor.
fn stroke(recorded: fn(f64) -> f64) -> Diagnosis {
    let names = ["time_s", "motor_position_rad", "motor_current_a"];
    let mut trace = Trace::new(names.map(Channel::new).into());
    for row in 0..8000 {
        let time = 0.005 * row as f64;
        let (position, velocity) = (30.0 * (0.5 * time).sin(), 15.0 * (0.5 * time).cos());
        let current = 0.3 * (velocity / 0.5).tanh() + 0.02 * velocity + 2e-3 * scatter(row, 1);
        trace.push_row(&[time, position, recorded(current)]);
    }
    let run = RunTable::new(meta(Kind::Friction), trace).unwrap();
    diagnose(&run, &ModelSpec::parse(Kind::Friction, "inertia,coulomb,viscous").unwrap(), &Options::default()).unwrap()
}

#[test]
fn a_magnitude_of_the_current_is_a_data_problem() {
    let summary = stroke(f64::abs).summary;
    assert!(summary.contains("as a magnitude") && summary.contains("No effect was tested."), "{summary}");
    assert!(!summary.contains("Rejected"), "{summary}");
    let right = stroke(|current| current).summary;
    assert!(!right.contains("magnitude"), "{right}");
}
