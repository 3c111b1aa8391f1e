//! Names that users enter.

use crate::daemon::{BENCH, TestDaemon};
use crate::import::upload;

#[test]
fn names_are_bounded_and_have_no_hidden_characters() {
    let daemon = TestDaemon::start();
    let table = "time_s,motor_position_rad,motor_current_a\n0,0,0.1\n0.004,0.01,0.2\n0.008,0.02,0.1\n";
    let meta = r#"{"kind": "friction", "torque_constant_nm_per_a": 0.04}"#;
    let (status, run) = upload(&daemon, table, &[("meta", meta)]);
    assert_eq!(status, 201, "{run}");
    assert_eq!(daemon.post(&format!("/api/v1/bench/{BENCH}/stop"), "").0, 200);
    let effect = |title: &str| {
        serde_json::json!({"id": "rub", "kind": "friction", "formula": "tau = a * velocity", "title": title,
            "parameters": [{"name": "a"}]})
    };
    for odd in ["a\u{1b}[2J", "gpj.\u{202e}csv", "x\0", &"x".repeat(5000)] {
        let refused = |path: &str, body: serde_json::Value| {
            let (status, problem) = daemon.post(path, &body.to_string());
            assert_eq!(status, 422, "{path} {odd:?}: {problem}");
        };
        refused("/api/v1/tokens", serde_json::json!({"name": odd, "access": "read"}));
        refused("/api/v1/effects", effect(odd));
        refused("/api/v1/effects/check", serde_json::json!({"effect": effect(odd)}));
        refused(&format!("/api/v1/runs/{}/notes", run["id"]), serde_json::json!({"text": odd}));
        refused(&format!("/api/v1/bench/{BENCH}/acknowledge"), serde_json::json!({"reason": odd}));
        let body = serde_json::json!({"tags": [odd]}).to_string();
        let json = [("content-type", "application/json")];
        assert_eq!(
            daemon.put_with(&format!("/api/v1/runs/{}/tags", run["id"]), body.as_bytes(), &json).0,
            422,
            "{odd:?}"
        );
    }
}
