//! Access with tokens.

use crate::daemon::{BENCH, SHORT_RUN, TestDaemon, refused, settings};
use jointbench::listener::TlsFiles;
use serde_json::Value;
use tempfile::TempDir;

pub const FULL: &str = "correct horse battery";
pub const READS: &str = "looking horse battery";

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

fn page(daemon: &TestDaemon) -> String {
    daemon.get_raw("/").body_mut().read_to_string().unwrap()
}

#[test]
fn beyond_loopback_the_token_opens_the_api() {
    let daemon = TestDaemon::start_with(None, |settings| {
        settings.listen = "0.0.0.0:0".parse().unwrap();
        settings.network.behind_proxy = true;
        settings.token = Some(FULL.into());
        settings.read_token = Some(READS.into());
    });
    assert!(page(&daemon).contains("data-token"), "the page asks for a token before it is refused");
    let (status, problem) = daemon.get("/api/v1/bench");
    assert_eq!((status, problem["type"].as_str()), (401, Some("urn:jointbench:unauthorized")));
    assert_eq!(daemon.get_with("/api/v1/bench", &[("authorization", "Bearer wrong horse battery")]).0, 401);
    for (token, access, changes) in [(FULL, "full", 404), (READS, "read", 403)] {
        let bearer = [("authorization", &*format!("Bearer {token}"))];
        assert_eq!(daemon.get_with("/api/v1/health", &bearer).1["access"], access);
        assert_eq!(daemon.post_with("/api/v1/runs/1/pause", b"", &bearer).0, changes, "{token}");
        assert_eq!(daemon.post_with(&format!("/api/v1/bench/{BENCH}/stop"), b"", &bearer).0, 200, "{token}");
    }
}

