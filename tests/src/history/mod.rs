//! Histories in the manner of Jepsen: simultaneous clients that disconnect at random, a nemesis that kills, stalls and
//! locks, and a checker that knows the acknowledged operations.

mod check;
mod clients;
mod nemesis;
mod operation;
mod safety;

use crate::client::Client;
use crate::lab::{BENCH, Lab};
use crate::outcome::Outcome;
use clients::Actor;
use nemesis::Nemesis;
use operation::Operation;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use serde_json::json;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

const CLIENTS: u64 = 6;
/// The safety record lists its newest hundred entries; a round creates fewer.
pub const OPERATIONS_OF_A_ROUND: usize = 200;
/// Time limit to store open data.
const SETTLES: Duration = Duration::from_secs(120);

/// Actions of clients and nemesis.
struct History {
    operations: Vec<Operation>,
    /// Unix times at which both server and worker were killed.
    both_killed_s: Vec<f64>,
    faults: usize,
}

/// Time limit after SIGTERM of a daemon whose bench is at rest.
const ENDS: Duration = Duration::from_secs(30);

/// Rounds of [`OPERATIONS_OF_A_ROUND`] on one store, with a check at the end of each round.
pub fn histories(operations: usize, seed: u64, say: &dyn Fn(&str)) -> Outcome {
    let mut lab = Lab::new(None);
    lab.start();
    let mut outcome = Outcome::new("history of concurrent clients");
    for round in 0..operations.div_ceil(OPERATIONS_OF_A_ROUND) as u64 {
        lab.reset();
        let actors = (0..CLIENTS).map(|number| Actor::new(&lab.client(), round, number, seed)).collect();
        let history = play(&mut lab, actors, seed.wrapping_add(round));
        settle(&mut lab, &mut outcome);
        outcome.faults += history.faults;
        outcome.acknowledged += history.operations.iter().filter(|one| one.acknowledged().is_some()).count();
        check::check(&lab, &history, &mut outcome);
        let (count, faults) = (history.operations.len(), history.faults);
        say(&format!("round {round}: {count} operations, {faults} faults, broken so far: {:?}", outcome.broken));
    }
    outcome
}

fn play(lab: &mut Lab, actors: Vec<Actor>, seed: u64) -> History {
    let left = AtomicUsize::new(OPERATIONS_OF_A_ROUND);
    let mut nemesis = Nemesis::new(ChaCha8Rng::seed_from_u64(seed));
    let operations = std::thread::scope(|scope| {
        let playing: Vec<_> = actors.into_iter().map(|actor| scope.spawn(|| actor.play(&left))).collect();
        while left.load(Ordering::Acquire) > 0 {
            nemesis.strike(lab);
        }
        playing.into_iter().flat_map(|actor| actor.join().expect("a client ends")).collect()
    });
    History { operations, both_killed_s: nemesis.both_killed_s, faults: nemesis.faults }
}

/// No fault is active: open operations complete, and the store is opened again.
fn settle(lab: &mut Lab, outcome: &mut Outcome) {
    lab.client().post(&format!("/bench/{BENCH}/stop"), &json!({}));
    let is_quiet = || {
        let bench = lab.bench();
        bench["run"].is_null() && bench["unstored"].is_null() && bench["blocked"]["stored"] == true
    };
    lab.wait(SETTLES, "everything to be stored", is_quiet);
    if lab.terminate(ENDS).is_none() {
        outcome.broken.push(format!("SIGTERM of a bench at rest does not end within {ENDS:?}\n{}", lab.tail()));
    }
    lab.start();
}

fn all_runs(client: &Client) -> Vec<serde_json::Value> {
    const PAGE: usize = 500;
    let mut all = Vec::new();
    loop {
        let page = client.get(&format!("/runs?limit={PAGE}&offset={}", all.len()));
        let runs = page["runs"].as_array().cloned().unwrap_or_default();
        let is_last = runs.len() < PAGE;
        all.extend(runs);
        if is_last {
            return all;
        }
    }
}
