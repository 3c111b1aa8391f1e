//! Lock, process priority and signals of a worker: one worker for each bench of a data folder.

use super::Command;
use super::worker_state::WorkerState;
use crate::bench::leftovers::file_name;
use jointbench_procedure::Control;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io;
use std::path::Path;
use std::sync::Arc;
use std::sync::mpsc::Sender;
use std::time::{Duration, Instant};

/// Waiting time for the worker of a killed daemon, which first secures its bench.
const PATIENCE: Duration = Duration::from_secs(20);
const FOLDER: &str = "workers";
const POLL_INTERVAL: Duration = Duration::from_millis(20);

/// Waits until no other worker owns the bench. The file is the lock. `Err` names the owner.
pub(super) fn take(data: &Path, bench: &str) -> Result<File, String> {
    let path = data.join(FOLDER).join(format!("{}.lock", file_name(bench)));
    let unwritable =
        |fault: io::Error| format!("{} cannot be written ({fault}): check its permissions", path.display());
    path.parent().map_or(Ok(()), fs::create_dir_all).map_err(unwritable)?;
    let file =
        OpenOptions::new().read(true).write(true).create(true).truncate(false).open(&path).map_err(unwritable)?;
    let give_up = Instant::now() + PATIENCE;
    loop {
        match file.try_lock() {
            Ok(()) => return Ok(file),
            Err(TryLockError::WouldBlock) if Instant::now() < give_up => std::thread::sleep(POLL_INTERVAL),
            Err(TryLockError::WouldBlock) => {
                let why = "an earlier worker still uses this bench: end the process `jointbench worker`, then retry";
                return Err(why.to_owned());
            }
            Err(TryLockError::Error(fault)) => return Err(unwritable(fault)),
        }
    }
}

/// Waits until no worker of an earlier daemon uses the data folder, or until a timeout.
pub fn wait_until_gone(data: &Path) {
    let Ok(locks) = fs::read_dir(data.join(FOLDER)) else { return };
    let give_up = Instant::now() + PATIENCE;
    for lock in locks.flatten() {
        let Ok(file) = File::open(lock.path()) else { continue };
        while matches!(file.try_lock_shared(), Err(TryLockError::WouldBlock)) && Instant::now() < give_up {
            std::thread::sleep(POLL_INTERVAL);
        }
    }
}

/// Gives control priority over fits and requests, if the system allows it. A bench in real time gets the real-time
/// policy. A simulation at full speed only gets a higher priority, because it would occupy a core with that policy.
pub(super) fn raise_priority(is_real_time: bool) {
    if is_real_time && crate::priority::real_time() {
        return;
    }
    #[cfg(unix)]
    if let Err(fault) = rustix::process::setpriority_process(None, -10) {
        tracing::debug!(%fault, "the worker keeps the priority that it was started with");
    }
}

/// On a termination signal the worker ends as if its server were gone.
pub(super) fn end_on_signal(worker: Arc<WorkerState>, commands: Sender<Command>) -> io::Result<()> {
    #[cfg(unix)]
    {
        use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
        let mut signals = signal_hook::iterator::Signals::new([SIGTERM, SIGINT, SIGHUP])?;
        std::thread::Builder::new().name("signals".into()).spawn(move || {
            for signal in &mut signals {
                tracing::warn!(signal, "worker shutdown requested: securing the bench");
                worker.control(Control::Quit.into());
                // An error means that the owner has already ended.
                let _ = commands.send(Command::Quit);
            }
        })?;
    }
    Ok(())
}
