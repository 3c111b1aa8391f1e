//! Procedures of the catalogue, carried out.

use crate::fakes::{Fakes, World};
use crate::ledger::{Done, play};
use jointbench_procedure::*;
use serde_json::json;

fn carried_out(id: &str, parameters: serde_json::Value, heat: fn(&mut World)) -> (Plan, Done) {
    let (fakes, mut bench) = Fakes::new(move |_, world| {
        heat(world);
        Ok(())
    });
    let plan = procedure(id).unwrap().plan(parameters.as_object().unwrap(), &BenchFacts::of(&bench)).unwrap();
    let done = play(&fakes, &mut bench, &plan, |_| {});
    (plan, done)
}

/// A joint that warms up by 20 °C with a time constant of a minute.
fn warming(world: &mut World) {
    world.temperature_c = 45.0 - 20.0 * (-(world.now_s - 100.0) / 60.0).exp();
}

#[test]
fn a_warm_up_ends_when_the_joint_is_steady() {
    let (plan, done) = carried_out("warm_up", json!({}), warming);
    done.check_safe(RunState::Completed);
    // 20 °C/min · exp(−t/60 s) falls below the bound of 0.3 °C/min at 252 s.
    assert!((252.0..300.0).contains(&done.end.duration_s), "{} of {} s", done.end.duration_s, plan.duration_s());
    assert!(done.ledger.notes().iter().any(|note| note.starts_with("warm:")), "{:?}", done.ledger.notes());
}

#[test]
fn a_warm_up_that_was_too_short_says_so() {
    let (_, done) = carried_out("warm_up", json!({"longest_s": 100.0}), warming);
    done.check_safe(RunState::Completed);
    assert!(done.ledger.notes().iter().any(|note| note.starts_with("not yet steady")), "{:?}", done.ledger.notes());
}

#[test]
fn friction_runs_from_warm_up_to_the_last_leg() {
    let (plan, done) = carried_out("friction", json!({"warm_up_s": 60.0}), warming);
    done.check_safe(RunState::Completed).check_no_cogging();
    let table = done.ledger.table();
    assert!((table.len() as f64 / (plan.duration_s() * plan.rate_hz) - 1.0).abs() < 0.01, "{} rows", table.len());
    let loads: std::collections::BTreeSet<u64> =
        table.column("brake_torque_command_nm").unwrap().iter().map(|nm| (nm * 1e3).round() as u64).collect();
    assert!(loads.contains(&0) && loads.len() > 3);
    assert!(done.world.position_rad.abs() < 1.0, "ends {} rad from where it began", done.world.position_rad);
}
