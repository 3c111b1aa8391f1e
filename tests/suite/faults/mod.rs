//! The short fault suite: the scenarios of `cargo run -p jointbench-tests --bin faults` with fixed seeds. The time
//! limits are for a busy machine.

use jointbench_tests::lab::{BENCH, Lab};
use jointbench_tests::outcome::{Outcome, table};
use jointbench_tests::trouble::Trouble;
use jointbench_tests::{deaths, history, presses, stops};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rustix::process::{Signal, kill_process};
use serde_json::Value;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

const SEED: u64 = 33;
const PRESSES: usize = 5;
const HANG_UPS: usize = 15;
const OPERATIONS: usize = 200;
/// On a busy machine.
const SLOWEST_STOP: Duration = Duration::from_secs(5);

/// Runs one scenario at a time: each needs the whole machine.
fn alone() -> MutexGuard<'static, ()> {
    static ALONE: Mutex<()> = Mutex::new(());
    ALONE.lock().unwrap_or_else(PoisonError::into_inner)
}

fn say(text: &str) {
    println!("{text}");
}

fn random() -> ChaCha8Rng {
    ChaCha8Rng::seed_from_u64(SEED)
}

fn check(outcomes: &[Outcome]) {
    let report = table(outcomes);
    println!("{report}");
    assert!(outcomes.iter().all(Outcome::holds), "{report}");
}

fn check_stops(trouble: Trouble) {
    let _alone = alone();
    let Some(outcome) = stops::stops(trouble, PRESSES, &mut random(), &say) else { return };
    assert_eq!(outcome.faults, PRESSES);
    let slowest = outcome.slowest_stop.expect("presses were measured");
    assert!(slowest < SLOWEST_STOP, "{}: the slowest stop took {slowest:?}", outcome.name);
    check(&[outcome]);
}

#[test]
fn the_stop_works_when_all_is_well() {
    check_stops(Trouble::Quiet);
}

#[test]
fn the_stop_works_while_another_program_holds_the_database() {
    check_stops(Trouble::DatabaseHeld);
}

#[test]
fn the_stop_works_on_a_slow_disk() {
    check_stops(Trouble::SlowSync);
}

#[test]
fn the_stop_works_on_a_full_disk() {
    check_stops(Trouble::FullDisk);
}

#[test]
fn the_stop_works_while_models_are_fitted() {
    check_stops(Trouble::Fits);
}

#[test]
fn the_stop_works_with_stalled_connections() {
    check_stops(Trouble::StalledConnections);
}

#[test]
fn a_press_is_never_lost() {
    let _alone = alone();
    check(&[presses::hang_ups(HANG_UPS, &mut random())]);
}

#[test]
fn after_any_crash_the_bench_is_secured_and_no_acknowledged_data_is_lost() {
    let _alone = alone();
    check(&deaths::deaths(1, &say));
}

#[test]
fn a_history_of_concurrent_clients_holds() {
    let _alone = alone();
    check(&[history::histories(OPERATIONS, SEED, &say)]);
}

/// A worker under load begins a run later than the daemon acknowledges it. Stopped, it does not begin at all.
#[test]
fn an_acknowledged_run_has_its_bench_before_the_worker_begins_it() {
    let _alone = alone();
    let mut lab = Lab::new(None);
    lab.start();
    for end in [Signal::CONT, Signal::KILL] {
        lab.reset();
        let worker = lab.worker().expect("a worker");
        kill_process(worker, Signal::STOP).expect("the worker runs");
        let run = lab.start_run("friction");
        let bench = lab.bench();
        lab.client().post(&format!("/bench/{BENCH}/stop"), &Value::Null);
        kill_process(worker, end).expect("the worker exists");
        assert_eq!((&bench["state"], &bench["run"]), (&"running".into(), &run.into()), "{bench}");
        lab.wait(Duration::from_secs(60), "the run to end", || !lab.run(run)["safe"].is_null());
        let ended = lab.run(run);
        assert!(ended["rows"] == 0 && ended["state"] != "completed", "{ended}");
        lab.wait(Duration::from_secs(60), "the bench", || lab.bench()["state"] == "stopped");
        assert!(lab.bench()["run"].is_null(), "{}", lab.bench());
    }
    lab.reset();
}
