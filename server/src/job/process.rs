//! The daemon's side of a job: starts the process, reads its answer, and kills it when no client waits.

use super::lane::{Lane, Turn, ending};
use super::reply::Head;
use super::{GIB, Job, Limits, Queue, Request};
use crate::error::LabError;
use axum::body::Bytes;
use std::path::{Path, PathBuf};
use std::process::{ExitStatus, Stdio};
use std::sync::Arc;
use tokio::io::{AsyncBufReadExt, AsyncReadExt, AsyncWriteExt, BufReader};
use tokio::process::{Child, ChildStderr, ChildStdin, ChildStdout, Command};
use tokio::sync::{mpsc, watch};
use tokio::task::JoinHandle;
use tokio::time::Instant;

/// Limit of a complete answer in memory. Larger answers are streamed ([`Jobs::stream`]).
const MAX_ANSWER_BYTES: u64 = 128 << 20;
/// Limit of the head: one line with a sentence.
const MAX_HEAD_BYTES: u64 = 1 << 20;
/// Limit of the stored error output, which contains the last messages of the process.
const MAX_STDERR_BYTES: u64 = 16 << 10;
/// Bytes of a piece, and number of pieces that wait for a slow reader.
const PIECE_BYTES: usize = 64 << 10;
const PIECES: usize = 4;

/// Starts the jobs of one daemon. Clones share its queues.
#[derive(Debug, Clone)]
pub struct Jobs {
    inner: Arc<Inner>,
}

#[derive(Debug)]
struct Inner {
    program: PathBuf,
    data: PathBuf,
    limits: Limits,
    computing: Lane,
    moving: Lane,
    archiving: Lane,
    ending: watch::Sender<bool>,
}

/// An answer in pieces. Dropping it ends its process.
pub type Streamed = mpsc::Receiver<Result<Bytes, LabError>>;

impl Jobs {
    /// `program` is the path of the `jointbench` executable, `data` the data folder.
    pub fn new(program: &Path, data: &Path, limits: Limits) -> Jobs {
        let (program, data) = (program.to_owned(), data.to_owned());
        // A process cannot have more memory than its parent.
        let limits = Limits { memory_bytes: limits.memory_bytes.min(memory_limit_bytes()), ..limits };
        let (computing, moving, archiving, ending) = Default::default();
        Jobs { inner: Arc::new(Inner { program, data, limits, computing, moving, archiving, ending }) }
    }

    /// The data folder.
    pub fn data(&self) -> &Path {
        &self.inner.data
    }

    /// The complete answer. The process ends if the future is dropped, with [`Jobs::end`], and at the time limit.
    pub async fn run(&self, job: &Job) -> Result<Vec<u8>, LabError> {
        let mut process = self.start(job).await?;
        let mut answer = Vec::new();
        while let Some(piece) = process.piece().await? {
            if answer.len() as u64 + piece.len() as u64 > MAX_ANSWER_BYTES {
                return Err(LabError::TooLarge(format!(
                    "the result exceeds {} MiB: choose a shorter run, or exclude intervals",
                    MAX_ANSWER_BYTES >> 20
                )));
            }
            answer.extend_from_slice(&piece);
        }
        Ok(answer)
    }

    /// The same for answers of any size. A refusal before the first piece is returned as an error here.
    pub async fn stream(&self, job: &Job) -> Result<Streamed, LabError> {
        let mut process = self.start(job).await?;
        let (give, take) = mpsc::channel(PIECES);
        tokio::spawn(async move {
            loop {
                let piece = tokio::select! {
                    piece = process.piece() => piece,
                    () = give.closed() => return,
                };
                let Some(piece) = piece.transpose() else { return };
                let is_last = piece.is_err();
                // A reader that stops reading holds the process only until its time limit.
                let given = process.in_time(async { Ok(give.send(piece).await) }).await;
                if is_last || !matches!(given, Ok(Ok(()))) {
                    return;
                }
            }
        });
        Ok(take)
    }

    /// Ends all processes and refuses new ones.
    pub fn end(&self) {
        self.inner.computing.close();
        self.inner.moving.close();
        self.inner.archiving.close();
        self.inner.ending.send_replace(true);
    }

    async fn start(&self, job: &Job) -> Result<Process, LabError> {
        let inner = &self.inner;
        let lane = match job.queue() {
            Queue::Computing => &inner.computing,
            Queue::Moving => &inner.moving,
            Queue::Archiving => &inner.archiving,
        };
        let turn = lane.enter().await?;
        let request = Request { data: inner.data.clone(), limits: inner.limits, job };
        let mut line = serde_json::to_vec(&request).map_err(|fault| LabError::Internal(fault.to_string()))?;
        line.push(b'\n');
        let mut process = Process::spawn(inner, turn, job.queue())?;
        process.ask(&line).await?;
        Ok(process)
    }
}

/// The process of a job. Dropping it kills the process.
struct Process {
    child: Child,
    /// Open while a client waits.
    stdin: ChildStdin,
    stdout: BufReader<ChildStdout>,
    stderr: JoinHandle<String>,
    limits: Limits,
    until: Instant,
    ending: watch::Receiver<bool>,
    _turn: Turn,
}

