//! Clients that press the software stop and disconnect immediately.

use crate::client::{Outcome as Answer, Request};
use crate::lab::{BENCH, Lab};
use crate::outcome::Outcome;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use serde_json::{Value, json};
use std::time::Duration;

/// In sequence, `count` clients press the stop and reset their connection within 1 ms. Each complete request must be in
/// the safety record with the name of its sender, and the bench must be stopped.
pub fn hang_ups(count: usize, random: &mut ChaCha8Rng) -> Outcome {
    let mut outcome = Outcome::new("stop request, disconnected within 1 ms");
    let mut lab = Lab::new(None);
    lab.start();
    for number in 0..count {
        let mut client = lab.client();
        let name = format!("hurried {number}");
        let made = client.post("/tokens", &json!({ "name": name, "access": "read" }));
        let secret = made.acknowledged().and_then(|made| made["secret"].as_str());
        client.token = secret.unwrap_or_else(|| panic!("no token: {made:?}")).to_owned();
        let press = Request::post(format!("/bench/{BENCH}/stop"), &json!({}));
        outcome.faults += 1;
        if !client.hang_up(&press, 1.0, Duration::from_micros(random.random_range(0..1000))) {
            continue;
        }
        outcome.acknowledged += 1;
        std::thread::sleep(SETTLES);
        check(&lab, &name, &mut outcome);
        lab.reset();
    }
    outcome
}

/// A stop is active immediately; storing it needs a write.
const SETTLES: Duration = Duration::from_millis(300);

fn check(lab: &Lab, name: &str, outcome: &mut Outcome) {
    let record = lab.client().get(&format!("/bench/{BENCH}/safety"));
    let by_name = |entry: &&Value| entry["blocked"] == true && entry["by"] == *name;
    match record.as_array().map_or(0, |entries| entries.iter().filter(by_name).count()) {
        0 => outcome.lost(format!("the press of {name} is recorded nowhere")),
        1 => {}
        more => outcome.doubled(format!("the press of {name} is {more} times in the safety record")),
    }
    let body = json!({ "bench": BENCH, "procedure": "friction", "parameters": {} });
    if let Answer::Answered { status: 201, .. } = lab.client().post("/runs", &body) {
        outcome.half_done(format!("after the press of {name} a run starts"));
    }
}
