//! Tests of a read-only token.

use crate::auth::{FULL, READS};
use crate::daemon::{BENCH, SHORT_RUN, TestDaemon};
use serde_json::Value;

/// Its permitted operations other than GET.
const MAY: [&str; 9] = [
    "check_effect",
    "diagnose_run",
    "evaluate_model",
    "preview_import",
    "preview_plan",
    "stop_autopilot",
    "stop_bench",
    "stop_run",
    "write_table",
];

fn daemon() -> TestDaemon {
    TestDaemon::start_with(None, |settings| {
        settings.token = Some(FULL.into());
        settings.read_token = Some(READS.into());
    })
}

/// Fills each placeholder of the path with a value.
fn filled(path: &str) -> String {
    path.replace("{bench}", BENCH).replace("{id}", "1").replace("{kind}", "friction").replace("{effect}", "rub")
}

#[test]
fn a_read_token_changes_nothing() {
    let daemon = daemon();
    let bearer = format!("Bearer {READS}");
    let headers = [("authorization", &*bearer), ("content-type", "application/json")];
    let (_, document) = daemon.get_with("/api/v1/openapi.json", &headers);
    let mut may = Vec::new();
    for (path, operations) in document["paths"].as_object().unwrap() {
        for (method, operation) in operations.as_object().unwrap() {
            let status = match method.as_str() {
                "post" => daemon.post_with(&filled(path), b"{}", &headers).0,
                "delete" => daemon.delete_with(&filled(path), &headers).0,
                "put" => daemon.put_with(&filled(path), b"{}", &headers).0,
                _ => continue,
            };
            if status != 403 {
                may.push(operation["operationId"].as_str().unwrap().to_owned());
            }
        }
    }
    // A missing model 1 is not a refusal of the token.
    may.sort();
    assert_eq!(may, MAY);
    for path in ["/api/v1/runs/1/tags/stop", "/api/v1/tokens/1/stop", "/api/v1/tokens/stop", "/stop"] {
        assert_eq!(daemon.post_with(path, b"{}", &headers).0, 403, "{path}");
    }
}

#[test]
fn a_read_token_sees_no_tokens() {
    let daemon = daemon();
    let (reads, full) = (format!("Bearer {READS}"), format!("Bearer {FULL}"));
    let name = r#"{"name": "wall screen", "access": "read"}"#;
    let json = ("content-type", "application/json");
    assert_eq!(daemon.post_with("/api/v1/tokens", name.as_bytes(), &[("authorization", &full), json]).0, 201);
    assert_eq!(daemon.get_with("/api/v1/tokens", &[("authorization", &reads)]).0, 403);
    let tells = |bearer: &str| daemon.get_with("/api/v1/log", &[("authorization", bearer)]).1.to_string();
    assert!(tells(&full).contains("wall screen") && !tells(&reads).contains("wall screen"));
}

#[test]
fn it_sees_the_diagnosis_that_is_kept_and_makes_none() {
    let daemon = daemon();
    let (reads, full) = (format!("Bearer {READS}"), format!("Bearer {FULL}"));
    let json = ("content-type", "application/json");
    let ask = |bearer: &str, path: &str, body: &str| {
        daemon.post_with(path, body.as_bytes(), &[("authorization", bearer), json])
    };
    let (status, run) = ask(&full, "/api/v1/runs", SHORT_RUN);
    assert_eq!(status, 201, "{run}");
    let of_run = format!("/api/v1/runs/{}", run["id"]);
    while daemon.get_with(&of_run, &[("authorization", &full)]).1["safe"].is_null() {
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    let fit = serde_json::json!({"run": run["id"], "effects": ["inertia", "coulomb", "viscous"]}).to_string();
    let (status, model) = ask(&full, "/api/v1/models", &fit);
    assert_eq!(status, 201, "{model}");
    let count = || {
        let list = format!("/api/v1/diagnoses?model={}", model["id"]);
        daemon.get_with(&list, &[("authorization", &full)]).1.as_array().map_or(0, Vec::len)
    };
    let before = count();
    let (status, diagnosis) = ask(&reads, "/api/v1/diagnoses", &format!(r#"{{"model": {}}}"#, model["id"]));
    let expected = if before > 0 { 201 } else { 403 };
    assert_eq!((status, count()), (expected, before), "{diagnosis}");
    assert!(before == 0 || diagnosis["id"] != Value::Null);
}

#[test]
fn wrong_tokens_are_refused_and_do_not_keep_a_right_one_out() {
    let daemon = daemon();
    let health = |token: &str| daemon.get_with("/api/v1/health", &[("authorization", &format!("Bearer {token}"))]).0;
    for _ in 0..3 {
        assert_eq!(health("wrong horse battery"), 401);
    }
    assert_eq!(health(FULL), 200);
    let wait: Vec<u16> = std::thread::scope(|scope| {
        let tries: Vec<_> = (0..40).map(|n| scope.spawn(move || health(&format!("wrong horse {n}")))).collect();
        assert_eq!(health(READS), 200, "while others wait for their refusals");
        tries.into_iter().map(|one| one.join().unwrap()).collect()
    });
    assert!(wait.contains(&401) && wait.contains(&429), "{wait:?}");
}
