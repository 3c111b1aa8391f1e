//! Results that the next runs of a bench use.

use crate::daemon::{BENCH, SHORT_RUN, TestDaemon};
use serde_json::{Value, json};

pub fn made(daemon: &TestDaemon, procedure: &str, parameters: Value) -> i64 {
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
    let (status, applied) = apply(first.into());
    assert_eq!((status, &applied[0]["run"], &applied[0]["by"]), (201, &first.into(), &"local".into()), "{applied}");
    assert_eq!(used(), first, "the one that was applied");
    let (_, earlier) = daemon.get(&format!("/api/v1/runs/{second}/earlier"));
    assert_eq!((&earlier[0]["run"], &earlier[0]["holds"]), (&first.into(), &true.into()), "{earlier}");
    assert_eq!(apply(second.into()).0, 201);
    let (_, applied) = apply(Value::Null);
    let holds: Vec<_> = applied.as_array().unwrap().iter().map(|one| (&one["run"], one["holds"] == true)).collect();
    assert_eq!(holds, [(&Value::Null, true), (&second.into(), false), (&first.into(), false)], "{applied}");
    assert_eq!(used(), second);

    let friction = daemon.post("/api/v1/runs", SHORT_RUN).1["id"].as_i64().unwrap();
    daemon.wait_for_end(friction);
    for (refused, status) in [
        (json!({"procedure": "brake_hysteresis", "run": friction}), 422),
        (json!({"procedure": "stiffness", "run": friction}), 422),
        (json!({"procedure": "brake_hysteresis", "run": 7777}), 404),
    ] {
        assert_eq!(daemon.post(&path, &refused.to_string()).0, status, "{refused}");
    }
    let (_, log) = daemon.get("/api/v1/log");
    let of_kind = log.as_array().unwrap().iter().filter(|entry| entry["kind"] == "calibration");
    assert_eq!(of_kind.count(), 3, "{log}");
}

#[test]
fn a_zero_is_taken_off_the_next_runs_and_compensation_is_planned_with_the_friction_that_was_applied() {
    let daemon = TestDaemon::start();
    let path = format!("/api/v1/bench/{BENCH}/calibrations");
    let apply = |procedure: &str, run: Value| {
        let (status, applied) = daemon.post(&path, &json!({"procedure": procedure, "run": run}).to_string());
        assert_eq!((status, &applied[0]["procedure"], &applied[0]["run"]), (201, &procedure.into(), &run), "{applied}");
        applied
    };
    let run = |id: i64| daemon.get(&format!("/api/v1/runs/{id}")).1;
    let found = |id: i64| daemon.get(&format!("/api/v1/runs/{id}/identification")).1;
    let quantity = |found: &Value, name: &str| {
        let all = found["quantities"].as_array().unwrap();
        all.iter().find(|one| one["name"] == name).unwrap()["value"].as_f64().unwrap()
    };
    let sensor = || made(&daemon, "torque_sensor_zero", json!({"duration_s": 60, "steady_nm_per_min": 1}));
    let measured = sensor();
    let zero_nm = quantity(&found(measured), "zero");
    assert_eq!(found(measured)["applies"]["can"], true);
    apply("torque_sensor_zero", measured.into());

    let friction = made(&daemon, "friction", json!({"warm_up_s": 30.0}));
    let meta = &run(friction)["meta"];
    assert_eq!(
        (&meta["torque_sensor_zero_nm"], &meta["torque_sensor_zero_of_run"]),
        (&zero_nm.into(), &measured.into())
    );
    assert!(run(sensor())["meta"]["torque_sensor_zero_nm"].is_null(), "a zero is measured from what is felt");

    let next = found(friction)["follow_up"]["parameters"]["tau_c_nm"].as_f64().unwrap();
    apply("friction", friction.into());
    let (_, offered) = daemon.get(&format!("/api/v1/procedures?bench={BENCH}"));
    let compensation = offered.as_array().unwrap().iter().find(|one| one["id"] == "compensation").unwrap();
    let default = compensation["parameters"].as_array().unwrap().iter().find(|one| one["name"] == "tau_c_nm").unwrap();
    assert_eq!(default["default"], next);
    let fed = run(made(&daemon, "compensation", json!({"periods": 2})));
    assert_eq!((&fed["parameters"]["tau_c_nm"], &fed["meta"]["friction_of_run"]), (&next.into(), &friction.into()));

    let applied = apply("friction", Value::Null);
    let holds = |procedure: &str| {
        let mut all = applied.as_array().unwrap().iter();
        all.find(|one| one["procedure"] == procedure && one["holds"] == true).unwrap()["run"].clone()
    };
    assert_eq!((holds("friction"), holds("torque_sensor_zero")), (Value::Null, measured.into()), "{applied}");
    let fed = run(made(&daemon, "compensation", json!({"periods": 2})));
    assert_eq!((&fed["parameters"]["tau_c_nm"], &fed["meta"]["friction_of_run"]), (&0.03.into(), &Value::Null));
}

#[test]
fn a_brake_is_compared_with_that_of_another_run() {
    let daemon = TestDaemon::start();
    let short = |compared: i64| json!({"levels": 5, "loops": 2, "random_turns": 4, "compare_run": compared});
    let other = made(&daemon, "brake_hysteresis", short(0));
    let run = made(&daemon, "brake_hysteresis", short(other));
    let (_, stored) = daemon.get(&format!("/api/v1/runs/{run}"));
    assert_eq!(stored["meta"]["compared_brake_of_run"], other);
    let (_, found) = daemon.get(&format!("/api/v1/runs/{run}/identification"));
    let difference = found["quantities"].as_array().unwrap().iter().find(|one| one["name"] == "difference_mean");
    let ends = difference.unwrap()["ci95"].as_array().unwrap();
    // The same brake twice.
    assert!(ends[0].as_f64().unwrap() < 0.0 && ends[1].as_f64().unwrap() > 0.0, "{found}");
    let summary = found["summary"].as_str().unwrap();
    assert!(summary.contains(&format!("Difference from the brake of run {other}: mean ")), "{summary}");

    let friction = daemon.post("/api/v1/runs", SHORT_RUN).1["id"].as_i64().unwrap();
    daemon.wait_for_end(friction);
    for (compared, status) in [(friction, 422), (7777, 404)] {
        let asked = json!({"bench": BENCH, "procedure": "brake_hysteresis", "parameters": short(compared)});
        assert_eq!(daemon.post("/api/v1/runs", &asked.to_string()).0, status, "{compared}");
    }
}
