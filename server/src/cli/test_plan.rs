//! `jointbench queue add --wait`: the runs of a test plan, in order.

use super::client::Client;
use super::exit::{Done, Exit};
use super::outcome::Found;
use super::print::json_out;
use super::queue_entry;
use super::run::{announce, cases, conclude, end_of, found, worst, write_junit};
use crate::view::{QueueEntry, Run};
use std::path::Path;

/// Waits for the end of every run, prints its result, and returns the worst exit. An entry that was removed because an
/// earlier run did not meet `proceed_if` is a failure.
pub(super) fn wait(client: &Client, entries: &[QueueEntry], junit: Option<&Path>, json: bool) -> Done {
    let mut ended: Vec<(Result<Run, Exit>, Option<Found>)> = Vec::new();
    let mut exits = Vec::new();
    for entry in entries {
        let run = queue_entry::run_of(client, entry, None).and_then(|run| {
            if !json {
                announce(client, &run, None);
            }
            end_of(client, run.summary.id, None, None)
        });
        let found = found(client, &run);
        match &run {
            Ok(run) => exits.extend(conclude(run, found.as_ref(), &[], json).err()),
            Err(exit) => {
                eprintln!("jointbench: {}", exit.message);
                exits.push(Exit { message: String::new(), ..exit.clone() });
            }
        }
        ended.push((run, found));
    }
    if let Some(path) = junit {
        let of_run = |((run, found), entry): (&(Result<Run, Exit>, Option<Found>), &QueueEntry)| {
            cases(&entry.request.procedure, run, found.as_ref(), &[], &[])
        };
        let cases: Vec<_> = ended.iter().zip(entries).flat_map(of_run).collect();
        let runs: Vec<_> = ended.iter().map(|(run, found)| (run, found.as_ref())).collect();
        write_junit(path, &runs, &cases)?;
    }
    if json {
        json_out(&ended.iter().filter_map(|(run, _)| run.as_ref().ok()).collect::<Vec<_>>())?;
    }
    worst(&exits)
}
