//! Time from a software stop to the first safe command to the drive.

use crate::client::Outcome as Answer;
use crate::lab::{BENCH, Lab};
use crate::machine::Watch;
use crate::outcome::Outcome;
use crate::trouble::Trouble;
use crate::wire::{Control, Wire, now_s};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use serde_json::{Value, json};
use std::time::{Duration, Instant};

/// Control period of the mock bench's friction runs.
const TICK: Duration = Duration::from_millis(4);
/// Time limit for the safe command.
const GIVES_UP: Duration = Duration::from_secs(30);
/// Duration of the fault before the stop; the range includes the database's lock timeout of 5 s.
const TROUBLED_S: std::ops::Range<f64> = 0.3..8.0;
/// A full disk ends a run within two seconds: the stop must come earlier.
const FULL_S: std::ops::Range<f64> = 0.0..1.5;
/// Lock time of the database before the first stop of a long series.
const LONGEST_HELD_S: f64 = 58.0;
const LONG_SERIES: usize = 50;

/// Measurement of one stop.
#[derive(Debug, Clone, Copy)]
pub struct Stop {
    pub latency: Duration,
    pub control: Control,
}

/// `count` stops during runs, each at a random time of the fault. `None` if the fault is not possible here.
pub fn stops(trouble: Trouble, count: usize, random: &mut ChaCha8Rng, say: &dyn Fn(&str)) -> Option<Outcome> {
    let (lab, _disk) = trouble.lab()?;
    let mut outcome = Outcome::new(format!("stop, {}", trouble.name()));
    let mut wire = lab.wire();
    let watch = Watch::start();
    for number in 1..=count {
        let troubled_s = match trouble {
            Trouble::FullDisk => random.random_range(FULL_S),
            Trouble::DatabaseHeld if number == 1 && count >= LONG_SERIES => LONGEST_HELD_S,
            _ => random.random_range(TROUBLED_S),
        };
        let stop = press(&lab, trouble, Duration::from_secs_f64(troubled_s), &mut wire, &mut outcome);
        let stall = watch.longest();
        outcome.stalled_for(stall);
        if let Some(Stop { latency, control }) = stop {
            let ticks = control.longest_silence.as_secs_f64() / TICK.as_secs_f64();
            outcome.stopped_after(latency);
            outcome.silent_for(ticks);
            let ms = 1e3 * latency.as_secs_f64();
            let stall_ms = 1e3 * stall.as_secs_f64();
            say(&format!(
                "{}: press {number} of {count}: {ms:.1} ms, silence {ticks:.1} ticks, an idle thread stood {stall_ms:.1} ms",
                outcome.name
            ));
        }
    }
    Some(outcome)
}

/// Presses the stop during a run, a given time after the start of the fault.
fn press(lab: &Lab, trouble: Trouble, after: Duration, wire: &mut Wire, outcome: &mut Outcome) -> Option<Stop> {
    lab.reset();
    let run = lab.start_moving("friction", wire);
    let begun = trouble.begin(lab);
    std::thread::sleep(after);
    let client = lab.client();
    let pressed_s = now_s();
    let pressing = std::thread::spawn(move || client.post(&format!("/bench/{BENCH}/stop"), &json!({})));
    outcome.faults += 1;
    let safe_s = first_safe_byte(wire, pressed_s);
    drop(begun);
    let answer = pressing.join().expect("the press ends");
    let is_taken = matches!(&answer, Answer::Answered { status: 200, .. });
    outcome.acknowledged += usize::from(is_taken);
    if !is_taken {
        outcome.lost(format!("the press at {pressed_s:.3} was answered with {answer:?}"));
    }
    let Some(safe_s) = safe_s else {
        outcome.lost(format!("no safe byte within {GIVES_UP:?} of the press at {pressed_s:.3}"));
        return None;
    };
    check_kept(lab, run, pressed_s, outcome);
    Some(Stop { latency: Duration::from_secs_f64(safe_s - pressed_s), control: wire.control() })
}

fn first_safe_byte(wire: &mut Wire, pressed_s: f64) -> Option<f64> {
    let until = Instant::now() + GIVES_UP;
    while Instant::now() < until {
        wire.look();
        if let Some(safe_s) = wire.disarmed_after(pressed_s) {
            return Some(safe_s);
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    None
}

/// The stop is in the safety record once, and the run has ended.
fn check_kept(lab: &Lab, run: i64, pressed_s: f64, outcome: &mut Outcome) {
    lab.wait(Duration::from_secs(60), "the stop to be stored", || {
        let bench = lab.bench();
        let record = lab.run(run);
        bench["blocked"]["stored"] == true && record["safe"].is_string() && record["not_stored"].is_null()
    });
    let since = lab.bench()["blocked"]["since"].clone();
    let record = lab.client().get(&format!("/bench/{BENCH}/safety"));
    let is_it = |entry: &&Value| entry["at"] == since && entry["blocked"] == true;
    match record.as_array().map_or(0, |entries| entries.iter().filter(is_it).count()) {
        0 => outcome.lost(format!("the press at {pressed_s:.3} is not in the safety record")),
        1 => {}
        more => outcome.doubled(format!("the press at {pressed_s:.3} is {more} times in the safety record")),
    }
    let run = lab.run(run);
    if run["safe"] != "safe_verified" {
        outcome.half_done(format!("after the press the run is {} and {}", run["state"], run["safe"]));
    }
}