#[test]
fn tokens_are_managed_with_full_access_and_no_user_is_locked_out() {
    let data = TempDir::new().unwrap();
    let daemon = || {
        TestDaemon::start_with(None, |settings| {
            settings.data = data.path().to_owned();
            settings.token = Some(FULL.into());
            settings.read_token = Some(READS.into());
        })
    };
    let mut first = daemon();
    let bearer = |secret: &str| format!("Bearer {secret}");
    let make = |daemon: &TestDaemon, with: &str, body: &str| {
        let headers = [("authorization", &*bearer(with)), ("content-type", "application/json")];
        daemon.post_with("/api/v1/tokens", body.as_bytes(), &headers)
    };
    let list =
        |daemon: &TestDaemon, with: &str| daemon.get_with("/api/v1/tokens", &[("authorization", &*bearer(with))]);
    let revoke = |daemon: &TestDaemon, with: &str, id: &Value| {
        daemon.delete_with(&format!("/api/v1/tokens/{id}"), &[("authorization", &*bearer(with))])
    };
    let (status, anna) = make(&first, FULL, r#"{"name": " Anna ", "access": "full"}"#);
    assert_eq!((status, &anna["name"], &anna["made_by"]), (201, &"Anna".into(), &"operator".into()), "{anna}");
    let anna_s = anna["secret"].as_str().unwrap().to_owned();
    let (status, wall) = make(&first, &anna_s, r#"{"name": "wall screen", "access": "read"}"#);
    assert_eq!((status, &wall["made_by"]), (201, &"Anna".into()), "{wall}");
    let wall_s = wall["secret"].as_str().unwrap().to_owned();
    for refused in [
        r#"{"name": "ANNA", "access": "read"}"#,
        r#"{"name": "local", "access": "read"}"#,
        r#"{"name": " ", "access": "read"}"#,
        r#"{"name": "nobody", "access": "open"}"#,
    ] {
        assert_eq!(make(&first, &anna_s, refused).0, 422, "{refused}");
    }
    assert_eq!(make(&first, &wall_s, r#"{"name": "Bert", "access": "full"}"#).0, 403);
    assert_eq!(list(&first, &wall_s).0, 403);
    let (_, tokens) = list(&first, &anna_s);
    let found: Vec<_> =
        tokens.as_array().unwrap().iter().map(|one| (one["name"].as_str().unwrap(), &one["yours"])).collect();
    assert_eq!(
        found,
        [
            ("operator", &false.into()),
            ("observer", &false.into()),
            ("Anna", &true.into()),
            ("wall screen", &false.into())
        ]
    );
    let text = tokens.to_string();
    assert!(!text.contains(&anna_s) && !text.contains(&wall_s) && !text.contains("hash"), "{text}");
    assert!(tokens[2]["used_at"].is_string() && tokens[0]["id"].is_null(), "{tokens}");
    let kept = std::fs::read(data.path().join("jointbench.db-wal")).unwrap();
    let holds = |secret: &str| kept.windows(secret.len()).any(|window| window == secret.as_bytes());
    assert!(holds("wall screen") && !holds(&anna_s) && !holds(&wall_s), "the secret is on the disk");
    first.stop();

    let second = daemon();
    assert_eq!(second.get_with("/api/v1/health", &[("authorization", &*bearer(&wall_s))]).1["access"], "read");
    assert_eq!(revoke(&second, &anna_s, &anna["id"]).0, 409, "nobody locks themselves out");
    assert_eq!(revoke(&second, &anna_s, &wall["id"]).0, 204);
    assert_eq!(list(&second, &wall_s).0, 401);
    assert_eq!(revoke(&second, FULL, &anna["id"]).0, 204);
    assert_eq!(revoke(&second, FULL, &anna["id"]).0, 404);
    assert_eq!(list(&second, &anna_s).0, 401);
    assert_eq!(list(&second, FULL).1.as_array().unwrap().len(), 2);
    assert_eq!(make(&second, FULL, r#"{"name": "Anna", "access": "read"}"#).0, 201, "the name is free again");
}

#[test]
fn a_daemon_without_tokens_accepts_every_client_and_names_tokens() {
    let daemon = TestDaemon::start();
    assert!(!page(&daemon).contains("data-token"));
    let (_, made) = daemon.post("/api/v1/tokens", r#"{"name": "wall screen", "access": "read"}"#);
    assert_eq!(made["made_by"], "local", "{made}");
    let bearer = format!("Bearer {}", made["secret"].as_str().unwrap());
    let access = |secret: &str| daemon.get_with("/api/v1/health", &[("authorization", secret)]).1["access"].clone();
    assert_eq!((access(&bearer), access("Bearer of old")), ("read".into(), "open".into()));
    assert_eq!(daemon.post_with("/api/v1/runs", SHORT_RUN.as_bytes(), &[("authorization", &bearer)]).0, 403);
    assert_eq!(daemon.delete(&format!("/api/v1/tokens/{}", made["id"])).0, 204);
    assert_eq!(access(&bearer), "open");
}

#[test]
fn a_failed_start_has_a_reason() {
    let data = TempDir::new().unwrap();
    let mut open = settings(data.path(), None);
    open.listen = "0.0.0.0:0".parse().unwrap();
    let error = refused(open.clone());
    assert!(error.to_string().contains("give a token"), "{error}");
    open.token = Some("correct horse".into());
    let error = refused(open.clone());
    assert!(error.to_string().contains("openssl rand -hex 24"), "{error}");
    open.token = Some(FULL.into());
    let error = refused(open.clone());
    assert!(error.to_string().contains("--tls-cert"), "{error}");
    open.network.tls = Some(TlsFiles { certificate: "/no/cert.pem".into(), key: "/no/key.pem".into() });
    let error = refused(open);
    assert!(error.to_string().contains("/no/cert.pem"), "{error}");
    let mut proxied = settings(data.path(), None);
    proxied.network.behind_proxy = true;
    let error = refused(proxied);
    assert!(error.to_string().contains("give a token"), "{error}");

    let running = TestDaemon::start();
    let mut taken = settings(data.path(), None);
    taken.listen = running.address().parse().unwrap();
    let error = refused(taken);
    assert!(error.to_string().contains("is in use: stop the other program"), "{error}");

    let error = refused(settings(running.data.path(), None));
    assert!(error.to_string().contains("in use by another jointbench"), "{error}");

    let file = data.path().join("a-file");
    std::fs::write(&file, "not a folder").unwrap();
    let error = refused(settings(&file, None));
    assert!(error.to_string().contains("cannot be written"), "{error}");
    assert_eq!(error.exit_code(), 2);
}
