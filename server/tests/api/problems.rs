//! Every refusal is a problem document with a remedy.

use crate::daemon::TestDaemon;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::thread::sleep;
use std::time::Duration;

#[test]
fn every_refusal_is_a_problem_document() {
    let daemon = TestDaemon::start();
    let started = |body: &str| daemon.post("/api/v1/runs", body);
    for (answer, status, kind, expected) in [
        (daemon.get("/api/v1/runs/99"), 404, "not_found", "run 99 does not exist"),
        (daemon.get("/api/v1/models/99"), 404, "not_found", "model version 99 does not exist"),
        (daemon.get("/api/v1/bench/attic"), 404, "not_found", "bench attic does not exist"),
        (daemon.get("/api/v1/nothing"), 404, "not_found", "openapi.json"),
        (daemon.get("/api"), 404, "not_found", "openapi.json"),
        (daemon.get("/api/v1/runs/one"), 400, "malformed", "one"),
        (daemon.get("/api/v1/runs?limit=many"), 400, "malformed", "limit"),
        (daemon.get("/api/v1/runs?sort=-temp"), 422, "invalid", "to sort by: choose started, state"),
        (daemon.get("/api/v1/effects?kind=belt"), 422, "invalid", "friction, encoder"),
        (started("{"), 400, "malformed", "JSON"),
        (started(r#"{"bench": "joint-a-mock"}"#), 400, "malformed", "procedure"),
        (started(r#"{"bench": "joint-a-mock", "procedure": "dance"}"#), 404, "not_found", "available: friction"),
        (
            started(r#"{"bench": "joint-a-mock", "procedure": "friction", "parameters": {"repeats": 0}}"#),
            422,
            "invalid",
            "parameter repeats = 0",
        ),
        (
            started(r#"{"bench": "joint-a-mock", "procedure": "friction", "parameters": {"top_speed_rad_s": 900}}"#),
            422,
            "invalid",
            "motor velocity",
        ),
        (
            daemon.post("/api/v1/bench/joint-a-mock/acknowledge", r#"{"reason": "looked"}"#),
            409,
            "conflict",
            "not blocked",
        ),
        (daemon.post("/api/v1/runs/1", "{}"), 405, "not_allowed", "POST is not available"),
        (daemon.post("/api/v1/runs", &"x".repeat(2 << 20)), 413, "too_large", "exceeds the limit of 1048576 bytes"),
    ] {
        let (found, problem) = answer;
        assert_eq!(found, status, "{problem}");
        assert_eq!(problem["type"], format!("urn:jointbench:{kind}"), "{problem}");
        assert_eq!(problem["status"], status);
        assert!(problem["instance"].as_str().is_some_and(|path| path.starts_with("/api")), "{problem}");
        let detail = problem["detail"].as_str().unwrap();
        assert!(detail.contains(expected), "{expected:?} in {detail:?}");
    }
}

/// A client reuses its connection: the rest of a refused request must not close it.
#[test]
fn a_refusal_leaves_the_connection_open() {
    let daemon = TestDaemon::start();
    let host = daemon.address();
    let mut wire = TcpStream::connect(&host).unwrap();
    wire.set_read_timeout(Some(Duration::from_secs(20))).unwrap();
    let mut answers = BufReader::new(wire.try_clone().unwrap());
    for (path, origin, status) in [
        ("nothing", &*host, "404"),
        ("health", &*host, "405"),
        ("runs/one/notes", &*host, "400"),
        ("runs", "evil.example", "403"),
        ("runs", &*host, "400"),
    ] {
        write!(wire, "POST /api/v1/{path} HTTP/1.1\r\nhost: {host}\r\norigin: http://{origin}\r\n").unwrap();
        write!(wire, "content-type: application/json\r\ncontent-length: 2\r\n\r\n").unwrap();
        sleep(Duration::from_millis(50));
        wire.write_all(b"{}").unwrap();
        let head: Vec<String> =
            answers.by_ref().lines().map(Result::unwrap).take_while(|line| !line.is_empty()).collect();
        assert_eq!(head.first().and_then(|line| line.split(' ').nth(1)), Some(status), "{path} {head:?}");
        let length = head.iter().find_map(|line| line.strip_prefix("content-length: ")).unwrap();
        answers.read_exact(&mut vec![0; length.parse().unwrap()]).unwrap();
    }
}

#[test]
fn the_dashboard_answers_every_other_address() {
    let daemon = TestDaemon::start();
    let mut page = daemon.get_raw("/workbench/1");
    let html = page.body_mut().read_to_string().unwrap();
    assert_eq!(page.status().as_u16(), 200);
    assert!(header(&page, "content-type").unwrap().starts_with("text/html"));
    assert!(header(&page, "content-security-policy").unwrap().contains("default-src 'none'"));
    let etag = header(&page, "etag").unwrap();
    assert_eq!(daemon.get_with("/", &[("if-none-match", &etag)]).0, 304);
    assert_eq!(daemon.get("/assets/none.js").0, 404);

    let Some(style) = html.split('"').find(|part| part.starts_with("/assets/") && part.ends_with(".css")) else {
        return println!("skipped: {}", jointbench_ui::missing().expect("the page names its style"));
    };
    let (plain, packed) = (daemon.get_raw(style), daemon.get_raw_with(style, &[("accept-encoding", "gzip")]));
    assert_eq!([&plain, &packed].map(|answer| header(answer, "content-encoding")), [None, Some("gzip".to_owned())]);
    assert_eq!([&plain, &packed].map(|answer| header(answer, "vary").is_some()), [true, true]);
    assert_eq!(header(&plain, "etag"), header(&packed, "etag"));
    let [plain, packed] = [plain, packed].map(|answer| answer.into_body().read_to_vec().unwrap().len());
    assert!(packed > 0 && 2 * packed < plain, "{packed} of {plain} bytes");
}

fn header(answer: &ureq::http::Response<ureq::Body>, name: &str) -> Option<String> {
    answer.headers().get(name).map(|value| value.to_str().unwrap().to_owned())
}
