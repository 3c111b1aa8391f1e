//! Procedures of the catalogue, run on the fakes.

use crate::fakes::{Fakes, World};
use crate::ledger::{FinishedRun, middles_s, play, play_with};
use jointbench_procedure::plan::Phase;
use jointbench_procedure::*;
use serde_json::json;
use std::sync::mpsc::channel;

fn carried_out(id: &str, parameters: serde_json::Value, heat: fn(&mut World)) -> (Plan, FinishedRun) {
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
    world.temperature_c = Some(45.0 - 20.0 * (-(world.now_s - 100.0) / 60.0).exp());
}

#[test]
fn a_warm_up_ends_when_the_joint_is_steady() {
    let (plan, done) = carried_out("warm_up", json!({}), warming);
    done.check_safe(RunState::Completed);
    // 20 °C/min · exp(−t/60 s) falls below the bound of 0.3 °C/min at 252 s.
    assert!((252.0..300.0).contains(&done.end.duration_s), "{} of {} s", done.end.duration_s, plan.duration_s());
    assert!(
        done.ledger.notes().iter().any(|note| note.starts_with("Steady state reached: ")),
        "{:?}",
        done.ledger.notes()
    );
}

#[test]
fn a_warm_up_that_was_too_short_is_reported() {
    let (_, done) = carried_out("warm_up", json!({"longest_s": 100.0}), warming);
    done.check_safe(RunState::Completed);
    assert!(done.ledger.notes().iter().any(|note| note.starts_with("not warmed up: ")), "{:?}", done.ledger.notes());
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

/// Friction with a pause in the middle of a loaded step: the plan, that step, and the result.
fn paused_under_load(pause_s: f64) -> (Plan, usize, FinishedRun) {
    let (sender, controls) = channel();
    let held = sender.clone();
    let mut due: Vec<(f64, Control)> = Vec::new();
    let (_, bench) = Fakes::quiet();
    let given = json!({"warm_up_s": 30.0, "load_levels": 2, "repeats": 2});
    let plan = procedure("friction").unwrap().plan(given.as_object().unwrap(), &BenchFacts::of(&bench)).unwrap();
    let loaded = plan.steps.iter().position(|step| step.brake.at(0.0) > 0.1).unwrap();
    // All of the warm-up but the first three cycles, which are steady, is skipped.
    let skipped = plan.steps.iter().filter(|step| step.phase == Phase::WarmUp).skip(12);
    let at_s = middles_s(&plan)[loaded] - skipped.map(|step| step.duration_s()).sum::<f64>();
    due.extend([(at_s + pause_s, Control::Resume), (at_s, Control::Pause)]);
    let (fakes, mut bench) = Fakes::new(move |_, world| {
        while let Some((_, control)) = due.pop_if(|(at_s, _)| world.now_s >= 100.0 + *at_s) {
            // A run that has ended ignores controls.
            let _ = sender.send(control.into());
        }
        Ok(())
    });
    let done = play_with(&fakes, &mut bench, &plan, &controls, |_| {});
    drop(held);
    done.check_safe(RunState::Completed).check_no_cogging();
    (plan, loaded, done)
}

#[test]
fn a_joint_that_rested_for_long_is_warmed_up_again() {
    let warmed = |done: &FinishedRun| done.ledger.notes().iter().any(|note| note.ends_with("Warm-up is repeated."));
    let (plan, loaded, done) = paused_under_load(100.0);
    assert!(warmed(&done), "{:?}", done.ledger.notes());
    // None of it is kept: the table has the planned steps, the interrupted one twice.
    let table = done.ledger.table();
    let mut segments = table.column("segment").unwrap().to_vec();
    segments.dedup();
    assert_eq!(segments.last(), plan.steps.last().map(|step| f64::from(step.segment)).as_ref());
    let again = plan.steps.len() as f64;
    assert_eq!(segments.iter().filter(|segment| **segment == again).count(), 1);
    assert!(segments.contains(&f64::from(plan.steps[loaded].segment)));
    // The step begins under its previous load, approached from zero.
    let first = table.column("segment").unwrap().iter().position(|segment| *segment == again).unwrap();
    let nm = table.column("brake_torque_command_nm").unwrap()[first];
    assert!((nm / 13.0 * 0.6 - plan.steps[loaded].brake.at(0.0)).abs() < 1e-3, "{nm} Nm");

    let (_, _, done) = paused_under_load(20.0);
    assert!(!warmed(&done), "{:?}", done.ledger.notes());
}
