//! A daemon in an address space of 1 GiB, and clients that request more memory.

use super::bench;
use crate::program::Daemon;
use serde_json::{Value, json};
use std::io::{Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

mod bombs;

const GIB_IN_KIB: u64 = 1 << 20;
/// Rows of a run with a slow diagnosis, so that many requests wait.
const ROWS: usize = 2_000_000;
const READERS: usize = 200;
const DIAGNOSES: usize = 50;
const EXPORTS: usize = 8;
/// Time limit of a client, without a second attempt.
const PATIENCE: Duration = Duration::from_secs(20);

fn limited(folder: &Path) -> Daemon {
    Daemon::serve_within(GIB_IN_KIB, &folder.join("data"), &bench(folder, "b", 20.0))
}

fn agent(patience: Duration) -> ureq::Agent {
    let config = ureq::Agent::config_builder().http_status_as_error(false).timeout_global(Some(patience));
    ureq::Agent::new_with_config(config.build())
}

/// Status and body of an upload.
fn upload(daemon: &Daemon, name: &str, file: &[u8]) -> (u16, Value) {
    let head = |part: &str| format!("--edge\r\nContent-Disposition: form-data; name={part}\r\n\r\n");
    let mut body = head(&format!("\"file\"; filename=\"{name}\"")).into_bytes();
    body.extend_from_slice(file);
    body.extend_from_slice(b"\r\n");
    let meta = r#"{"kind": "friction", "torque_constant_nm_per_a": 0.064, "gear_ratio": 50}"#;
    body.extend_from_slice(format!("{}{meta}\r\n--edge--\r\n", head("\"meta\"")).as_bytes());
    let request = agent(Duration::from_secs(300)).post(format!("{}/api/v1/runs/import", daemon.base));
    let request = request.header("content-type", "multipart/form-data; boundary=edge");
    let mut answer = request.send(&body[..]).expect("the daemon answers");
    (answer.status().as_u16(), answer.body_mut().read_json().unwrap_or_default())
}

/// The same process answers, and no uploaded file remains.
fn is_well(daemon: &Daemon, data: &Path, after: &str) {
    assert_eq!(daemon.get("/health")["process"], daemon.process(), "after {after}");
    let left = std::fs::read_dir(data.join("uploads")).expect("the folder is there").count();
    assert_eq!(left, 0, "files of uploads are left after {after}");
}

#[test]
fn bombs_do_not_end_a_daemon_of_1_gib() {
    let folder = tempfile::tempdir().expect("a folder");
    let data = folder.path().join("data");
    let daemon = limited(folder.path());
    for (what, name, file, why) in [
        ("a gzip bomb", "run.csv.gz", bombs::gzip(), "times its size"),
        ("a Parquet bomb", "run.parquet", bombs::parquet(), "GiB of memory"),
        ("an Arrow file that says it is huge", "run.arrow", bombs::arrow(), "unpacks to more than"),
    ] {
        let (status, problem) = upload(&daemon, name, &file);
        assert!(status == 422 || status == 413, "{what}: {status} {problem}");
        assert!(problem["detail"].as_str().is_some_and(|detail| detail.contains(why)), "{what}: {problem}");
        is_well(&daemon, &data, what);
    }
    let deep = "[".repeat(900_000);
    for path in ["/models", "/models/import", "/effects/check", "/tables?format=csv"] {
        let request = agent(Duration::from_secs(60)).post(format!("{}/api/v1{path}", daemon.base));
        let answer = request.header("content-type", "application/json").send(&deep).expect("the daemon answers");
        assert_eq!(answer.status(), 400, "{path}");
    }
    is_well(&daemon, &data, "JSON that is nested deeply");
    assert_eq!(daemon.get("/runs")["total"], 0, "nothing was taken in");
}

#[test]
fn many_large_requests_do_not_stop_the_daemon() {
    let folder = tempfile::tempdir().expect("a folder");
    let data = folder.path().join("data");
    let daemon = limited(folder.path());
    let (status, run) = upload(&daemon, "run.csv", &bombs::long_run(ROWS));
    assert_eq!((status, run["rows"].as_u64()), (201, Some(ROWS as u64)), "{run}");
    let run = run["id"].as_i64().expect("the run has a number");

    let idle: Vec<TcpStream> = (0..READERS).map(|_| deaf_reader(&daemon)).collect();
    is_well(&daemon, &data, "many readers who never read");
    std::thread::scope(|scope| {
        for _ in 0..EXPORTS {
            scope.spawn(|| {
                let asked = agent(PATIENCE).get(format!("{}/api/v1/runs/{run}/export?format=csv", daemon.base));
                // Some requests wait for others and may exceed their time limit.
                asked
                    .call()
                    .ok()
                    .map(|answer| std::io::copy(&mut answer.into_body().into_reader(), &mut std::io::sink()))
            });
        }
    });
    is_well(&daemon, &data, "exports beside each other");
    drop(idle);

    let asked = json!({"run": run, "effects": ["coulomb", "viscous"]}).to_string();
    std::thread::scope(|scope| {
        for _ in 0..DIAGNOSES {
            scope.spawn(|| {
                let request = agent(PATIENCE).post(format!("{}/api/v1/models", daemon.base));
                let Ok(mut answer) = request.header("content-type", "application/json").send(&asked) else { return };
                let problem: Value = answer.body_mut().read_json().unwrap_or_default();
                let status = answer.status().as_u16();
                assert!([201, 413, 503].contains(&status), "{status} {problem}");
            });
        }
    });
    is_well(&daemon, &data, "diagnoses beside each other");
    let took = daemon.terminate();
    assert!(took < Duration::from_secs(10), "it took {took:?} to end");
}

/// Opens the live stream and never reads from it.
fn deaf_reader(daemon: &Daemon) -> TcpStream {
    let address = daemon.base.trim_start_matches("http://");
    let mut stream = TcpStream::connect(address).expect("the daemon listens");
    let request = format!(
        "GET /api/v1/events HTTP/1.1\r\nHost: {address}\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n\
         Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n"
    );
    stream.write_all(request.as_bytes()).expect("the daemon reads");
    let mut begin = [0; 12];
    stream.read_exact(&mut begin).expect("the daemon answers");
    assert_eq!(&begin, b"HTTP/1.1 101");
    stream
}
