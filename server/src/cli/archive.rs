//! `jointbench archive`: state of the archive, and removal of archived samples.

use super::arguments::Archive;
use super::client::Client;
use super::exit::{Done, Exit};
use super::print::json_out;
use super::units::print_rows;
use crate::view::{ArchiveState, ArchivedTable};
use serde::Serialize;
use std::time::Duration;

pub fn archive(arguments: &Archive) -> Done {
    let client = Client::new(&arguments.reach)?;
    if let Some(age) = arguments.older_than {
        return drop_samples(&client, arguments, age);
    }
    match arguments.retry {
        true => state(&client.post("/archive/retry", &())?, arguments.json),
        false => state(&client.get("/archive")?, arguments.json),
    }
}

fn state(state: &ArchiveState, json: bool) -> Done {
    if json {
        return json_out(state);
    }
    let Some(url) = &state.url else {
        println!("no archive: add [archive] to the bench description (docs/archive.md)");
        return Ok(());
    };
    let contents = if state.raw { "means and samples" } else { "means" };
    println!("{url}: {contents} of each run");
    let numbers = [state.owed, state.archived, state.empty, state.failed, state.dropped].map(|n| n.to_string());
    print_rows(&["owed", "archived", "empty", "failed", "samples dropped"], [numbers].into_iter());
    state.oldest_owed.iter().for_each(|since| println!("the oldest run waits since {since}"));
    state.last_error.iter().for_each(|error| println!("last error: {error}"));
    Ok(())
}

/// What happened to the samples of a run.
#[derive(Serialize)]
struct Dropped {
    #[serde(flatten)]
    table: ArchivedTable,
    /// Why they stay in the store.
    #[serde(skip_serializing_if = "Option::is_none")]
    error: Option<String>,
}

fn drop_samples(client: &Client, arguments: &Archive, age: Duration) -> Done {
    let found: Vec<ArchivedTable> = client.get(&format!("/archive/samples?older_than_s={}", age.as_secs()))?;
    let mut outcomes = Vec::new();
    for table in found {
        let outcome = match arguments.dry_run {
            true => Dropped { table, error: None },
            false => match client.delete(&format!("/runs/{}/samples", table.run)) {
                Ok(table) => Dropped { table, error: None },
                Err(fault) => Dropped { table, error: Some(fault.message) },
            },
        };
        if !arguments.json {
            print(&outcome);
        }
        outcomes.push(outcome);
    }
    match (arguments.json, outcomes.is_empty()) {
        (true, _) => json_out(&outcomes)?,
        (false, true) => println!("no archived samples of this age are in the store"),
        (false, false) => {}
    }
    match outcomes.iter().filter(|outcome| outcome.error.is_some()).count() {
        0 => Ok(()),
        failed => Err(Exit::failed(format!("the samples of {failed} of {} runs stay in the store", outcomes.len()))),
    }
}

fn print(Dropped { table, error }: &Dropped) {
    let (run, file) = (table.run, table.file.as_deref().unwrap_or("–"));
    let megabytes = table.bytes.unwrap_or_default() as f64 / 1e6;
    match (error, table.dropped_at.is_some()) {
        (Some(error), _) => println!("  FAIL  run {run}: {error}"),
        (None, true) => println!("  ok    run {run}: dropped, {megabytes:.1} MB are in {file}"),
        (None, false) => println!("        run {run}: {megabytes:.1} MB in {file}"),
    }
}
