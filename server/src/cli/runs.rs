//! `jointbench runs` and `jointbench stop`: what was measured, and how a run that is on is ended.

use super::arguments::{Runs, Stop};
use super::client::Client;
use super::exit::{Done, Exit};
use super::offline::json_out;
use super::run::{ending, is_over, wait};
use super::serve::runtime;
use super::transfer::{Way, open};
use crate::view::{Run, RunList, RunState, RunSummary, Safe, word};

/// Of a run that is not over, in a folder that no daemon has.
const NO_DAEMON: &str =
    "its daemon is gone: `jointbench serve` with this folder secures the bench and calls it interrupted";

pub fn runs(arguments: &Runs) -> Done {
    let runtime = runtime()?;
    let search = arguments.search.join(" ");
    let list: RunList = match open(&runtime, &arguments.store, false)? {
        Way::Folder(lab) => {
            let mut list = runtime.block_on(lab.runs(arguments.limit, 0, Some(&search)))?;
            for run in list.runs.iter_mut().filter(|run| !is_over(run.state)) {
                run.reason = Some(NO_DAEMON.to_owned());
            }
            list
        }
        Way::Daemon(client) => client.get(&format!("/runs?limit={}&search={}", arguments.limit, encoded(&search)))?,
    };
    if arguments.json {
        return json_out(&list);
    }
    list.runs.iter().for_each(|run| println!("{}", line(run)));
    let shown = list.runs.len() as u64;
    if shown < list.total {
        println!("{shown} of {}: --limit shows more", list.total);
    } else if shown == 0 {
        println!("no run{}", if search.is_empty() { "" } else { " matches" });
    }
    Ok(())
}

fn line(run: &RunSummary) -> String {
    let duration = run.duration_s.map(|s| format!("{s:.0} s")).unwrap_or_default();
    let day = run.created_at.get(..16).unwrap_or(&run.created_at).replace('T', " ");
    let reason = run.reason.as_ref().map(|reason| format!("  {reason}")).unwrap_or_default();
    let (id, state, procedure, bench) = (run.id, word(run.state), &run.procedure, &run.bench);
    format!("{id:5}  {day}  {state:11}  {procedure:24}  {bench:16}  {duration:>7}  {} rows{reason}", run.rows)
}

/// As it may stand in an address.
fn encoded(text: &str) -> String {
    let byte = |byte: u8| match byte {
        b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'-' | b'_' | b'.' | b'~' => char::from(byte).to_string(),
        other => format!("%{other:02X}"),
    };
    text.bytes().map(byte).collect()
}

pub fn stop(arguments: &Stop) -> Done {
    let client = Client::new(&arguments.reach);
    let id = match arguments.run {
        Some(id) => id,
        None => the_one_that_is_on(&client)?,
    };
    let how = if arguments.now { "abort" } else { "stop" };
    let _: Run = client.post(&format!("/runs/{id}/{how}"), &())?;
    let run = wait(&client, id)?;
    println!("{}", ending(&run));
    let failed = matches!(run.summary.state, RunState::Failed | RunState::Interrupted);
    match failed || run.summary.safe == Some(Safe::UnsafeUnknown) {
        true => Err(Exit::failed("")),
        false => Ok(()),
    }
}

fn the_one_that_is_on(client: &Client) -> Result<i64, Exit> {
    let list: RunList = client.get("/runs?limit=100")?;
    let on: Vec<String> = list.runs.iter().filter(|run| !is_over(run.state)).map(|run| run.id.to_string()).collect();
    match on.as_slice() {
        [one] => one.parse().map_err(|_| Exit::failed(format!("run {one} is no number"))),
        [] => Err(Exit::bad_input("no run is on: there is nothing to stop")),
        several => Err(Exit::bad_input(format!("runs {} are on: name one", several.join(" and ")))),
    }
}

#[cfg(test)]
mod tests {
    use super::encoded;

    #[test]
    fn a_search_may_stand_in_an_address() {
        assert_eq!(encoded("rows>10 tag:öl"), "rows%3E10%20tag%3A%C3%B6l");
    }
}
