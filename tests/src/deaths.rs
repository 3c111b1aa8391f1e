//! Kills of server, worker, or both during a run.

use crate::lab::Lab;
use crate::outcome::Outcome;
use crate::trouble::Held;
use crate::wire::{Wire, now_s};
use serde_json::{Value, json};
use std::time::{Duration, Instant};

/// A worker without a server ends its run as on request: the joint first stops.
const SECURES: Duration = Duration::from_secs(10);
/// Maximum interval between two commits of rows.
const COMMIT_EVERY_S: f64 = 2.0;
/// Time limit after SIGTERM while another program locks the database.
const ENDS: Duration = Duration::from_secs(20);

/// State of a run at the last request before the kill.
struct Before {
    id: i64,
    rows: i64,
    moved_s: Instant,
}

fn measure(lab: &Lab, wire: &mut Wire) -> Before {
    let id = lab.start_moving("friction", wire);
    let moved_s = Instant::now();
    let rows = |id| lab.run(id)["rows"].as_i64().unwrap_or_default();
    lab.wait(Duration::from_secs(60), "rows to be stored", || rows(id) > 500);
    Before { id, rows: rows(id), moved_s }
}

/// `kill -9` of the server during a run: the worker secures the bench, and no acknowledged data is lost.
pub fn server_dies(lab: &mut Lab, outcome: &mut Outcome) {
    let mut wire = lab.wire();
    let before = measure(lab, &mut wire);
    wire.look();
    let died_s = now_s();
    outcome.faults += 1;
    lab.kill_server();
    match disarmed(&mut wire, died_s) {
        Some(after) => outcome.broken.extend((after > SECURES).then(|| format!("secured only after {after:?}"))),
        None => outcome.lost("the worker does not secure the bench when the server is killed".into()),
    }
    lab.start();
    check_interrupted(lab, &before, outcome);
    lab.reset();
}

/// `kill -9` of the worker during a run: it is shown immediately, and another worker secures the bench.
pub fn worker_dies(lab: &mut Lab, outcome: &mut Outcome) {
    let mut wire = lab.wire();
    let before = measure(lab, &mut wire);
    outcome.faults += 1;
    lab.kill_worker();
    let died = Instant::now();
    lab.wait(Duration::from_secs(5), "the bench to be shown without a worker", || {
        let bench = lab.bench();
        bench["state"] != "running"
    });
    outcome.broken.extend((died.elapsed() > SHOWN).then(|| format!("shown only after {:?}", died.elapsed())));
    check_interrupted(lab, &before, outcome);
    lab.reset();
}

/// Limit for "immediately" on a busy machine.
const SHOWN: Duration = Duration::from_secs(2);

/// Both processes end: the next start secures the bench.
pub fn both_die(lab: &mut Lab, outcome: &mut Outcome) {
    let mut wire = lab.wire();
    let before = measure(lab, &mut wire);
    outcome.faults += 1;
    lab.kill_both();
    lab.start();
    check_interrupted(lab, &before, outcome);
    lab.reset();
}

/// Each new worker is killed immediately; the bench still recovers afterwards.
pub fn workers_die_in_a_row(lab: &mut Lab, times: usize, outcome: &mut Outcome) {
    for _ in 0..times {
        lab.wait(Duration::from_secs(30), "another worker", || lab.worker().is_some());
        outcome.faults += 1;
        lab.kill_worker();
    }
    lab.wait(Duration::from_secs(60), "the bench to be ready again", || {
        let bench = lab.bench();
        bench["state"] == "idle"
            && bench["instruments"].as_array().is_some_and(|all| all.iter().all(|one| one["ready"] == true))
    });
    lab.reset();
}

/// SIGTERM during a run with a locked database: the daemon ends in time, and no acknowledged data is lost.
pub fn terminated_while_held(lab: &mut Lab, outcome: &mut Outcome) {
    let mut wire = lab.wire();
    let before = measure(lab, &mut wire);
    let held = Held::hold(&lab.database());
    outcome.faults += 1;
    match lab.terminate(2 * ENDS) {
        Some(took) if took <= ENDS => {}
        Some(took) => outcome.broken.push(format!("SIGTERM with a held database took {took:?}")),
        None => outcome.broken.push(format!("SIGTERM with a held database did not end within {:?}", 2 * ENDS)),
    }
    drop(held);
    lab.start();
    check_interrupted(lab, &before, outcome);
    lab.reset();
}

