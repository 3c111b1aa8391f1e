//! Results that the next runs of a bench use.

use crate::daemon::{BENCH, SHORT_RUN, TestDaemon};
use serde_json::{Value, json};

fn made(daemon: &TestDaemon, procedure: &str, parameters: Value) -> i64 {
    let asked = json!({"bench": BENCH, "procedure": procedure, "parameters": parameters});
    let (status, run) = daemon.post("/api/v1/runs", &asked.to_string());
    assert_eq!(status, 201, "{run}");
    let id = run["id"].as_i64().unwrap();
    assert_eq!(daemon.wait_for_end(id)["state"], "completed");
    id
}

#[test]
fn the_next_run_is_commanded_by_the_brake_that_was_applied_and_the_way_back_is_open() {
    let daemon = TestDaemon::start();
    let hysteresis = || made(&daemon, "brake_hysteresis", json!({}));
    let (first, second) = (hysteresis(), hysteresis());
    let path = format!("/api/v1/bench/{BENCH}/calibrations");
    let apply = |run: Value| daemon.post(&path, &json!({"procedure": "brake_hysteresis", "run": run}).to_string());
    let used = || {
        let run = made(&daemon, "brake_torque", json!({"histories": 1, "torques": 2}));
        daemon.get(&format!("/api/v1/runs/{run}")).1["meta"]["brake_model_of_run"].clone()
    };
    assert_eq!((daemon.get(&path).1, used()), (json!([]), second.into()), "the last one counts");
    let (status, told) = apply(first.into());
    assert_eq!((status, &told[0]["run"], &told[0]["by"]), (201, &first.into(), &"local".into()), "{told}");
    assert_eq!(used(), first, "the one that was applied");
    let (_, earlier) = daemon.get(&format!("/api/v1/runs/{second}/earlier"));
    assert_eq!((&earlier[0]["run"], &earlier[0]["holds"]), (&first.into(), &true.into()), "{earlier}");
    assert_eq!(apply(second.into()).0, 201);
    let (_, told) = apply(Value::Null);
    let holds: Vec<_> = told.as_array().unwrap().iter().map(|one| (&one["run"], one["holds"] == true)).collect();
    assert_eq!(holds, [(&Value::Null, true), (&second.into(), false), (&first.into(), false)], "{told}");
    assert_eq!(used(), second);

    let friction = daemon.post("/api/v1/runs", SHORT_RUN).1["id"].as_i64().unwrap();
    daemon.wait_for_end(friction);
    for (refused, status) in [
        (json!({"procedure": "brake_hysteresis", "run": friction}), 422),
        (json!({"procedure": "friction", "run": friction}), 422),
        (json!({"procedure": "brake_hysteresis", "run": 7777}), 404),
    ] {
        assert_eq!(daemon.post(&path, &refused.to_string()).0, status, "{refused}");
    }
    let (_, log) = daemon.get("/api/v1/log");
    let of_kind = log.as_array().unwrap().iter().filter(|entry| entry["kind"] == "calibration");
    assert_eq!(of_kind.count(), 3, "{log}");
}
