//! A daemon with one mock bench in real time; its processes can be killed and restarted.

use crate::client::{Client, Request};
use crate::program::jointbench;
use crate::wire::Wire;
use rustix::process::{Pid, Signal, kill_process};
use serde_json::{Value, json};
use std::fs::{self, OpenOptions};
use std::io::{BufRead, BufReader};
use std::net::{SocketAddr, TcpListener};
use std::path::{Path, PathBuf};
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

pub const BENCH: &str = "mock";
/// Token of the operator from the start of the daemon.
pub const TOKEN: &str = "the fault suite's own token";
/// A start waits until an earlier worker has secured its bench.
const STARTS: Duration = Duration::from_secs(60);

pub struct Lab {
    folder: TempDir,
    /// In memory if possible: recording the traffic must not wait for a disk under test.
    record: TempDir,
    pub data: PathBuf,
    pub address: SocketAddr,
    /// Bench seconds per real second; `None`: as fast as possible.
    pub pace: Option<f64>,
    /// Library that intercepts system calls of the daemon.
    pub preload: Option<PathBuf>,
    server: Option<Child>,
    last_worker: Option<Pid>,
}

impl Lab {
    /// Starts no process. `data`: the data folder, if not a temporary one.
    pub fn new(data: Option<PathBuf>) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let record = tempfile::tempdir_in("/dev/shm").or_else(|_| tempfile::tempdir()).expect("a folder");
        // The port is free now, and every restart of the daemon uses it again.
        let address = TcpListener::bind("127.0.0.1:0").and_then(|free| free.local_addr()).expect("a free port");
        let data = data.unwrap_or_else(|| folder.path().join("data"));
        Self { folder, record, data, address, pace: Some(1.0), preload: None, server: None, last_worker: None }
    }

    pub fn folder(&self) -> &Path {
        self.folder.path()
    }

    pub fn database(&self) -> PathBuf {
        self.data.join("jointbench.db")
    }

    pub fn client(&self) -> Client {
        Client { address: self.address, token: TOKEN.into() }
    }

    /// Returns when the daemon answers.
    pub fn start(&mut self) {
        let config = self.folder().join("bench.toml");
        let pace = self.pace.map(|pace| format!("pace = {pace:.1}\n")).unwrap_or_default();
        // Joint B has no end stops: each run of a long series can turn the link further in the same direction.
        let text =
            format!("[[bench]]\nname = \"{BENCH}\"\n[bench.mock]\njoint = \"b\"\nseed = 4\neffects = []\n{pace}");
        fs::write(&config, text).expect("the bench description is written");
        let log = OpenOptions::new().append(true).create(true).open(self.log()).expect("a log");
        let mut command = jointbench();
        command.args(["serve", "--listen", &self.address.to_string(), "--config"]).arg(&config);
        command.arg("--data").arg(&self.data).arg("--record").arg(self.record.path());
        command.env("JOINTBENCH_TOKEN", TOKEN).stdout(Stdio::piped()).stderr(log);
        if let Some(library) = &self.preload {
            command.env("LD_PRELOAD", library).envs(crate::trouble::slow_sync_settings(self.folder()));
        }
        let mut child = command.spawn().expect("jointbench starts");
        let mut line = String::new();
        let stdout = child.stdout.take().expect("piped");
        let read = BufReader::new(stdout).read_line(&mut line);
        self.server = Some(child);
        assert!(read.is_ok() && line.contains("http://"), "the daemon does not start: {}", self.tail());
        self.wait(STARTS, "the worker", || self.worker().is_some());
        self.last_worker = self.worker();
    }

    fn log(&self) -> PathBuf {
        self.folder().join("server.log")
    }

    /// The last log messages of the daemon.
    pub fn tail(&self) -> String {
        let log = fs::read_to_string(self.log()).unwrap_or_default();
        let lines: Vec<&str> = log.lines().collect();
        lines[lines.len().saturating_sub(30)..].join("\n")
    }

    pub fn server(&self) -> Option<Pid> {
        self.server.as_ref().map(Pid::from_child)
    }

    pub fn worker(&self) -> Option<Pid> {
        worker_of(self.server()?)
    }

    pub fn signal_server(&self, signal: Signal) {
        kill_process(self.server().expect("a server"), signal).expect("the server runs");
    }

    pub fn kill_server(&mut self) {
        self.last_worker = self.worker().or(self.last_worker);
        let mut server = self.server.take().expect("a server");
        server.kill().expect("the server runs");
        server.wait().expect("the server ends");
    }

    /// Returns whether there was one.
    pub fn kill_worker(&self) -> bool {
        self.worker().is_some_and(|worker| kill_process(worker, Signal::KILL).is_ok())
    }

    /// `kill -9` of both, the worker first.
    pub fn kill_both(&mut self) {
        // Stop the server first: it would start another worker.
        self.signal_server(Signal::STOP);
        self.kill_worker();
        self.kill_server();
    }

    /// Sends SIGTERM and returns the time until the end. After `patience` the daemon is killed.
    pub fn terminate(&mut self, patience: Duration) -> Option<Duration> {
        self.signal_server(Signal::TERM);
        let begun = Instant::now();
        let mut server = self.server.take().expect("a server");
        while begun.elapsed() < patience {
            if server.try_wait().expect("the server can be waited for").is_some() {
                return Some(begun.elapsed());
            }
            std::thread::sleep(Duration::from_millis(5));
        }
        server.kill().expect("the server runs");
        server.wait().expect("the server ends");
        None
    }

    /// The traffic of the newest worker.
    pub fn wire(&self) -> Wire {
        let folder = self.record.path().join(BENCH);
        Wire::newest(&folder).expect("a worker has recorded its traffic")
    }

    pub fn bench(&self) -> Value {
        self.client().get(&format!("/bench/{BENCH}"))
    }

    pub fn run(&self, id: i64) -> Value {
        self.client().get(&format!("/runs/{id}"))
    }

    /// Starts a run and returns when the store has it.
    pub fn start_run(&self, procedure: &str) -> i64 {
        let body = json!({ "bench": BENCH, "procedure": procedure, "parameters": {} });
        let outcome = self.client().post("/runs", &body);
        let id = outcome.acknowledged().and_then(|run| run["id"].as_i64());
        id.unwrap_or_else(|| panic!("the run does not start: {outcome:?}\n{}", self.tail()))
    }

    /// Starts a run and returns when the drive is armed and controlled.
    pub fn start_moving(&self, procedure: &str, wire: &mut Wire) -> i64 {
        wire.look();
        wire.commands.clear();
        let id = self.start_run(procedure);
        let until = Instant::now() + Duration::from_secs(30);
        while wire.armed_since().is_none() || wire.control().ticks < 20 {
            assert!(Instant::now() < until, "run {id} does not move\n{}", self.tail());
            std::thread::sleep(Duration::from_millis(20));
            wire.look();
        }
        id
    }

    /// Releases the block and waits until the next run can start.
    pub fn reset(&self) {
        self.wait(Duration::from_secs(60), "the bench to be free", || {
            let bench = self.bench();
            if !bench["blocked"].is_null() {
                let request = Request::post(format!("/bench/{BENCH}/acknowledge"), &json!({ "reason": "fault suite" }));
                self.client().send(&request);
                return false;
            }
            bench["state"] == "idle" && bench["run"].is_null() && bench["unstored"].is_null()
        });
    }

    pub fn wait(&self, within: Duration, what: &str, is_there: impl Fn() -> bool) {
        let until = Instant::now() + within;
        while !is_there() {
            assert!(Instant::now() < until, "waited {within:?} for {what} in vain\n{}", self.tail());
            std::thread::sleep(Duration::from_millis(20));
        }
    }
}

impl Drop for Lab {
    fn drop(&mut self) {
        let worker = self.worker();
        if let Some(server) = &mut self.server {
            // An error means that it has already ended.
            let _ = server.kill();
            let _ = server.wait();
        }
        if let Some(worker) = worker {
            let _ = kill_process(worker, Signal::KILL);
        }
    }
}

/// The process that owns the instruments.
fn worker_of(server: Pid) -> Option<Pid> {
    let parent = format!("PPid:\t{}", server.as_raw_nonzero());
    let processes =
        fs::read_dir("/proc").ok()?.filter_map(|entry| entry.ok()?.file_name().to_str()?.parse::<i32>().ok());
    let mut ours = processes.filter(|process| {
        let status = fs::read_to_string(format!("/proc/{process}/status")).unwrap_or_default();
        let command = fs::read(format!("/proc/{process}/cmdline")).unwrap_or_default();
        status.lines().any(|line| line == parent) && command.split(|byte| *byte == 0).nth(1) == Some(b"worker")
    });
    ours.next().and_then(Pid::from_raw)
}
