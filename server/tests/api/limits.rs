//! Limits of one client, and service for the others.

use crate::daemon::{BENCH, TestDaemon};
use jointbench::listener::Limits;
use std::io::{ErrorKind, Read, Write};
use std::net::TcpStream;
use std::time::Duration;

const STOP: &str = "/api/v1/bench/joint-a-mock/stop";
const PATIENCE: Duration = Duration::from_secs(60);

fn with_limits(limits: Limits) -> TestDaemon {
    TestDaemon::start_with(None, |settings| settings.network.limits = limits)
}

fn begin(daemon: &TestDaemon, bytes: &str) -> TcpStream {
    let mut wire = TcpStream::connect(daemon.address()).unwrap();
    wire.set_read_timeout(Some(PATIENCE)).unwrap();
    wire.write_all(bytes.as_bytes()).unwrap();
    wire
}

/// Reads until the daemon closes the connection.
fn rest(mut wire: TcpStream) -> String {
    let (mut bytes, mut piece) = (Vec::new(), [0; 65_536]);
    loop {
        match wire.read(&mut piece) {
            Ok(0) => break,
            Ok(count) => bytes.extend_from_slice(&piece[..count]),
            Err(fault) if fault.kind() == ErrorKind::ConnectionReset => break,
            Err(fault) => panic!("the daemon has not hung up: {fault}"),
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

fn vital(daemon: &TestDaemon) {
    assert_eq!(status(daemon, "GET /api/v1/health"), "200");
    assert_eq!(status(daemon, &format!("POST {STOP}")), "200");
}

/// Uses a new connection: an idle one may have been closed in favour of others.
fn status(daemon: &TestDaemon, asked: &str) -> String {
    let request = format!("{asked} HTTP/1.1\r\nhost: 127.0.0.1\r\nconnection: close\r\ncontent-length: 0\r\n\r\n");
    let answer = rest(begin(daemon, &request));
    answer.split(' ').nth(1).unwrap_or("nothing").to_owned()
}

/// An incomplete request.
const HALF_HEAD: &str = "GET /api/v1/runs HTTP/1.1\r\nhost: 127.0.0.1\r\nx-slow: ";
const HALF_BODY: &str =
    "POST /api/v1/runs HTTP/1.1\r\nhost: 127.0.0.1\r\ncontent-type: application/json\r\ncontent-length: 90\r\n\r\n{";

#[test]
fn stalled_clients_do_not_block_others() {
    let daemon = TestDaemon::start();
    let most = Limits::default().connections;
    // More connections than seats, of every kind: silent, in the head, in the body.
    for stalled in ["", HALF_HEAD, HALF_BODY] {
        let _stalled: Vec<TcpStream> = (0..most + 20).map(|_| begin(&daemon, stalled)).collect();
        vital(&daemon);
        assert_eq!(status(&daemon, "GET /api/v1/bench"), "200", "{stalled:?}");
    }
}

#[test]
fn a_client_that_is_too_slow_is_cut_off() {
    let short = Duration::from_millis(400);
    let limits = Limits { head: short, idle: short, body_pause: short, write_stall: short, ..Limits::default() };
    let daemon = with_limits(limits);
    assert_eq!(rest(begin(&daemon, "")), "");
    assert_eq!(rest(begin(&daemon, HALF_HEAD)), "");
    let answered = rest(begin(&daemon, "GET /api/v1/health HTTP/1.1\r\nhost: 127.0.0.1\r\n\r\n"));
    assert!(answered.starts_with("HTTP/1.1 200"), "{answered}");
    let refused = rest(begin(&daemon, HALF_BODY));
    assert!(refused.starts_with("HTTP/1.1 400"), "{refused}");

    // This client sends requests and never reads: the answers exceed the buffers of the system.
    let mut deaf = begin(&daemon, "");
    let again = "GET /api/v1/openapi.json HTTP/1.1\r\nhost: 127.0.0.1\r\n\r\n".repeat(100);
    deaf.set_write_timeout(Some(PATIENCE)).unwrap();
    let cut = (0..1000).find_map(|_| deaf.write_all(again.as_bytes()).err()).expect("the daemon hangs up");
    assert!(matches!(cut.kind(), ErrorKind::BrokenPipe | ErrorKind::ConnectionReset), "{cut}");
    vital(&daemon);
}

#[test]
fn a_body_that_drips_has_an_end() {
    let (pause, total) = (Duration::from_secs(30), Duration::from_millis(600));
    let daemon = with_limits(Limits { body_pause: pause, body_total: total, ..Limits::default() });
    let mut wire = begin(&daemon, HALF_BODY);
    let mut dripping = wire.try_clone().unwrap();
    let drip = std::thread::spawn(move || {
        while dripping.write_all(b" ").is_ok() {
            std::thread::sleep(Duration::from_millis(50));
        }
    });
    let mut answer = [0; 12];
    wire.read_exact(&mut answer).unwrap();
    assert_eq!(&answer, b"HTTP/1.1 400");
    drop(rest(wire));
    drip.join().unwrap();
}

#[test]
fn health_and_stop_are_answered_when_every_ordinary_connection_is_taken() {
    let daemon = with_limits(Limits { connections: 8, reserved: 2, ..Limits::default() });
    let events = format!("ws://{}/api/v1/events", daemon.address());
    let streams: Vec<_> = (0..6).map(|_| tungstenite::connect(&events).unwrap().0).collect();
    let mut full = daemon.get_raw("/api/v1/bench");
    assert_eq!(full.status().as_u16(), 503, "{}", full.body_mut().read_to_string().unwrap());
    assert_eq!(full.headers()["retry-after"], "1");
    vital(&daemon);
    drop(streams);
    // The daemon detects the disconnection with a small delay.
    let asked = format!("GET /api/v1/bench/{BENCH}/safety");
    let again = || {
        std::thread::sleep(Duration::from_millis(10));
        status(&daemon, &asked) == "200"
    };
    assert!((0..1000).any(|_| again()), "a seat that was left is free again");
}

#[test]
fn only_so_many_files_come_in_at_once() {
    let daemon = TestDaemon::start();
    let half = "POST /api/v1/runs/import HTTP/1.1\r\nhost: 127.0.0.1\r\ncontent-type: multipart/form-data; boundary=e\r\ncontent-length: 9000\r\n\r\n--e\r\n";
    let more =
        || daemon.post_raw("/api/v1/runs/import", b"--e--", &[("content-type", "multipart/form-data; boundary=e")]);
    // A slow upload that arrives during a quick one may be refused, so that another one follows.
    let mut slow = Vec::new();
    let answer = |_| {
        slow.push(begin(&daemon, half));
        more()
    };
    let busy = (0..500).map(answer).find(|answer| answer.status().as_u16() == 503).expect("the third waits");
    assert_eq!(busy.headers()["retry-after"], "1");
    drop(slow);
    let free = (0..500).map(|_| more()).find(|answer| answer.status().as_u16() != 503);
    assert_eq!(free.map(|answer| answer.status().as_u16()), Some(400), "the part `file` is missing");
}

#[test]
fn sizes_are_bounded_by_route() {
    let daemon = TestDaemon::start();
    let head = format!("GET /api/v1/health HTTP/1.1\r\nhost: 127.0.0.1\r\nx-long: {}\r\n", "x".repeat(40 << 10));
    assert!(rest(begin(&daemon, &head)).starts_with("HTTP/1.1 431"));
    let json = [("content-type", "application/json")];
    let table = format!(r#"{{"head": ["a"], "rows": [["{}"]]}}"#, "x".repeat(2 << 20));
    assert_eq!(daemon.post_raw("/api/v1/tables?format=csv", table.as_bytes(), &json).status().as_u16(), 200);
    let table = vec![b' '; 9 << 20];
    assert_eq!(daemon.post_raw("/api/v1/tables?format=csv", &table, &json).status().as_u16(), 413);
}

#[test]
fn who_is_not_let_in_is_refused_before_the_body_is_sent() {
    let daemon = TestDaemon::start_with(None, |settings| settings.token = Some(crate::auth::FULL.into()));
    let asking = "POST /api/v1/runs/import HTTP/1.1\r\nhost: 127.0.0.1\r\nexpect: 100-continue\r\ncontent-length: 900000000\r\n\r\n";
    let answer = rest(begin(&daemon, asking));
    assert!(answer.starts_with("HTTP/1.1 401"), "{answer}");
}
