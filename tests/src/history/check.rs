//! Check after a history: acknowledged data exists once, other data completely or not at all.

use super::operation::{Kind, Operation};
use super::{History, all_runs, safety};
use crate::client::{Client, Request};
use crate::deaths::check_rows;
use crate::lab::{BENCH, Lab};
use crate::outcome::Outcome;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};

pub(super) fn check(lab: &Lab, history: &History, outcome: &mut Outcome) {
    let client = lab.client();
    let runs = all_runs(&client);
    safety::check(&client, history, outcome);
    check_runs(lab, &runs, history, outcome);
    check_imports(&runs, history, outcome);
    check_tokens(&client, history, outcome);
    check_calibrations(&client, history, outcome);
    check_words(&client, history, outcome);
}

/// Compares the number of occurrences in the store with the expectation.
fn check_count(operation: &Operation, found: usize, what: &str, outcome: &mut Outcome) {
    let client = &operation.client;
    match found {
        0 if operation.acknowledged().is_some() => outcome.lost(format!("{what} of {client}")),
        0 => {}
        1 if operation.possible() => {}
        1 => outcome.half_done(format!("{what} of {client} is there, and was refused: {:?}", operation.outcome)),
        more => outcome.doubled(format!("{what} of {client}: {more} times")),
    }
}

fn check_runs(lab: &Lab, runs: &[Value], history: &History, outcome: &mut Outcome) {
    let over = ["completed", "stopped", "aborted", "failed", "interrupted"];
    let ids: BTreeSet<i64> = runs.iter().filter_map(|run| run["id"].as_i64()).collect();
    let mut possible: BTreeMap<&str, usize> = BTreeMap::new();
    for start in history.operations.iter().filter(|one| one.kind == Kind::Start) {
        *possible.entry(&start.client).or_default() += usize::from(start.possible());
        if let Some(id) = start.acknowledged().and_then(|run| run["id"].as_i64())
            && !ids.contains(&id)
        {
            outcome.lost(format!("run {id}, which {} has started", start.client));
        }
    }
    for run in runs.iter().filter(|run| run["bench"] == BENCH) {
        let Some(by) = run["by"].as_str().filter(|by| possible.contains_key(by)) else { continue };
        match possible.get_mut(by) {
            Some(0) | None => outcome.doubled(format!("run {}: {by} has not started so many", run["id"])),
            Some(left) => *left -= 1,
        }
        if !over.iter().any(|state| run["state"] == *state) {
            outcome.half_done(format!("run {} is {} for ever", run["id"], run["state"]));
        }
        check_rows(lab, run, outcome);
    }
}

fn check_imports(runs: &[Value], history: &History, outcome: &mut Outcome) {
    for one in &history.operations {
        let Kind::Import { name, rows } = &one.kind else { continue };
        let found: Vec<&Value> = runs.iter().filter(|run| run["bench"] == **name).collect();
        check_count(one, found.len(), "an import", outcome);
        if let Some(run) = found.first().filter(|run| run["rows"] != *rows || run["state"] != "completed") {
            outcome.half_done(format!("import {name} of {rows} rows is {run}"));
        }
    }
}

/// A token is listed if and only if it gives access; a revoked one does neither.
fn check_tokens(client: &Client, history: &History, outcome: &mut Outcome) {
    let listed = client.get("/tokens");
    let count = |name: &str| listed.as_array().map_or(0, |all| all.iter().filter(|one| one["name"] == name).count());
    let revoked = |wanted: &str| {
        let revokes = |one: &&Operation| matches!(&one.kind, Kind::Revoke { name, .. } if name == wanted);
        history.operations.iter().find(revokes)
    };
    for one in &history.operations {
        let Kind::MakeToken { name } = &one.kind else { continue };
        let there = count(name);
        let revoke = revoked(name);
        if revoke.is_none_or(|revoke| !revoke.possible()) {
            let revoked = revoke.map_or(String::new(), |revoke| format!(" (its revocation: {:?})", revoke.outcome));
            check_count(one, there, &format!("a token{revoked}"), outcome);
        } else if revoke.is_some_and(|revoke| revoke.acknowledged().is_some()) && there > 0 {
            outcome.lost(format!("the revocation of token {name}: it is listed"));
        }
        let Some(secret) = one.acknowledged().and_then(|made| made["secret"].as_str()) else { continue };
        let opens =
            Client { token: secret.into(), ..client.clone() }.send(&Request::get("/bench")).acknowledged().is_some();
        if opens != (there > 0) {
            outcome.half_done(format!("token {name} is listed {there} times, and it opens: {opens}"));
        }
    }
}

fn check_calibrations(client: &Client, history: &History, outcome: &mut Outcome) {
    let all = client.get(&format!("/bench/{BENCH}/calibrations"));
    let mut asked: BTreeMap<&str, (usize, usize)> = BTreeMap::new();
    for one in history.operations.iter().filter(|one| one.kind == Kind::Calibrate) {
        let (held, possible) = asked.entry(&one.client).or_default();
        *held += usize::from(one.acknowledged().is_some());
        *possible += usize::from(one.possible());
    }
    for (by, (held, possible)) in asked {
        let found = all.as_array().map_or(0, |all| all.iter().filter(|one| one["by"] == by).count());
        if found < held {
            outcome.lost(format!("{} of {held} calibrations of {by}", held - found));
        }
        if found > possible {
            outcome.doubled(format!("{found} calibrations of {by}, who asked for {possible}"));
        }
    }
}

/// Notes and tags, each on a run that only its client changes.
fn check_words(client: &Client, history: &History, outcome: &mut Outcome) {
    let mut tagged: BTreeMap<i64, Vec<&Operation>> = BTreeMap::new();
    for one in &history.operations {
        match &one.kind {
            Kind::Note { run, text } => {
                let notes = client.get(&format!("/runs/{run}/notes"));
                let found = notes.as_array().map_or(0, |all| all.iter().filter(|note| note["text"] == **text).count());
                check_count(one, found, "a note", outcome);
            }
            Kind::Tag { run, .. } => tagged.entry(*run).or_default().push(one),
            _ => {}
        }
    }
    for (run, operations) in tagged {
        let last = operations.iter().rposition(|one| one.acknowledged().is_some());
        // An unanswered request may have been executed at any later time.
        let unknown = operations.iter().filter(|one| one.possible() && one.acknowledged().is_none());
        let may_be: Vec<&str> =
            last.map(|last| operations[last]).iter().chain(unknown).filter_map(|one| tag(one)).collect();
        let tags = &client.get(&format!("/runs/{run}"))["tags"];
        let is = tags[0].as_str();
        if is.map_or(last.is_some(), |is| !may_be.contains(&is)) {
            outcome.lost(format!("a tag of run {run}: it is {tags}, and may be one of {may_be:?}"));
        }
    }
}

fn tag(operation: &Operation) -> Option<&str> {
    match &operation.kind {
        Kind::Tag { tag, .. } => Some(tag),
        _ => None,
    }
}
