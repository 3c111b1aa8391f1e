//! Who may come in.

use crate::daemon::{BENCH, TestDaemon, refused, settings};
use tempfile::TempDir;

#[test]
fn a_foreign_page_may_neither_change_nor_listen() {
    let daemon = TestDaemon::start();
    let stop = format!("/api/v1/bench/{BENCH}/stop");
    let own = format!("http://{}", daemon.address());
    for (origin, expected) in [("http://evil.example", 403), ("null", 403), (own.as_str(), 200)] {
        let (status, answer) = daemon.post_with(&stop, b"", &[("origin", origin)]);
        assert_eq!(status, expected, "{origin}: {answer}");
        let upgrade = [
            ("origin", origin),
            ("connection", "upgrade"),
            ("upgrade", "websocket"),
            ("sec-websocket-version", "13"),
            ("sec-websocket-key", "dGhlIHNhbXBsZSBub25jZQ=="),
        ];
        if expected == 403 {
            assert_eq!(daemon.get_with("/api/v1/events", &upgrade).0, 403, "{origin}");
        }
    }
}

#[test]
fn beyond_loopback_the_token_opens_the_api() {
    let daemon = TestDaemon::start_with(None, |settings| {
        settings.listen = "0.0.0.0:0".parse().unwrap();
        settings.token = Some("correct horse".into());
        settings.read_token = Some("looking horse".into());
    });
    let (status, problem) = daemon.get("/api/v1/bench");
    assert_eq!((status, problem["type"].as_str()), (401, Some("urn:jointbench:unauthorized")));
    assert_eq!(daemon.get_with("/api/v1/bench", &[("authorization", "Bearer wrong horse")]).0, 401);
    for (token, access, changes) in [("correct horse", "full", 404), ("looking horse", "read", 403)] {
        let bearer = [("authorization", &*format!("Bearer {token}"))];
        assert_eq!(daemon.get_with("/api/v1/health", &bearer).1["access"], access);
        assert_eq!(daemon.post_with("/api/v1/runs/1/pause", b"", &bearer).0, changes, "{token}");
        assert_eq!(daemon.post_with(&format!("/api/v1/bench/{BENCH}/stop"), b"", &bearer).0, 200, "{token}");
    }
}

#[test]
fn a_daemon_that_cannot_start_says_why() {
    let data = TempDir::new().unwrap();
    let mut open = settings(data.path(), None);
    open.listen = "0.0.0.0:0".parse().unwrap();
    let error = refused(open);
    assert!(error.to_string().contains("give a token"), "{error}");

    let running = TestDaemon::start();
    let mut taken = settings(data.path(), None);
    taken.listen = running.address().parse().unwrap();
    let error = refused(taken);
    assert!(error.to_string().contains("is taken"), "{error}");

    let error = refused(settings(running.data.path(), None));
    assert!(error.to_string().contains("in use by another jointbench"), "{error}");

    let file = data.path().join("a-file");
    std::fs::write(&file, "not a folder").unwrap();
    let error = refused(settings(&file, None));
    assert!(error.to_string().contains("cannot be written"), "{error}");
    assert_eq!(error.exit_code(), 2);
}
