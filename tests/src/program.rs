//! The real program `jointbench`.

use crate::root;
use std::collections::VecDeque;
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::sync::{Arc, LazyLock, Mutex};
use std::time::{Duration, Instant};

/// Built once for each test run, with the profile of the tests, unless `JOINTBENCH_PROGRAM` names an executable.
static PROGRAM: LazyLock<PathBuf> = LazyLock::new(|| {
    if let Some(given) = std::env::var_os("JOINTBENCH_PROGRAM") {
        return given.into();
    }
    let here = std::env::current_exe().expect("the test binary has a path");
    let folder = here.parent().expect("target/PROFILE/deps, or target/PROFILE");
    let is_test = folder.ends_with("deps");
    let profile = if is_test { folder.parent().expect("target/PROFILE") } else { folder };
    let mut build = Command::new(env!("CARGO"));
    build.args(["build", "--quiet", "--workspace", "--bin", "jointbench"]).current_dir(root());
    if is_test {
        // With a test among the targets the libraries have the same features as in `cargo test`, which has built them.
        build.args(["--test", "suite"]);
    }
    build.env("CARGO_TARGET_DIR", profile.parent().expect("target"));
    if profile.ends_with("release") {
        build.arg("--release");
    }
    assert!(build.status().expect("cargo runs").success(), "jointbench does not build");
    profile.join(format!("jointbench{}", std::env::consts::EXE_SUFFIX))
});

pub fn jointbench() -> Command {
    let mut command = Command::new(&*PROGRAM);
    command
        .env_remove("JOINTBENCH_DATA")
        .env_remove("JOINTBENCH_TOKEN")
        .env_remove("JOINTBENCH_URL")
        .env_remove("RUST_LOG");
    command
}

pub fn run(arguments: &[&str]) -> Output {
    jointbench().args(arguments).output().expect("jointbench starts")
}

pub fn stdout(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

pub fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Lines of a daemon's log that are kept for the message of a failed test.
const LOG_LINES: usize = 200;

/// A daemon in a separate process, on a free port. Killed on drop.
pub struct Daemon {
    child: Child,
    pub base: String,
    log: Arc<Mutex<VecDeque<String>>>,
}

impl Daemon {
    /// Returns when the daemon has printed its address.
    pub fn serve(data: &Path, config: &Path) -> Self {
        Self::start(jointbench(), data, config)
    }

    /// The same with a limit of the address space in KiB, which also applies to its child processes.
    #[cfg(unix)]
    pub fn serve_within(address_space_kib: u64, data: &Path, config: &Path) -> Self {
        let mut shell = Command::new("sh");
        let limited = format!("ulimit -v {address_space_kib}; exec \"$0\" \"$@\"");
        shell.args(["-c", &limited]).arg(&*PROGRAM);
        Self::start(shell, data, config)
    }

    fn start(mut command: Command, data: &Path, config: &Path) -> Self {
        let mut child = command
            .args(["serve", "--listen", "127.0.0.1:0", "--data"])
            .arg(data)
            .arg("--config")
            .arg(config)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("jointbench starts");
        let mut output = BufReader::new(child.stdout.take().expect("piped"));
        let mut line = String::new();
        output.read_line(&mut line).expect("stdout can be read");
        let base = line
            .split_whitespace()
            .find(|word| word.starts_with("http://"))
            .map(|word| word.trim_end_matches('/').to_owned());
        let Some(base) = base else {
            let mut complaint = String::new();
            child.stderr.take().expect("piped").read_to_string(&mut complaint).ok();
            panic!("the daemon did not name its address: {line:?} {complaint}");
        };
        // Reads all output, so that the daemon does not block on a full pipe.
        let errors = BufReader::new(child.stderr.take().expect("piped"));
        let log = Arc::<Mutex<VecDeque<String>>>::default();
        let kept = log.clone();
        std::thread::spawn(move || std::io::copy(&mut output, &mut std::io::sink()));
        std::thread::spawn(move || {
            for line in errors.lines().map_while(Result::ok) {
                let mut kept = kept.lock().expect("no reader panics");
                kept.push_back(line);
                if kept.len() > LOG_LINES {
                    kept.pop_front();
                }
            }
        });
        Self { child, base, log }
    }

    /// The last lines of its log.
    pub fn log(&self) -> String {
        self.log.lock().expect("no writer panics").iter().map(|line| format!("{line}\n")).collect()
    }

    /// `kill -9`: the daemon runs no cleanup.
    pub fn kill(mut self) {
        self.child.kill().expect("the daemon runs");
        self.child.wait().expect("the daemon ends");
    }

    /// Sends SIGTERM, as a service manager does, and waits for the end.
    #[cfg(unix)]
    pub fn terminate(mut self) -> Duration {
        let asked = Instant::now();
        let process = self.child.id().to_string();
        assert!(Command::new("kill").args(["-TERM", &process]).status().expect("kill runs").success());
        self.child.wait().expect("the daemon ends");
        asked.elapsed()
    }

    pub fn process(&self) -> u32 {
        self.child.id()
    }

    pub fn get(&self, path: &str) -> serde_json::Value {
        serde_json::from_str(&self.get_text(path)).expect("JSON")
    }

    pub fn get_text(&self, path: &str) -> String {
        let mut answer = ureq::get(format!("{}/api/v1{path}", self.base))
            .call()
            .unwrap_or_else(|fault| panic!("GET {path}: {fault}"));
        answer.body_mut().with_config().limit(1 << 30).read_to_string().expect("text")
    }

    /// Status and body, for any status.
    pub fn post(&self, path: &str, body: &serde_json::Value) -> (u16, serde_json::Value) {
        let agent = ureq::Agent::new_with_config(ureq::Agent::config_builder().http_status_as_error(false).build());
        let mut answer = agent.post(format!("{}/api/v1{path}", self.base)).send_json(body).expect("the daemon answers");
        (answer.status().as_u16(), answer.body_mut().read_json().unwrap_or_default())
    }

    /// Repeats the request until the answer meets the condition.
    pub fn wait_for(
        &self,
        path: &str,
        within: Duration,
        is_there: impl Fn(&serde_json::Value) -> bool,
    ) -> serde_json::Value {
        let until = Instant::now() + within;
        loop {
            let answer = self.get(path);
            if is_there(&answer) {
                return answer;
            }
            assert!(Instant::now() < until, "GET {path} still answers {answer} after {within:?}");
            std::thread::sleep(Duration::from_millis(50));
        }
    }
}

impl Drop for Daemon {
    fn drop(&mut self) {
        self.child.kill().ok();
        self.child.wait().ok();
    }
}
