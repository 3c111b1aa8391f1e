//! The long fault suite: the real program under random faults, with a table of the results.
//!
//! `cargo run -p jointbench-tests --bin faults -- --minutes 30 [--seed N] [--only stops|presses|deaths|history]`

use jointbench_tests::outcome::{Outcome, table};
use jointbench_tests::trouble::Trouble;
use jointbench_tests::{deaths, history, presses, stops};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use std::process::ExitCode;
use std::time::{Duration, Instant};

const USAGE: &str = "usage: faults [--minutes 30] [--seed N] [--only stops|presses|deaths|history]";
/// Scope of a run of 30 minutes; a shorter run has a proportional scope.
const FULL_MINUTES: f64 = 30.0;
const PRESSES_OF_EACH_TROUBLE: f64 = 50.0;
const HANG_UPS: f64 = 60.0;
const DEATHS_OF_EACH_KIND: f64 = 5.0;
const OPERATIONS: f64 = 2000.0;
/// Two control ticks of silence are allowed.
const MOST_SILENCE_TICKS: f64 = 2.0;

struct Arguments {
    minutes: f64,
    seed: u64,
    only: Option<String>,
}

fn main() -> ExitCode {
    let Some(arguments) = parse(std::env::args().skip(1)) else {
        eprintln!("{USAGE}");
        return ExitCode::from(2);
    };
    let begun = Instant::now();
    println!("seed {}", arguments.seed);
    let outcomes = play(&arguments);
    println!("\n{}", table(&outcomes));
    println!("{} s", begun.elapsed().as_secs());
    if outcomes.iter().all(Outcome::holds) { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

fn parse(mut words: impl Iterator<Item = String>) -> Option<Arguments> {
    let mut arguments = Arguments { minutes: FULL_MINUTES, seed: 1, only: None };
    while let Some(word) = words.next() {
        let value = words.next()?;
        match word.as_str() {
            "--minutes" => arguments.minutes = value.parse().ok().filter(|minutes| *minutes > 0.0)?,
            "--seed" => arguments.seed = value.parse().ok()?,
            "--only" => arguments.only = Some(value),
            _ => return None,
        }
    }
    Some(arguments)
}

fn play(arguments: &Arguments) -> Vec<Outcome> {
    let begun = Instant::now();
    let say = |text: &str| println!("{:6.1} s  {text}", begun.elapsed().as_secs_f64());
    let wanted = |part: &str| arguments.only.as_deref().is_none_or(|only| only == part);
    let share = |full: f64| (full * arguments.minutes / FULL_MINUTES).ceil() as usize;
    let mut random = ChaCha8Rng::seed_from_u64(arguments.seed);
    let mut outcomes = Vec::new();
    if wanted("stops") {
        for trouble in Trouble::ALL {
            let made = stops::stops(trouble, share(PRESSES_OF_EACH_TROUBLE), &mut random, &say);
            outcomes.extend(made.map(|outcome| hold_to(outcome, trouble.bound())));
        }
    }
    if wanted("presses") {
        outcomes.push(presses::hang_ups(share(HANG_UPS), &mut random));
    }
    if wanted("deaths") {
        outcomes.extend(deaths::deaths(share(DEATHS_OF_EACH_KIND), &say));
    }
    if wanted("history") {
        outcomes.push(history::histories(share(OPERATIONS), arguments.seed, &say));
    }
    outcomes
}

/// Checks the guaranteed times, which apply to a machine without other load.
fn hold_to(mut outcome: Outcome, bound: Duration) -> Outcome {
    let late = outcome.slowest_stop.filter(|stop| *stop > bound);
    outcome.broken.extend(late.map(|stop| format!("the slowest stop took {stop:?}, promised are {bound:?}")));
    let silent = outcome.longest_silence.filter(|ticks| *ticks > MOST_SILENCE_TICKS);
    outcome
        .broken
        .extend(silent.map(|ticks| format!("no control for {ticks:.1} ticks, promised are {MOST_SILENCE_TICKS}")));
    outcome
}
