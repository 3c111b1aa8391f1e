//! The daemon and moto, each as a program.

use serde_json::{Value, json};
use std::io::{BufRead, BufReader};
use std::net::SocketAddr;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;
use ureq::Agent;

/// Access key and secret key.
pub const KEY: &str = "KEY4jointbench";
const PATIENCE: Duration = Duration::from_secs(120);

fn agent() -> Agent {
    Agent::new_with_config(Agent::config_builder().http_status_as_error(false).build())
}

pub struct Moto {
    child: Child,
    endpoint: SocketAddr,
}

impl Moto {
    pub fn start(endpoint: SocketAddr) -> Self {
        let program = std::env::var("JOINTBENCH_MOTO").unwrap_or_else(|_| "moto_server".to_owned());
        let mut command = Command::new(&program);
        let command = command.args(["-H", "127.0.0.1", "-p", &endpoint.port().to_string()]);
        let child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn();
        let child = child.unwrap_or_else(|fault| panic!("{program}: {fault}. Install it: pip install 'moto[server]'"));
        let began = Instant::now();
        while agent().get(format!("http://{endpoint}/")).call().is_err() {
            assert!(began.elapsed() < PATIENCE, "moto does not answer");
            std::thread::sleep(Duration::from_millis(50));
        }
        Self { child, endpoint }
    }

    pub fn get(&self, object: &str) -> Vec<u8> {
        let mut found = agent().get(format!("http://{}/{object}", self.endpoint)).call().unwrap();
        assert_eq!(found.status(), 200, "{object}");
        found.body_mut().read_to_vec().unwrap()
    }

    pub fn put(&self, object: &str, content: &str) {
        let put = agent().put(format!("http://{}/{object}", self.endpoint)).header("x-amz-acl", "public-read");
        let made = put.send(content).unwrap();
        assert_eq!(made.status(), 200, "{object}");
    }
}

impl Drop for Moto {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

pub struct Service {
    child: Option<Child>,
    base: String,
    folder: TempDir,
}

impl Service {
    pub fn start(archive: &str, endpoint: SocketAddr) -> Self {
        let folder = TempDir::new().unwrap();
        let config = folder.path().join("bench.toml");
        std::fs::write(&config, format!("[[bench]]\nname = \"a\"\nmock.joint = \"a\"\n{archive}")).unwrap();
        let log = std::fs::File::create(folder.path().join("log")).unwrap();
        let mut child = Command::new(env!("CARGO_BIN_EXE_jointbench"))
            .args(["serve", "--listen", "127.0.0.1:0", "--data"])
            .arg(folder.path().join("data"))
            .arg("--config")
            .arg(config)
            .envs([("AWS_ACCESS_KEY_ID", KEY), ("AWS_SECRET_ACCESS_KEY", KEY), ("AWS_REGION", "eu-central-1")])
            .envs([("AWS_ENDPOINT_URL", &*format!("http://{endpoint}")), ("AWS_ALLOW_HTTP", "true")])
            .env("AWS_TIMEOUT", "2 seconds")
            .stdout(Stdio::piped())
            .stderr(log)
            .spawn()
            .unwrap();
        let mut line = String::new();
        BufReader::new(child.stdout.take().unwrap()).read_line(&mut line).unwrap();
        let base = line.split_whitespace().find(|word| word.starts_with("http://")).expect(&line);
        Self { child: Some(child), base: base.trim_end_matches('/').to_owned(), folder }
    }

    /// A complete run of a few seconds of bench time, at the pace of the simulation.
    pub fn run(&self) -> i64 {
        let parameters = json!({"repeats": 2, "load_levels": 1, "fast_speeds": 2, "dwell_s": 0.3, "warm_up_s": 1.0,
            "top_speed_rad_s": 60.0});
        let unit = json!({"serial": "SN7", "part": "JT/1", "batch": "B 7"});
        let new = json!({"bench": "a", "procedure": "friction", "parameters": parameters, "unit": unit});
        let mut run = agent().post(self.url("runs")).send_json(new).unwrap();
        assert_eq!(run.status(), 201);
        let id = run.body_mut().read_json::<Value>().unwrap()["id"].as_i64().unwrap();
        let ended = self.wait_for(&format!("runs/{id}"), |run| !run["safe"].is_null());
        assert_eq!(ended["state"], "completed", "{ended}");
        id
    }

    pub fn retry(&self) {
        assert_eq!(agent().post(self.url("archive/retry")).send_empty().unwrap().status(), 200);
    }

    pub fn delete(&self, path: &str) -> u16 {
        agent().delete(self.url(path)).call().unwrap().status().as_u16()
    }

    pub fn get_bytes(&self, path: &str) -> Vec<u8> {
        agent().get(self.url(path)).call().unwrap().body_mut().read_to_vec().unwrap()
    }

    fn get(&self, path: &str) -> Value {
        serde_json::from_slice(&self.get_bytes(path)).unwrap()
    }

    pub fn wait_for(&self, path: &str, there: impl Fn(&Value) -> bool) -> Value {
        let began = Instant::now();
        loop {
            let value = self.get(path);
            if there(&value) {
                return value;
            }
            assert!(began.elapsed() < PATIENCE, "{path} never came: {value}");
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    /// The entry of the run for one table.
    pub fn table(&self, run: i64, content: &str) -> Value {
        let run = self.get(&format!("runs/{run}"));
        let tables = run["archive"].as_array().unwrap_or_else(|| panic!("{run}"));
        tables.iter().find(|table| table["content"] == content).unwrap().clone()
    }

    fn url(&self, path: &str) -> String {
        format!("{}/api/v1/{path}", self.base)
    }

    /// Ends the daemon, and returns its log.
    pub fn stop(&mut self) -> String {
        if let Some(mut child) = self.child.take() {
            child.kill().unwrap();
            child.wait().unwrap();
        }
        std::fs::read_to_string(self.folder.path().join("log")).unwrap()
    }
}

impl Drop for Service {
    fn drop(&mut self) {
        self.stop();
    }
}