fn disarmed(wire: &mut Wire, after_s: f64) -> Option<Duration> {
    let until = Instant::now() + 2 * SECURES;
    while Instant::now() < until {
        wire.look();
        if let Some(at_s) = wire.disarmed_after(after_s) {
            return Some(Duration::from_secs_f64(at_s - after_s));
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    None
}

/// The run has ended, the bench is safe, and acknowledged data exists once.
fn check_interrupted(lab: &Lab, before: &Before, outcome: &mut Outcome) {
    let id = before.id;
    let ran_s = before.moved_s.elapsed().as_secs_f64();
    lab.wait(Duration::from_secs(60), "the run's end to be stored", || {
        let run = lab.run(id);
        run["safe"].is_string() && run["not_stored"].is_null()
    });
    let run = lab.run(id);
    outcome.acknowledged += 1;
    if run["state"] != "interrupted" && run["state"] != "aborted" {
        outcome.half_done(format!("run {id} is {}", run["state"]));
    }
    if run["safe"] != "safe_verified" {
        outcome.half_done(format!("run {id} ended {}", run["safe"]));
    }
    let rows = run["rows"].as_i64().unwrap_or_default();
    if rows < before.rows {
        outcome.lost(format!("run {id} had {} rows, and has {rows}", before.rows));
    }
    let times = check_rows(lab, &run, outcome);
    if let Some(last_s) = times.last()
        && ran_s < *last_s - COMMIT_EVERY_S
    {
        outcome.doubled(format!("run {id} has rows up to {last_s} s, and lasted {ran_s:.1} s"));
    }
}

/// The rows of a run, each once and in order, with the reported number; its events without a gap.
pub fn check_rows(lab: &Lab, run: &Value, outcome: &mut Outcome) -> Vec<f64> {
    let (id, rows) = (&run["id"], run["rows"].as_u64().unwrap_or_default() as usize);
    if rows == 0 {
        return Vec::new();
    }
    let client = lab.client();
    let table = client.get(&format!("/runs/{id}/export?format=csv"));
    let lines = table.as_str().unwrap_or_default().lines().skip(1);
    let times: Vec<f64> = lines.filter_map(|row| row.split(',').next()?.parse().ok()).collect();
    if times.len() < rows {
        outcome.lost(format!("run {id} counts {rows} rows and exports {}", times.len()));
    }
    if times.len() > rows || times.windows(2).any(|pair| pair[0] >= pair[1]) {
        outcome.doubled(format!("run {id}: {} rows exported of {rows}, not each once and in order", times.len()));
    }
    let events = client.get(&format!("/runs/{id}/events"));
    let numbers: Vec<i64> =
        events.as_array().into_iter().flatten().filter_map(|event| event["sequence"].as_i64()).collect();
    if numbers.windows(2).any(|pair| pair[1] != pair[0] + 1) {
        outcome.lost(format!("the journal of run {id} has a gap: {numbers:?}"));
    }
    times
}

/// All kinds of death, `rounds` times.
pub fn deaths(rounds: usize, say: &dyn Fn(&str)) -> Vec<Outcome> {
    let mut lab = Lab::new(None);
    lab.start();
    type Death = fn(&mut Lab, &mut Outcome);
    let all: [(&str, Death); 5] = [
        ("kill -9 of the server during a run", server_dies),
        ("kill -9 of the worker during a run", worker_dies),
        ("kill -9 of both during a run", both_die),
        ("SIGTERM during a run with a locked database", terminated_while_held),
        ("a worker killed five times in a row", |lab, outcome| workers_die_in_a_row(lab, 5, outcome)),
    ];
    let make = |(name, death): (&str, Death)| {
        let mut outcome = Outcome::new(name);
        for _ in 0..rounds {
            death(&mut lab, &mut outcome);
        }
        say(&format!("{name}: done"));
        outcome
    };
    all.map(make).into()
}

/// Open runs without a worker, which a list of runs must not contain.
pub fn ghosts(lab: &Lab) -> Vec<Value> {
    let runs = lab.client().get("/runs?limit=500");
    let over = [json!("completed"), json!("stopped"), json!("aborted"), json!("failed"), json!("interrupted")];
    runs["runs"].as_array().into_iter().flatten().filter(|run| !over.contains(&run["state"])).cloned().collect()
}
