//! An entry of a queue: a run that waits for its bench.

use super::client::Client;
use super::exit::{Done, Exit};
use super::print::json_out;
use super::waiting::{POLL_INTERVAL, RENEWALS, RESTARTED};
use crate::view::{BenchQueue, Lease, NewRun, QueueEntry, QueueState, Run, word};
use std::time::{Duration, Instant};

/// Time between two lines of a waiting command.
const LINE_EVERY: Duration = Duration::from_secs(30);

/// Queues a run.
pub(super) fn add(client: &Client, new: &NewRun, key: Option<&str>) -> Result<QueueEntry, Exit> {
    match key {
        Some(key) => client.post_once("/runs", key, new),
        None => client.post("/runs", new),
    }
}

/// Prints an entry. A request with a known key returns its earlier entry.
pub(super) fn show(client: &Client, entry: &QueueEntry, json: bool) -> Done {
    if json {
        return json_out(entry);
    }
    let NewRun { bench, procedure, .. } = &entry.request;
    let state = match (entry.state, entry.run) {
        (QueueState::Waiting, _) => waiting_line(client, entry)?,
        (_, Some(run)) => format!("this key was already used: run {run}"),
        (state, None) => format!("this key was already used: {}", word(state)),
    };
    println!("queue entry {}: {procedure} on {bench}, {state}", entry.id);
    Ok(())
}

/// Waits until an entry has left the queue, and returns its run. After `limit` the entry is removed.
pub(super) fn run_of(client: &Client, entry: &QueueEntry, limit: Option<Duration>) -> Result<Run, Exit> {
    let id = entry.id;
    notify_on_interrupt(id, entry.request.lease_s);
    let renewal = entry.request.lease_s.map(|s| Duration::from_secs_f64(s) / RENEWALS);
    let began = Instant::now();
    let (mut answered, mut renewed, mut printed) = (began, began, None::<(Instant, String)>);
    loop {
        if renewal.is_some_and(|interval| renewed.elapsed() > interval) {
            renewed = Instant::now();
            // The next request shows whether the entry has left the queue.
            drop(client.post::<Lease>(&format!("/queue/{id}/lease"), &()));
        }
        if let Some(limit) = limit.filter(|limit| began.elapsed() > *limit) {
            let why = printed.as_ref().map_or("it waits", |(_, line)| line.as_str());
            // An entry that has started in the meantime is not removed: its run has its own time.
            if client.delete::<QueueEntry>(&format!("/queue/{id}")).is_ok() {
                return Err(Exit::failed(timed_out(id, limit, why)));
            }
        }
        let entry: QueueEntry = match client.get(&format!("/queue/{id}")) {
            Ok(entry) => entry,
            // A restarted daemon knows the entry.
            Err(_) if answered.elapsed() < RESTARTED && !client.is_answered() => {
                std::thread::sleep(POLL_INTERVAL);
                continue;
            }
            Err(exit) => {
                return Err(Exit::failed(format!("queue entry {id}: its state is unknown ({})", exit.message)));
            }
        };
        answered = Instant::now();
        match (entry.state, entry.run) {
            (QueueState::Started, Some(run)) => return client.get(&format!("/runs/{run}")),
            (QueueState::Failed | QueueState::Removed, _) => {
                let reason = entry.reason.unwrap_or_default();
                return Err(Exit::failed(format!("queue entry {id} was {} ({reason})", word(entry.state))));
            }
            _ => {}
        }
        let line = waiting_line(client, &entry)?;
        let is_new = printed.as_ref().is_none_or(|(at, text)| at.elapsed() > LINE_EVERY || is_other(text, &line));
        if is_new {
            eprintln!("  queue entry {id} {line}");
            printed = Some((Instant::now(), line));
        }
        std::thread::sleep(POLL_INTERVAL);
    }
}

fn timed_out(id: i64, limit: Duration, why: &str) -> String {
    format!(
        "queue entry {id} is removed, because it waited longer than --timeout {} s ({why}): use a longer time, or queue \
         it without --timeout",
        limit.as_secs_f64()
    )
}

/// Whether a line differs by more than its times.
fn is_other(before: &str, line: &str) -> bool {
    let words = |text: &str| text.chars().filter(|c| !c.is_ascii_digit()).collect::<String>();
    words(before) != words(line)
}

/// `waits: 2 before it, starts in 40 s`, or why the queue is paused.
fn waiting_line(client: &Client, entry: &QueueEntry) -> Result<String, Exit> {
    let queues: Vec<BenchQueue> = client.get("/queue")?;
    let bench = &entry.request.bench;
    let Some(queue) = queues.into_iter().find(|queue| queue.bench == *bench) else { return Ok("waits".to_owned()) };
    if let Some(pause) = queue.paused {
        return Ok(format!("waits: the queue is paused, {}; `jointbench queue resume {bench}`", pause.reason));
    }
    let position = queue.entries.iter().position(|one| one.id == entry.id);
    let Some((before, s)) = position.and_then(|before| Some((before, queue.entries[before].starts_in_s?))) else {
        return Ok("starts".to_owned());
    };
    let place = if before == 0 { "next".to_owned() } else { format!("{before} before it") };
    Ok(format!("waits: {place}, starts in {s:.0} s"))
}

/// Ctrl-C ends only the command: informs about the entry.
fn notify_on_interrupt(id: i64, lease_s: Option<f64>) {
    super::waiting::on_interrupt(move || match lease_s {
        Some(s) => format!("queue entry {id} is removed within {s} s (--lease)"),
        None => format!("queue entry {id} still waits: remove it with `jointbench queue remove {id}`"),
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_timeout_states_what_the_run_waited_for() {
        let text = timed_out(3, Duration::from_secs(5), "waits: 2 before it, starts in 40 s");
        assert!(
            text.contains("queue entry 3 is removed") && text.contains("--timeout 5 s (waits: 2 before it"),
            "{text}"
        );
    }
}
