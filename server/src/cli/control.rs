//! `jointbench stop`, `pause`, `resume` and `reset`: control of an active run or an idle bench.

use super::arguments::{Control, Reset, Stop};
use super::client::Client;
use super::exit::{Done, Exit};
use super::run::choose_bench;
use super::waiting::{POLL_INTERVAL, wait};
use crate::view::{self, Acknowledgement, Bench, Run, RunList, RunState, Safe};

pub fn stop(arguments: &Stop) -> Done {
    let client = Client::new(&arguments.reach)?;
    let id = named_or_on(&client, arguments.run)?;
    let how = if arguments.now { "abort" } else { "stop" };
    let _: Run = client.post(&format!("/runs/{id}/{how}"), &())?;
    let run = wait(&client, id)?;
    println!("{}", run.ending());
    let failed = matches!(run.summary.state, RunState::Failed | RunState::Interrupted);
    match failed || run.summary.safe == Some(Safe::UnsafeUnknown) {
        true => Err(Exit::failed("")),
        false => Ok(()),
    }
}

pub fn pause(arguments: &Control) -> Done {
    request(arguments, "pause", RunState::Paused)
}

pub fn resume(arguments: &Control) -> Done {
    request(arguments, "resume", RunState::Running)
}

/// Waits until the run has the wanted state.
fn request(arguments: &Control, how: &str, wanted: RunState) -> Done {
    let client = Client::new(&arguments.reach)?;
    let id = named_or_on(&client, arguments.run)?;
    let mut run: Run = client.post(&format!("/runs/{id}/{how}"), &())?;
    while run.summary.state != wanted && !run.summary.state.is_final() {
        std::thread::sleep(POLL_INTERVAL);
        run = client.get(&format!("/runs/{id}"))?;
    }
    println!("{}", run.ending());
    match run.summary.state == wanted {
        true => Ok(()),
        false => Err(Exit::failed("")),
    }
}

pub fn reset(arguments: &Reset) -> Done {
    let client = Client::new(&arguments.reach)?;
    let name = choose_bench(&client, arguments.bench.as_deref())?;
    let word = Acknowledgement { reason: arguments.reason.clone() };
    let bench: Bench = client.post(&format!("/bench/{name}/acknowledge"), &word)?;
    println!("bench {name} is {}", view::word(bench.state));
    Ok(())
}

fn named_or_on(client: &Client, named: Option<i64>) -> Result<i64, Exit> {
    if let Some(id) = named {
        return Ok(id);
    }
    let list: RunList = client.get("/runs?limit=100")?;
    let on: Vec<String> = list.runs.iter().filter(|run| !run.state.is_final()).map(|run| run.id.to_string()).collect();
    match on.as_slice() {
        [one] => one.parse().map_err(|_| Exit::failed(format!("run {one}: expected a number"))),
        [] => Err(Exit::bad_input("no run is active")),
        several => Err(Exit::bad_input(format!("runs {} are active: name one", several.join(" and ")))),
    }
}
