//! A bench with a thermometer: its readings are in every run.

use crate::fakes::{Call, Fakes, World};
use crate::ledger::{FinishedRun, loaded_plan, play};
use jointbench_instrument::FaultKind;
use jointbench_procedure::*;

fn run_with_thermometer(script: impl FnMut(Call, &mut World) -> Result<(), FaultKind> + Send + 'static) -> FinishedRun {
    let (fakes, mut bench) = Fakes::new(script);
    fakes.connect_thermometer(&mut bench);
    play(&fakes, &mut bench, &loaded_plan(), |_| {})
}

#[test]
fn every_channel_is_a_column_next_to_the_joints_own_temperature() {
    let done = run_with_thermometer(|_, world| {
        world.warmth_c = [world.now_s - 100.0, 20.0];
        Ok(())
    });
    done.check_safe(RunState::Completed);
    let table = done.ledger.table();
    assert!(table.column("temperature_c").unwrap().iter().all(|c| *c == 25.0));
    assert!(table.column("thermometer_2_c").unwrap().iter().all(|c| *c == 20.0));
    let behind = |(felt_c, at_s): (&f64, &f64)| (-1e-5..=2.01).contains(&(at_s - felt_c));
    let (felt_c, time_s) = (table.column("thermometer_1_c").unwrap(), table.column("time_s").unwrap());
    assert!(felt_c.iter().zip(time_s).all(behind), "never older than two seconds");
    // A stored row has the time of its reading; a table has it moved to the time of the row.
    for kept in done.ledger.kept.iter().filter(|kept| !kept.rows.is_empty()) {
        let [felt_c, time_s, skew_s] =
            ["thermometer_1_c", "time_s", "thermometer_skew_s"].map(|name| kept.rows.column(name).unwrap());
        assert!((0..kept.rows.len()).all(|i| (felt_c[i] - time_s[i] - skew_s[i]).abs() < 1e-5));
    }
    let exact = felt_c.iter().zip(time_s).filter(|(felt_c, at_s)| (*felt_c - *at_s).abs() < 1e-4).count();
    assert!(2 * exact > time_s.len(), "{exact} of {}", time_s.len());
    let identified =
        |event: &Event| matches!(&event.kind, EventKind::Identified { instrument, .. } if instrument == "thermometer");
    assert!(done.ledger.events().any(identified));
}

#[test]
fn the_first_channel_replaces_the_temperature_of_a_joint_without_one() {
    let done = run_with_thermometer(|_, world| {
        world.temperature_c = None;
        Ok(())
    });
    done.check_safe(RunState::Completed);
    let table = done.ledger.table();
    assert!(table.column("temperature_c").unwrap().iter().all(|c| *c == 30.0));
    assert!(table.column("thermometer_1_c").is_none() && table.column("thermometer_2_c").is_some());
    assert!(!done.ledger.notes().iter().any(|note| note.contains("not monitored")), "{:?}", done.ledger.notes());
}

#[test]
fn its_limit_holds_there_too() {
    let done = run_with_thermometer(|_, world| {
        world.temperature_c = None;
        world.warmth_c[0] = if world.now_s > 102.0 { 81.0 } else { 30.0 };
        Ok(())
    });
    done.check_safe(RunState::Failed);
    assert!(done.end.reason.unwrap().contains("temperature"));
}

#[test]
fn a_thermometer_that_is_lost_ends_the_run_safely() {
    let done = run_with_thermometer(|call, world| match call {
        Call::ReadWarmth if world.now_s > 102.0 => {
            Err(FaultKind::Silent { request: "holding registers".into(), deadline_ms: 50 })
        }
        _ => Ok(()),
    });
    done.check_safe(RunState::Failed).check_no_cogging();
    assert!(done.end.reason.unwrap().contains("thermometer"));
}
