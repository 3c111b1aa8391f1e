//! The software stop and its reset in a history.

use super::History;
use super::operation::{Kind, Operation};
use crate::client::Client;
use crate::client::Outcome::Answered;
use crate::lab::BENCH;
use crate::outcome::Outcome;
use jiff::Timestamp;
use serde_json::Value;
use std::collections::BTreeMap;

/// Client and server use the same clock, and times have a resolution of one microsecond.
const CLOSE_S: f64 = 0.001;
/// A reset without an answer may be executed this long after it was sent, because it waits for a locked database.
const LINGERS_S: f64 = 30.0;

pub(super) fn check(client: &Client, history: &History, outcome: &mut Outcome) {
    let record = client.get(&format!("/bench/{BENCH}/safety"));
    let entries = record.as_array().map(Vec::as_slice).unwrap_or_default();
    check_presses(entries, history, outcome);
    check_resets(entries, history, outcome);
    check_blocked(history, outcome);
}

/// The stop was acknowledged before it was stored, and then both processes that knew it were killed.
fn died_with_its_witnesses(stop: &Operation, history: &History) -> bool {
    let stored = stop.acknowledged().is_some_and(|bench| bench["blocked"]["stored"] == true);
    !stored && history.both_killed_s.iter().any(|killed_s| *killed_s > stop.sent_s)
}

fn check_presses(entries: &[Value], history: &History, outcome: &mut Outcome) {
    let mut possible: BTreeMap<&str, usize> = BTreeMap::new();
    let pressed_by = |by: &str| {
        let of = move |entry: &&Value| entry["blocked"] == true && entry["stopped"] == true && entry["by"] == by;
        entries.iter().filter(of).filter_map(|entry| unix_s(&entry["at"])).collect::<Vec<f64>>()
    };
    for stop in history.operations.iter().filter(|one| one.kind == Kind::Stop) {
        *possible.entry(&stop.client).or_default() += usize::from(stop.possible());
        let meanwhile = stop.sent_s - CLOSE_S..stop.ended_s + CLOSE_S;
        let is_there = pressed_by(&stop.client).iter().any(|at_s| meanwhile.contains(at_s));
        if stop.acknowledged().is_some() && !is_there && !died_with_its_witnesses(stop, history) {
            outcome.lost(format!("the press of {} at {:.3}", stop.client, stop.sent_s));
        }
    }
    for (by, possible) in possible {
        let found = pressed_by(by).len();
        if found > possible {
            let stops = history.operations.iter().filter(|one| one.kind == Kind::Stop && one.client == by);
            let sent: Vec<_> = stops.map(|stop| (stop.sent_s, stop.ended_s, &stop.outcome)).collect();
            outcome.doubled(format!(
                "{found} presses of {by}, who pressed {possible} times: recorded at {:?}, sent {sent:?}",
                pressed_by(by)
            ));
        }
    }
}

fn check_resets(entries: &[Value], history: &History, outcome: &mut Outcome) {
    for one in &history.operations {
        let Kind::Acknowledge { reason } = &one.kind else { continue };
        let found = entries.iter().filter(|entry| entry["blocked"] == false && entry["reason"] == **reason).count();
        match found {
            0 if one.acknowledged().is_some() => outcome.lost(format!("the reset {reason}")),
            0 => {}
            // Refused but recorded: the reset applies to the earlier stop, and a later stop remains active.
            1 if one.possible() || matches!(one.outcome, Answered { status: 409, .. }) => {}
            1 => outcome.half_done(format!("the reset {reason} is recorded, and was refused: {:?}", one.outcome)),
            more => outcome.doubled(format!("the reset {reason} is recorded {more} times")),
        }
    }
}

/// No run is accepted between an acknowledged stop and the next reset.
fn check_blocked(history: &History, outcome: &mut Outcome) {
    let all = &history.operations;
    let resets = || all.iter().filter(|one| matches!(one.kind, Kind::Acknowledge { .. }) && one.possible());
    for start in all.iter().filter(|one| one.kind == Kind::Start && one.acknowledged().is_some()) {
        let before =
            |one: &&Operation| one.kind == Kind::Stop && one.acknowledged().is_some() && one.ended_s < start.sent_s;
        for stop in all.iter().filter(before) {
            let lifts = |reset: &Operation| {
                let until_s = match reset.acknowledged() {
                    Some(_) => reset.ended_s,
                    None => reset.sent_s + LINGERS_S,
                };
                until_s > stop.sent_s && reset.sent_s < start.ended_s
            };
            if !resets().any(lifts) && !died_with_its_witnesses(stop, history) {
                outcome.lost(format!(
                    "the stop of {} at {:.3}: {} started a run at {:.3}, and nobody reset the bench",
                    stop.client, stop.sent_s, start.client, start.sent_s
                ));
            }
        }
    }
}

fn unix_s(at: &Value) -> Option<f64> {
    let at: Timestamp = at.as_str()?.parse().ok()?;
    Some(at.as_duration().as_secs_f64())
}
