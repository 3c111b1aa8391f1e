//! Clients: each executes operations in sequence, with its own token and run.

use super::operation::{Kind, Operation};
use crate::client::{Client, Outcome, Request};
use crate::lab::BENCH;
use crate::wire::now_s;
use rand::seq::IndexedRandom;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::json;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

/// Percentage of clients that disconnect before the answer, and percentage of these during their request.
const HANG_UP_PERCENT: u32 = 20;
const BROKEN_OFF_PERCENT: u32 = 30;
/// Pause between two operations.
const PAUSE_MS: std::ops::Range<u64> = 0..600;
/// Waiting time before the next attempt if the server does not listen.
const AWAY: Duration = Duration::from_millis(50);
/// Rows of the table that each client annotates.
const OWN_ROWS: usize = 50;

pub struct Actor {
    name: String,
    client: Client,
    random: ChaCha8Rng,
    own_run: i64,
    started: Option<i64>,
    /// Number, name and secret of the tokens that this client has created.
    tokens: Vec<(i64, String, String)>,
    count: usize,
}

impl Actor {
    /// Creates a token and a run while no fault is active.
    pub fn new(operator: &Client, round: u64, number: u64, seed: u64) -> Self {
        let name = format!("client {round}-{number}");
        let made = operator.post("/tokens", &json!({ "name": name, "access": "full" }));
        let secret = made.acknowledged().and_then(|made| made["secret"].as_str());
        let token = secret.unwrap_or_else(|| panic!("no token for {name}: {made:?}")).to_owned();
        let client = Client { address: operator.address, token };
        let own = client.send(&Request::import(&format!("own-{round}-{number}"), OWN_ROWS));
        let own_run = own.acknowledged().and_then(|run| run["id"].as_i64());
        let own_run = own_run.unwrap_or_else(|| panic!("no run for {name}: {own:?}"));
        let random = ChaCha8Rng::seed_from_u64(seed ^ (round << 32) ^ (number << 16));
        Self { name, client, random, own_run, started: None, tokens: Vec::new(), count: 0 }
    }

    /// Executes operations until none is left.
    pub fn play(mut self, left: &AtomicUsize) -> Vec<Operation> {
        let mut done = Vec::new();
        while left.load(Ordering::Acquire) > 0 {
            let (kind, request) = self.choose();
            let sent_s = now_s();
            let outcome = self.send(&request);
            if outcome == Outcome::NotSent && !matches!(kind, Kind::Revoke { .. }) {
                std::thread::sleep(AWAY);
            } else {
                // Another client may have executed the last one in the meantime.
                let _ = left.fetch_update(Ordering::AcqRel, Ordering::Acquire, |left| left.checked_sub(1));
            }
            self.learn(&kind, &outcome);
            done.push(Operation { client: self.name.clone(), kind, sent_s, ended_s: now_s(), outcome });
            std::thread::sleep(Duration::from_millis(self.random.random_range(PAUSE_MS)));
        }
        done
    }

    fn send(&mut self, request: &Request) -> Outcome {
        if !self.random.random_ratio(HANG_UP_PERCENT, 100) {
            return self.client.send(request);
        }
        let breaks_off = self.random.random_ratio(BROKEN_OFF_PERCENT, 100);
        let share = if breaks_off { self.random.random_range(0.1..0.99) } else { 1.0 };
        let after = Duration::from_micros(self.random.random_range(0..5000));
        if self.client.hang_up(request, share, after) { Outcome::Unknown } else { Outcome::NotSent }
    }

    fn choose(&mut self) -> (Kind, Request) {
        self.count += 1;
        let word = format!("{}-{}", self.name.replace(' ', "-"), self.count);
        match self.random.random_range(0..100) {
            0..18 => {
                let body = json!({ "bench": BENCH, "procedure": "friction", "parameters": {} });
                (Kind::Start, Request::post("/runs", &body))
            }
            18..28 => (Kind::Stop, Request::bare("POST", format!("/bench/{BENCH}/stop"))),
            28..44 => {
                let request = Request::post(format!("/bench/{BENCH}/acknowledge"), &json!({ "reason": word }));
                (Kind::Acknowledge { reason: word }, request)
            }
            44..54 => {
                let verb = ["pause", "resume", "stop", "abort"].choose(&mut self.random).expect("four");
                let run = self.started.unwrap_or(self.own_run);
                (Kind::Control, Request::post(format!("/runs/{run}/{verb}"), &json!({})))
            }
            54..62 => {
                let request = Request::post("/tokens", &json!({ "name": word, "access": "read" }));
                (Kind::MakeToken { name: word }, request)
            }
            62..70 => self.revoke(word),
            70..76 => {
                let body = json!({ "procedure": "friction", "run": null });
                (Kind::Calibrate, Request::post(format!("/bench/{BENCH}/calibrations"), &body))
            }
            76..86 => self.note(word),
            86..93 => {
                let request = Request::json("PUT", format!("/runs/{}/tags", self.own_run), &json!({ "tags": [word] }));
                (Kind::Tag { run: self.own_run, tag: word }, request)
            }
            _ => {
                let rows = self.random.random_range(10..2000);
                let request = Request::import(&word, rows);
                (Kind::Import { name: word, rows }, request)
            }
        }
    }

    fn revoke(&mut self, word: String) -> (Kind, Request) {
        match self.tokens.pop() {
            Some((id, name, secret)) => {
                (Kind::Revoke { name, secret }, Request::bare("DELETE", format!("/tokens/{id}")))
            }
            None => self.note(word),
        }
    }

    fn note(&self, text: String) -> (Kind, Request) {
        let request = Request::post(format!("/runs/{}/notes", self.own_run), &json!({ "text": text }));
        (Kind::Note { run: self.own_run, text }, request)
    }

    /// Stores results that later operations need.
    fn learn(&mut self, kind: &Kind, outcome: &Outcome) {
        let Some(answer) = outcome.acknowledged() else { return };
        match kind {
            Kind::Start => self.started = answer["id"].as_i64(),
            Kind::MakeToken { name } => {
                let (id, secret) = (answer["id"].as_i64(), answer["secret"].as_str());
                self.tokens.extend(id.zip(secret).map(|(id, secret)| (id, name.clone(), secret.to_owned())));
            }
            _ => {}
        }
    }
}
