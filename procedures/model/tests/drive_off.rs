//! Rows without a reading of the torque, while another drive turns the joint, say nothing about its friction.

mod common;

use common::tables::{friction_in_steps, scatter};
use jointbench_instrument::RunTable;
use jointbench_model::preprocess::prepare;
use jointbench_model::{ModelSpec, Options, diagnose};

const OFF: std::ops::Range<usize> = 14..23;
const ROWS: usize = 150;

/// Friction with a quadratic drag; in the legs `OFF` the current is zero.
fn run() -> RunTable {
    friction_in_steps(&[2.0, 5.0, 9.0, 14.0, 20.0], 4, ROWS, |now| match OFF.contains(&now.leg) {
        true => 0.0,
        false => {
            let drag = 4e-4 * now.velocity + 2e-4 * now.velocity * now.velocity.abs();
            0.08 * now.velocity.signum() + drag + 1e-3 * scatter(now.row, 1)
        }
    })
}

#[test]
fn a_diagnosis_leaves_them_out() {
    let run = run();
    let spec = ModelSpec::new(run.kind(), ["coulomb", "viscous"]).unwrap();
    let diagnosis = diagnose(&run, &spec, &Options::default()).unwrap();
    let named: Vec<&str> = diagnosis.suggestions.iter().map(|s| s.effect.as_str()).collect();
    assert_eq!(named, ["viscous_quadratic"], "{}", diagnosis.summary);
    assert!(diagnosis.data_problems.is_empty(), "{:?}", diagnosis.data_problems);
    let notes = &diagnosis.fit.notes;
    let is_note =
        |note: &String| note.contains("stays at 0.00 A from 8.400 s") && note.ends_with("these rows are excluded");
    assert!(notes.iter().any(is_note), "{notes:?}");
}

#[test]
fn steady_states_count_the_rows_of_the_run() {
    let states = prepare(&run(), &Options::default()).unwrap().steady_states();
    let legs: Vec<usize> = states.iter().map(|(_, rows)| rows.start / ROWS).collect();
    let expected: Vec<usize> = (0..40).filter(|leg| !OFF.contains(leg)).collect();
    assert_eq!(legs, expected);
    assert!(states.iter().all(|(segment, rows)| *segment as usize == (rows.end - 1) / ROWS));
}
