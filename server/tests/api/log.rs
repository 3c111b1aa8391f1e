//! The log of events and their authors.

use crate::daemon::{BENCH, SHORT_RUN, TestDaemon};
use serde_json::{Value, json};

fn entries(log: &Value, kind: &str) -> Vec<(String, Option<String>)> {
    let of_kind = log.as_array().unwrap().iter().filter(|entry| entry["kind"] == kind);
    of_kind.map(|one| (one["text"].as_str().unwrap().to_owned(), one["by"].as_str().map(str::to_owned))).collect()
}

#[test]
fn the_log_contains_users_and_actions() {
    let daemon = TestDaemon::start_with(Some(20.0), |_| {});
    let (_, made) = daemon.post("/api/v1/tokens", r#"{"name": "Anna", "access": "full"}"#);
    let bearer = format!("Bearer {}", made["secret"].as_str().unwrap());
    let anna = |path: &str, body: &Value| {
        let headers = [("authorization", &*bearer), ("content-type", "application/json")];
        let (status, answer) = daemon.post_with(&format!("/api/v1{path}"), body.to_string().as_bytes(), &headers);
        assert!(status < 300, "{path}: {answer}");
        answer
    };
    let run = anna("/runs", &serde_json::from_str(SHORT_RUN).unwrap());
    let (id, at) = (run["id"].as_i64().unwrap(), format!("/api/v1/runs/{}", run["id"]));
    assert_eq!((&run["by"], &run["provenance"]["by"]), (&"Anna".into(), &"Anna".into()));
    daemon.wait_for(&at, |run| run["state"] == "running");
    assert_eq!(daemon.post(&format!("{at}/pause"), "").0, 200);
    daemon.wait_for(&at, |run| run["state"] == "paused");
    anna(&format!("/runs/{id}/resume"), &Value::Null);
    assert_eq!(daemon.wait_for_end(id)["state"], "completed");
    let first = anna("/models", &json!({"run": id, "effects": ["coulomb", "viscous", "direction_offset"]}));
    let less = json!({"run": id, "effects": ["coulomb", "viscous"], "parent": first["id"]}).to_string();
    let (status, less) = daemon.post("/api/v1/models", &less);
    assert_eq!((status, &less["by"]), (201, &"local".into()), "{less}");
    anna(&format!("/bench/{BENCH}/stop"), &Value::Null);
    let reset = format!("/api/v1/bench/{BENCH}/acknowledge");
    assert_eq!(daemon.post(&reset, r#"{"reason": "looked at it"}"#).0, 200);

    let (_, log) = daemon.get("/api/v1/log");
    let entry = |text: &str, by: &str| (text.to_owned(), Some(by.to_owned()));
    assert_eq!(entries(&log, "started"), [entry("started", "Anna")], "{log}");
    assert_eq!(entries(&log, "stopped"), [entry("stopped: software stop pressed", "Anna")]);
    assert_eq!(entries(&log, "reset"), [entry("reset: looked at it", "local")]);
    assert_eq!(entries(&log, "token"), [entry("token Anna made", "local")]);
    let models = entries(&log, "model");
    assert!(models[0].0.ends_with(" removed") && models[0].1.as_deref() == Some("local"), "{models:?}");
    assert!(models[1].0.contains("fitted: Coulomb") && models[1].1.as_deref() == Some("Anna"), "{models:?}");
    let asked: Vec<String> = entries(&log, "control").into_iter().map(|(text, _)| text).collect();
    assert_eq!(asked, ["operator command: resume (Anna)", "operator command: pause (local)"]);
    let moments: Vec<&str> = log.as_array().unwrap().iter().map(|entry| entry["at"].as_str().unwrap()).collect();
    assert!(moments.is_sorted_by(|a, b| a >= b), "newest first: {moments:?}");

    let (_, of_run) = daemon.get(&format!("/api/v1/log?run={id}"));
    let kinds = |kind: &str| entries(&of_run, kind).len();
    assert_eq!((kinds("started"), kinds("model"), kinds("token"), kinds("reset")), (1, 2, 0, 0), "{of_run}");
    assert_eq!(daemon.get("/api/v1/log?run=77").0, 404);
}

#[test]
fn a_note_is_in_the_log_and_reaches_other_clients() {
    let daemon = TestDaemon::start();
    let (_, run) = daemon.post("/api/v1/runs", SHORT_RUN);
    let id = run["id"].as_i64().unwrap();
    let (mut other, _) = tungstenite::connect(format!("ws://{}/api/v1/events", daemon.address())).unwrap();
    let mark = json!({"at_s": 1.25, "text": "a knock\nat the gear"});
    let (status, note) = daemon.post(&format!("/api/v1/runs/{id}/notes"), &mark.to_string());
    assert_eq!(status, 201, "{note}");
    let message = loop {
        let message = other.read().unwrap();
        let Ok(text) = message.to_text() else { continue };
        match serde_json::from_str::<Value>(text) {
            Ok(message) if message["type"] == "note" => break message,
            _ => {}
        }
    };
    assert_eq!(message, json!({"type": "note", "run": id, "note": note}));
    daemon.wait_for_end(id);
    for path in [format!("/api/v1/log?run={id}"), "/api/v1/log".to_owned()] {
        let (_, log) = daemon.get(&path);
        let notes: Vec<&Value> = log.as_array().unwrap().iter().filter(|entry| entry["kind"] == "user_note").collect();
        assert_eq!(notes.len(), 1, "{path}: {log}");
        assert_eq!((&notes[0]["note"], &notes[0]["run"]), (&note["id"], &json!(id)), "{path}");
        assert_eq!((&notes[0]["text"], &notes[0]["at_s"]), (&note["text"], &json!(1.25)), "{path}");
    }
}

#[test]
fn the_log_has_pages_from_any_run() {
    let daemon = TestDaemon::start();
    let short = format!(r#"{{"bench": "{BENCH}", "procedure": "friction", "parameters": {{"load_levels": 1}}}}"#);
    for _ in 0..13 {
        let (status, run) = daemon.post("/api/v1/runs", &short);
        assert_eq!(status, 201, "{run}");
        let id = run["id"].as_i64().unwrap();
        daemon.post(&format!("/api/v1/runs/{id}/abort"), "");
        daemon.wait_for_end(id);
    }
    let started = |path: &str| -> Vec<i64> {
        let (_, log) = daemon.get(path);
        let of_kind = log.as_array().unwrap().iter().filter(|entry| entry["kind"] == "started");
        of_kind.map(|entry| entry["run"].as_i64().unwrap()).collect()
    };
    assert_eq!(started("/api/v1/log"), (2..=13).rev().collect::<Vec<i64>>());
    assert_eq!(started("/api/v1/log?before=2"), [1]);
    assert_eq!(daemon.get("/api/v1/log?before=77").0, 404);
}
