//! A daemon for one test, with a free port and a temporary folder, and a client for it.

use crate::specified;
use jointbench::config::{BenchDescription, Notify};
use jointbench::daemon::{Daemon, DaemonSettings, Network};
use jointbench::job::Limits;
use jointbench::lab::LabError;
use jointbench_devices::{Joint, MockSettings};
use serde_json::Value;
use std::path::Path;
use std::time::{Duration, Instant};
use tempfile::TempDir;
use tokio::runtime::Runtime;
use ureq::Agent;

pub const BENCH: &str = "joint-a-mock";
const PATIENCE: Duration = Duration::from_secs(120);

/// A run of a few seconds of bench time.
pub const SHORT_RUN: &str = r#"{"bench": "joint-a-mock", "procedure": "friction", "parameters":
    {"repeats": 2, "load_levels": 1, "fast_speeds": 2, "dwell_s": 0.3, "warm_up_s": 1.0, "top_speed_rad_s": 60.0}}"#;

pub struct TestDaemon {
    daemon: Option<Daemon>,
    pub runtime: Runtime,
    pub data: TempDir,
    agent: Agent,
}

pub fn settings(data: &Path, pace: Option<f64>) -> DaemonSettings {
    let mock = MockSettings { pace, ..MockSettings::new(Joint::JointA, 7) };
    DaemonSettings {
        listen: "127.0.0.1:0".parse().unwrap(),
        data: data.to_owned(),
        token: None,
        read_token: None,
        network: Network::default(),
        benches: vec![BenchDescription::mock(BENCH, mock)],
        notify: Notify::default(),
        archive: None,
        program: env!("CARGO_BIN_EXE_jointbench").into(),
        analysis: Limits::default(),
    }
}

impl TestDaemon {
    pub fn start() -> Self {
        Self::start_with(None, |_| {})
    }

    pub fn start_with(pace: Option<f64>, change: impl FnOnce(&mut DaemonSettings)) -> Self {
        let data = TempDir::new().unwrap();
        let mut settings = settings(data.path(), pace);
        change(&mut settings);
        let runtime = Runtime::new().unwrap();
        let daemon = runtime.block_on(Daemon::start(settings)).unwrap();
        let agent = Agent::new_with_config(Agent::config_builder().http_status_as_error(false).build());
        Self { daemon: Some(daemon), runtime, data, agent }
    }

    pub fn address(&self) -> String {
        self.daemon.as_ref().unwrap().address.to_string()
    }

    pub fn stop(&mut self) {
        if let Some(daemon) = self.daemon.take() {
            self.runtime.block_on(daemon.stop());
        }
    }

    /// Ends the daemon and starts another one with the same data.
    pub fn restart(&mut self, pace: Option<f64>) {
        self.restart_with(pace, |_| {});
    }

    pub fn restart_with(&mut self, pace: Option<f64>, change: impl FnOnce(&mut DaemonSettings)) {
        self.stop();
        let mut settings = settings(self.data.path(), pace);
        change(&mut settings);
        self.daemon = Some(self.runtime.block_on(Daemon::start(settings)).unwrap());
    }

    pub fn get(&self, path: &str) -> (u16, Value) {
        self.get_with(path, &[])
    }

    pub fn get_with(&self, path: &str, headers: &[(&str, &str)]) -> (u16, Value) {
        read("get", path, self.get_raw_with(path, headers))
    }

    pub fn get_raw(&self, path: &str) -> ureq::http::Response<ureq::Body> {
        self.get_raw_with(path, &[])
    }

    pub fn get_raw_with(&self, path: &str, headers: &[(&str, &str)]) -> ureq::http::Response<ureq::Body> {
        let mut request = self.agent.get(self.url(path));
        for (name, value) in headers {
            request = request.header(*name, *value);
        }
        request.call().unwrap()
    }

    pub fn delete(&self, path: &str) -> (u16, Value) {
        self.delete_with(path, &[])
    }

    pub fn delete_with(&self, path: &str, headers: &[(&str, &str)]) -> (u16, Value) {
        let mut request = self.agent.delete(self.url(path));
        for (name, value) in headers {
            request = request.header(*name, *value);
        }
        read("delete", path, request.call().unwrap())
    }

    pub fn post(&self, path: &str, body: &str) -> (u16, Value) {
        self.post_with(path, body.as_bytes(), &[("content-type", "application/json")])
    }

    pub fn post_with(&self, path: &str, body: &[u8], headers: &[(&str, &str)]) -> (u16, Value) {
        read("post", path, self.post_raw(path, body, headers))
    }

    pub fn put_with(&self, path: &str, body: &[u8], headers: &[(&str, &str)]) -> (u16, Value) {
        let mut request = self.agent.put(self.url(path));
        for (name, value) in headers {
            request = request.header(*name, *value);
        }
        read("put", path, request.send(body).unwrap())
    }

    pub fn post_raw(&self, path: &str, body: &[u8], headers: &[(&str, &str)]) -> ureq::http::Response<ureq::Body> {
        let mut request = self.agent.post(self.url(path));
        for (name, value) in headers {
            request = request.header(*name, *value);
        }
        request.send(body).unwrap()
    }

    /// Waits until the run has ended and its safe state is known.
    pub fn wait_for_end(&self, run: i64) -> Value {
        self.wait_for(&format!("/api/v1/runs/{run}"), |run| !run["safe"].is_null())
    }

    pub fn wait_for(&self, path: &str, there: impl Fn(&Value) -> bool) -> Value {
        let began = Instant::now();
        loop {
            let (status, value) = self.get(path);
            assert_eq!(status, 200, "{value}");
            if there(&value) {
                return value;
            }
            assert!(began.elapsed() < PATIENCE, "{path} never came: {value}");
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    fn url(&self, path: &str) -> String {
        format!("http://{}{path}", self.address())
    }
}

impl Drop for TestDaemon {
    fn drop(&mut self) {
        self.stop();
    }
}

fn read(method: &str, path: &str, mut response: ureq::http::Response<ureq::Body>) -> (u16, Value) {
    let status = response.status().as_u16();
    let text = response.body_mut().read_to_string().unwrap();
    let body = serde_json::from_str(&text).unwrap_or(Value::String(text));
    specified::check(method, path, status, &body);
    (status, body)
}

pub fn refused(settings: DaemonSettings) -> LabError {
    match Runtime::new().unwrap().block_on(Daemon::start(settings)) {
        Ok(_) => panic!("the daemon has started"),
        Err(error) => error,
    }
}