impl Process {
    fn spawn(inner: &Inner, turn: Turn, queue: Queue) -> Result<Process, LabError> {
        let mut command = Command::new(&inner.program);
        #[cfg(unix)]
        command.arg0("jointbench");
        command.arg("job").stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        // The environment may contain tokens. Object storage needs its own ones.
        command.env_clear();
        if queue == Queue::Archiving {
            command.envs(std::env::vars_os().filter(|(name, _)| name.as_encoded_bytes().starts_with(b"AWS_")));
        }
        let mut child = command
            .kill_on_drop(true)
            .spawn()
            .map_err(|fault| LabError::Internal(format!("the computation cannot be started: {fault}")))?;
        let pipes = (child.stdin.take(), child.stdout.take(), child.stderr.take());
        let (Some(stdin), Some(stdout), Some(stderr)) = pipes else { unreachable!("all three are piped") };
        Ok(Process {
            child,
            stdin,
            stdout: BufReader::new(stdout),
            stderr: tokio::spawn(read_stderr(stderr)),
            limits: inner.limits,
            until: Instant::now() + inner.limits.time,
            ending: inner.ending.subscribe(),
            _turn: turn,
        })
    }

    /// Sends the request and waits for the head of the reply.
    async fn ask(&mut self, line: &[u8]) -> Result<(), LabError> {
        let mut head = String::new();
        let (stdin, stdout) = (&mut self.stdin, &mut self.stdout);
        let exchange = async {
            // A process that ends immediately does not read the request; its exit status contains the reason.
            let _ = stdin.write_all(line).await;
            stdout.take(MAX_HEAD_BYTES).read_line(&mut head).await
        };
        in_time(self.until, &mut self.ending, self.limits, exchange).await?;
        match serde_json::from_str(&head) {
            Ok(Head::Answer) => Ok(()),
            Ok(Head::Refused(refusal)) => Err(self.limits.with_cause((*refusal).into())),
            Err(_) => Err(self.died().await),
        }
    }

    /// The next piece; `None` after the last piece of a complete answer.
    async fn piece(&mut self) -> Result<Option<Bytes>, LabError> {
        let mut piece = vec![0; PIECE_BYTES];
        let read = in_time(self.until, &mut self.ending, self.limits, self.stdout.read(&mut piece)).await?;
        piece.truncate(read);
        if read > 0 {
            return Ok(Some(piece.into()));
        }
        match in_time(self.until, &mut self.ending, self.limits, self.child.wait()).await?.success() {
            true => Ok(None),
            false => Err(self.died().await),
        }
    }

    async fn in_time<T>(&mut self, what: impl Future<Output = std::io::Result<T>>) -> Result<T, LabError> {
        in_time(self.until, &mut self.ending, self.limits, what).await
    }

    /// The reason for a missing answer.
    async fn died(&mut self) -> LabError {
        let ended = async { self.child.wait().await };
        let status = match in_time(self.until, &mut self.ending, self.limits, ended).await {
            Ok(status) => status,
            Err(fault) => return fault,
        };
        let stderr = (&mut self.stderr).await.unwrap_or_default();
        tracing::warn!(%status, stderr = stderr.trim(), "a computation died");
        match lacked_memory(status, &stderr) {
            true => self.limits.too_much_memory(),
            false => LabError::Internal(format!("the computation failed ({status}): {}", last_line(&stderr))),
        }
    }
}

async fn read_stderr(stderr: ChildStderr) -> String {
    let mut stderr = BufReader::new(stderr);
    let mut text = Vec::new();
    let _ = (&mut stderr).take(MAX_STDERR_BYTES).read_to_end(&mut text).await;
    // Reads the rest, so that the process does not block on a full pipe.
    let _ = tokio::io::copy(&mut stderr, &mut tokio::io::sink()).await;
    String::from_utf8_lossy(&text).into_owned()
}

async fn in_time<T>(
    until: Instant,
    ends: &mut watch::Receiver<bool>,
    limits: Limits,
    what: impl Future<Output = std::io::Result<T>>,
) -> Result<T, LabError> {
    tokio::select! {
        done = what => done.map_err(|fault| LabError::Internal(format!("the computation failed: {fault}"))),
        () = tokio::time::sleep_until(until) => Err(limits.too_long()),
        _ = ends.wait_for(|ends| *ends) => Err(ending()),
    }
}

#[cfg(unix)]
fn memory_limit_bytes() -> u64 {
    rustix::process::getrlimit(rustix::process::Resource::As).maximum.unwrap_or(u64::MAX)
}

#[cfg(not(unix))]
fn memory_limit_bytes() -> u64 {
    u64::MAX
}

/// A failed allocation ends a Rust program by SIGABRT; a system with too little memory ends it by SIGKILL.
fn lacked_memory(status: ExitStatus, stderr: &str) -> bool {
    #[cfg(unix)]
    let killed = std::os::unix::process::ExitStatusExt::signal(&status) == Some(9);
    #[cfg(not(unix))]
    let killed = false;
    killed || mentions_memory(stderr)
}

/// Messages of Rust, the system (ENOMEM, and EAGAIN for the stack of a thread) and SQLite.
fn mentions_memory(text: &str) -> bool {
    let known = ["memory allocation of", "Cannot allocate memory", "out of memory", "Resource temporarily unavailable"];
    known.iter().any(|known| text.contains(known))
}

fn last_line(text: &str) -> &str {
    text.lines().rev().find(|line| !line.trim().is_empty()).unwrap_or("no message")
}

impl Limits {
    fn too_much_memory(self) -> LabError {
        LabError::TooLarge(format!(
            "the computation needs more than {} GiB of memory: use fewer rows (exclude intervals, or import every n-th \
             row), or start the daemon with a larger --analysis-memory",
            self.memory_bytes as f64 / GIB as f64
        ))
    }

    fn too_long(self) -> LabError {
        LabError::TooLarge(format!(
            "the computation takes longer than {} s: use fewer rows (exclude intervals, or import every n-th row), or \
             fewer effects",
            self.time.as_secs()
        ))
    }

    /// Replaces a refusal whose cause was a lack of memory.
    fn with_cause(self, error: LabError) -> LabError {
        match &error {
            LabError::Internal(text) | LabError::Setup(text) if mentions_memory(text) => self.too_much_memory(),
            _ => error,
        }
    }
}
