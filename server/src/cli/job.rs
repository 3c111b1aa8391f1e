//! The process of a job: `jointbench job`.

use crate::job::{Head, Job, Limits, Refusal, Request};
use crate::lab::{Lab, LabError};
use crate::store::Store;
use std::io::{self, BufRead, Read, Write};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Lower scheduling priority than other processes.
#[cfg(unix)]
const NICE: i32 = 10;
/// Blocking threads, each with its own stack: reading a run uses one for each channel in sequence.
const BLOCKING_THREADS: usize = 16;

/// Reads a request, answers it, and ends. Exit code 0 means that the answer is complete.
pub fn main() -> ExitCode {
    let mut line = String::new();
    let read = io::stdin().lock().read_line(&mut line);
    let Ok(request) = read.map_err(drop).and_then(|_| serde_json::from_str::<Request<Job>>(&line).map_err(drop)) else {
        eprintln!("jointbench job: internal command of the daemon, with a request on standard input");
        return ExitCode::from(2);
    };
    limit_resources(request.limits);
    // The daemon learns about this process from its standard error and exit code.
    std::panic::set_hook(Box::new(|panic| eprintln!("{panic}")));
    exit_with_daemon();
    let has_begun = Arc::<AtomicBool>::default();
    let out = Answering { has_begun: has_begun.clone() };
    match answer(request, out) {
        Ok(()) => ExitCode::SUCCESS,
        Err(fault) if has_begun.load(Ordering::Acquire) => {
            eprintln!("{fault}");
            ExitCode::FAILURE
        }
        Err(fault) => match write_stdout(&Head::Refused(Box::new(Refusal::from(fault))).line()) {
            Ok(()) => ExitCode::SUCCESS,
            Err(_) => ExitCode::FAILURE,
        },
    }
}

fn answer(request: Request<Job>, mut out: Answering) -> Result<(), LabError> {
    let mut runtime = tokio::runtime::Builder::new_current_thread();
    let runtime = runtime.enable_all().max_blocking_threads(BLOCKING_THREADS).build();
    let runtime = runtime.map_err(|fault| LabError::Internal(format!("no threads: {fault}")))?;
    runtime.block_on(async move {
        let lab = Lab::of_store(Store::open_to_read(&request.data).await?);
        match request.job {
            Job::Export(request) => lab.export_into(request, out).await,
            job => {
                let bytes = lab.answer(job).await?;
                out.write_all(&bytes).map_err(|fault| LabError::Internal(fault.to_string()))
            }
        }
    })
}

/// Limits the memory of this process and lowers its priority. If memory is short, the system kills this process before
/// the daemon.
#[cfg(unix)]
fn limit_resources(limits: Limits) {
    use rustix::process::{Resource, Rlimit, nice, setrlimit};
    let limit = Rlimit { current: Some(limits.memory_bytes), maximum: Some(limits.memory_bytes) };
    if let Err(fault) = setrlimit(Resource::As, limit) {
        tracing::warn!(%fault, "the memory of a computation is not limited");
    }
    // The computation is correct without these settings.
    let is_idle = limits.is_idle && crate::priority::idle();
    if !is_idle {
        let _ = nice(NICE);
    }
    let _ = std::fs::write("/proc/self/oom_score_adj", "1000");
}

/// Only the time limit applies on such a system.
#[cfg(not(unix))]
fn limit_resources(_: Limits) {}

/// The daemon holds the other end of standard input. If it closes, also by `kill -9`, no client waits for the result.
fn exit_with_daemon() {
    let watch = || {
        let _ = io::stdin().lock().read(&mut [0]);
        std::process::exit(1);
    };
    let _ = std::thread::Builder::new().stack_size(64 << 10).spawn(watch);
}

/// Standard output; the head of an answer is written before the first byte.
struct Answering {
    has_begun: Arc<AtomicBool>,
}

impl Write for Answering {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if !self.has_begun.swap(true, Ordering::AcqRel) {
            write_stdout(&Head::Answer.line())?;
        }
        write_stdout(bytes)?;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Avoids the line buffer of standard output, which would search tables for line ends.
fn write_stdout(bytes: &[u8]) -> io::Result<()> {
    let out = io::stdout();
    let mut out = out.lock();
    out.write_all(bytes)?;
    out.flush()
}
