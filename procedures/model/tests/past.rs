//! A run that starts with a loading history of an earlier one, which is no structure.

mod common;

use common::tables::{meta, scatter, stiffness};
use jointbench_instrument::{Channel, Kind, RunTable, Trace};
use jointbench_model::{ModelSpec, Options, Verdict, discover, fit};

/// Currents at which dry contacts slip, enough for a smooth curve [A].
const SLIPS: [f64; 12] = [0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.5, 0.55, 0.6];

/// States of dry contacts after a path from rest to `past` and back to zero.
fn after(past: f64, slips: f64) -> f64 {
    (past.clamp(-slips, slips) - past).clamp(-slips, slips)
}

/// Three times up to 1 A and down in steps.
fn brake(past: f64) -> RunTable {
    let names = ["time_s", "brake_current_a", "brake_torque_nm", "segment", "repeat"];
    let mut trace = Trace::new(names.map(Channel::new).to_vec());
    let mut states = SLIPS.map(|slips| after(past, slips));
    let mut before = 0.0;
    for step in 0..63 {
        let level = f64::from(10 - (step % 21 - 10i32).abs()) / 10.0;
        for k in 0..100 {
            let i = (100 * step + k) as usize;
            let current: f64 = before + (level - before) * 0.2;
            let pairs = states.iter_mut().zip(SLIPS);
            pairs.for_each(|(state, slips)| *state = (*state + current - before).clamp(-slips, slips));
            before = current;
            let held: f64 = states.iter().zip(SLIPS).map(|(state, slips)| 0.0125 * state / slips).sum();
            let torque = 0.03 + 6.0 * current - held + 0.03 * scatter(i, 1);
            trace.push_row(&[0.01 * i as f64, current, torque, f64::from(step), f64::from(step / 21)]);
        }
    }
    RunTable::new(meta(Kind::Brake), trace).unwrap()
}

/// Two swings of the torque to both sides.
fn joint(past: f64) -> RunTable {
    const SLIPS_NM: f64 = 6.0;
    let mut trace = stiffness();
    let (mut state, mut before) = (after(past, SLIPS_NM), 0.0);
    for i in 0..4000 {
        let turn = i as f64 / 2000.0;
        let torque = 30.0 * (std::f64::consts::TAU * turn).sin();
        state = (state + torque - before).clamp(-SLIPS_NM, SLIPS_NM);
        before = torque;
        let twist = 1e-3 + 1.1e-4 * torque + 3e-4 * state / SLIPS_NM + 7e-5 * scatter(i, 1);
        let leg = (2.0 * turn + 0.5).floor();
        let row = [0.01 * i as f64, 50.0 * (0.2 + twist), 0.2, 0.0, torque + 0.02 * scatter(i, 2), leg, turn.floor()];
        trace.push_row(&row);
    }
    RunTable::new(meta(Kind::Stiffness), trace).unwrap()
}

fn check(run: &RunTable, effect: &str, is_reported: bool) {
    let spec = ModelSpec::baseline(run).unwrap();
    let whole = discover(run, &spec, &Options::default(), 4).unwrap();
    let added: Vec<_> = whole.model.iter().filter(|e| !spec.contains(e)).collect();
    assert_eq!(added, [effect], "{}", whole.summary);
    assert_eq!(whole.verdict, Verdict::Adequate, "{}", whole.summary);
    let notes = fit(run, &spec, &Options::default()).unwrap().notes;
    assert_eq!(notes.iter().any(|note| note.contains("remembered")), is_reported, "{notes:?}");
}

#[test]
fn a_brake_that_was_loaded_before_shows_its_hysteresis_alone() {
    for (past, is_reported) in [(0.0, false), (0.45, true), (1.0, true)] {
        check(&brake(past), "hysteresis", is_reported);
    }
}

#[test]
fn a_joint_that_was_loaded_before_shows_its_hysteresis_alone() {
    for (past, is_reported) in [(0.0, false), (-30.0, true), (30.0, true)] {
        check(&joint(past), "torsional_hysteresis", is_reported);
    }
}
