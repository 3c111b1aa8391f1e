//! Waiting for the end of a run.

use super::client::Client;
use super::exit::Exit;
use super::progress::RunProgress;
use crate::view::{Lease, Run, RunState};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

pub(super) const POLL_INTERVAL: Duration = Duration::from_millis(250);

/// Waiting time for a daemon that does not answer.
pub(super) const RESTARTED: Duration = Duration::from_secs(15);
/// A lease is renewed so many times before it expires.
pub(super) const RENEWALS: u32 = 4;
/// Exit code of a shell after Ctrl-C.
const INTERRUPTED: i32 = 130;

/// Ctrl-C ends only the wait, not the run: informs the person at the bench.
pub(super) fn notify_on_interrupt(id: i64, lease: Option<Duration>) {
    on_interrupt(move || match lease {
        Some(lease) => format!("run {id} ends within {} s (--lease)", lease.as_secs_f64()),
        None => format!("run {id} continues: show it with `jointbench runs id:{id}`, end it with `jointbench stop`"),
    });
}

/// The message of the latest call is printed on Ctrl-C.
pub(super) fn on_interrupt(message: impl Fn() -> String + Send + 'static) {
    static MESSAGE: Mutex<Option<Box<dyn Fn() -> String + Send>>> = Mutex::new(None);
    let is_first = MESSAGE.lock().unwrap_or_else(PoisonError::into_inner).replace(Box::new(message)).is_none();
    if !is_first {
        return;
    }
    std::thread::spawn(|| {
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
        // Without the runtime, Ctrl-C ends this command without a message.
        let Ok(runtime) = runtime else { return };
        if runtime.block_on(tokio::signal::ctrl_c()).is_ok() {
            if let Some(message) = &*MESSAGE.lock().unwrap_or_else(PoisonError::into_inner) {
                eprintln!("\n{}", message());
            }
            std::process::exit(INTERRUPTED);
        }
    });
}

/// Message about a run whose daemon is gone, or whose state cannot be requested.
pub(super) fn lost(id: i64, is_answered: bool, message: &str) -> Exit {
    Exit::failed(match is_answered {
        true => format!("run {id}: its state is unknown ({message})"),
        false => format!(
            "run {id}: the daemon does not answer, so the state of the run is unknown. The bench worker moves the \
             bench to its safe state; if it was killed too, the daemon does so at its next start (jointbench serve). \
             To see how the run ended: `jointbench runs id:{id}`"
        ),
    })
}

pub(super) fn wait(client: &Client, id: i64) -> Result<Run, Exit> {
    wait_at_most(client, id, None, None)
}

/// Aborts a run that takes longer than `limit`, renews its lease, and waits for its end.
pub(super) fn wait_at_most(
    client: &Client,
    id: i64,
    limit: Option<Duration>,
    lease: Option<Duration>,
) -> Result<Run, Exit> {
    let mut shown = RunProgress::begin();
    let began = Instant::now();
    let (mut answered, mut exceeded) = (began, None);
    let (renewal, mut renewed) = (lease.map(|lease| lease / RENEWALS), began);
    loop {
        if renewal.is_some_and(|interval| renewed.elapsed() > interval) {
            renewed = Instant::now();
            // The next request shows an end of the run.
            drop(client.post::<Lease>(&format!("/runs/{id}/lease"), &()));
        }
        if let Some(limit) = limit.filter(|limit| exceeded.is_none() && began.elapsed() > *limit) {
            exceeded = Some(limit);
            // The daemon refuses this for an ended run; the next request shows the end.
            drop(client.post::<Run>(&format!("/runs/{id}/abort"), &()));
        }
        let run: Run = match client.get(&format!("/runs/{id}")) {
            Ok(run) => run,
            // A restarted daemon knows the end of the run.
            Err(_) if answered.elapsed() < RESTARTED && !client.is_answered() => {
                std::thread::sleep(POLL_INTERVAL);
                continue;
            }
            Err(exit) => return Err(exit),
        };
        answered = Instant::now();
        // After a restart of the daemon, the end of a run appears before its safe state. A completed run can be read
        // only when it is stored. Other ends are final immediately.
        let waits_for_the_disk = run.summary.state == RunState::Completed && run.summary.not_stored.is_some();
        if run.summary.state.is_final() && run.summary.safe.is_some() && !waits_for_the_disk {
            shown.end();
            return Ok(match exceeded {
                Some(limit) if run.summary.state == RunState::Aborted => timed_out(run, limit),
                _ => run,
            });
        }
        match &run.progress {
            _ if run.summary.state == RunState::Paused => shown.paused(id),
            Some(progress) => shown.show(progress),
            None => {}
        }
        std::thread::sleep(POLL_INTERVAL);
    }
}

fn timed_out(mut run: Run, limit: Duration) -> Run {
    let limit_s = limit.as_secs_f64();
    run.summary.reason = Some(format!("this command aborted it, because it took longer than --timeout {limit_s} s"));
    run
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lost_daemon_is_reported_with_the_known_state() {
        let (gone, refused) = (lost(7, false, "no daemon answers"), lost(7, true, "a token is needed"));
        assert!(gone.code == 1 && gone.message.contains("safe state") && gone.message.contains("jointbench runs id:7"));
        assert_eq!((refused.code, refused.message.as_str()), (1, "run 7: its state is unknown (a token is needed)"));
    }
}
