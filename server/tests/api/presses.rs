//! A request that has arrived is executed, even if its client disconnects.

use crate::daemon::{BENCH, TestDaemon};
use serde_json::Value;
use socket2::SockRef;
use std::io::Write;
use std::net::TcpStream;
use std::time::Duration;

const PRESSES: usize = 60;

/// Sends a request and disconnects, with RST if `abruptly`.
fn send_and_leave(daemon: &TestDaemon, path: &str, body: &str, abruptly: bool) {
    let host = daemon.address();
    let mut wire = TcpStream::connect(&host).unwrap();
    let length = body.len();
    let head = format!("POST {path} HTTP/1.1\r\nhost: {host}\r\ncontent-type: application/json\r\n");
    wire.write_all(format!("{head}content-length: {length}\r\n\r\n{body}").as_bytes()).unwrap();
    if abruptly {
        SockRef::from(&wire).set_linger(Some(Duration::ZERO)).unwrap();
    }
}

/// Whether the last entry is a software stop.
fn is_stopped(safety: &Value) -> bool {
    safety[0]["stopped"] == true && safety[0]["blocked"] == true
}

#[test]
fn a_stop_is_executed_if_its_client_disconnects() {
    let daemon = TestDaemon::start();
    let bench = format!("/api/v1/bench/{BENCH}");
    for press in 1..=PRESSES {
        send_and_leave(&daemon, &format!("{bench}/stop"), "", press % 2 == 0);
        daemon.wait_for(&format!("{bench}/safety"), is_stopped);
        daemon.wait_for(&bench, |bench| bench["state"] == "stopped");
        let (status, problem) = daemon.post(&format!("{bench}/acknowledge"), r#"{"reason": "tried"}"#);
        assert_eq!(status, 200, "{problem}");
    }
}

#[test]
fn what_a_client_wanted_changed_before_it_left_is_changed_whole() {
    let daemon = TestDaemon::start();
    for made in 0..20 {
        let body = format!(r#"{{"name": "screen {made}", "access": "read"}}"#);
        send_and_leave(&daemon, "/api/v1/tokens", &body, made % 2 == 0);
    }
    let tokens = daemon.wait_for("/api/v1/tokens", |tokens| tokens.as_array().unwrap().len() == 20);
    assert!(tokens.as_array().unwrap().iter().all(|token| token["id"].is_i64()), "{tokens}");
}
