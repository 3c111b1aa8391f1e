//! Conditions that block a bench until a person resolves them.

use crate::daemon::{BENCH, SHORT_RUN, TestDaemon};
use jointbench::config::BenchDescription;
use jointbench_devices::sim::{MockInstrument, PlannedTrouble, Trouble};
use jointbench_devices::{Joint, MockSettings};
use serde_json::Value;
use std::time::{Duration, Instant};

/// The torque sensor is disconnected during the run, and connected again when the bench is at rest.
const PULLED_S: f64 = 3.0;
const BACK_S: f64 = 40.0;

fn path() -> String {
    format!("/api/v1/bench/{BENCH}")
}

fn release(daemon: &TestDaemon) -> (u16, Value) {
    daemon.post(&format!("{}/acknowledge", path()), r#"{"reason": "hand out of the way"}"#)
}

#[test]
fn the_software_stop_holds_until_its_reset_also_after_a_restart() {
    let data = tempfile::tempdir().unwrap();
    let daemon = || TestDaemon::start_with(Some(4.0), |settings| settings.data = data.path().to_owned());
    let mut first = daemon();
    let (_, run) = first.post("/api/v1/runs", SHORT_RUN);
    let id = run["id"].as_i64().unwrap();
    first.wait_for(&format!("/api/v1/runs/{id}"), |run| run["state"] == "running");
    for _ in 0..2 {
        assert_eq!(first.post(&format!("{}/stop", path()), "").0, 200);
    }
    assert_eq!(first.wait_for_end(id)["state"], "aborted");
    let bench = first.wait_for(&path(), |bench| bench["run"].is_null() && bench["state"] == "stopped");
    assert_eq!((&bench["blocked"]["stopped"], &bench["blocked"]["by"]), (&true.into(), &"local".into()), "{bench}");
    first.stop();

    let second = daemon();
    second.wait_for(&path(), |bench| bench["state"] == "stopped");
    let (status, problem) = second.post("/api/v1/runs", SHORT_RUN);
    let detail = problem["detail"].as_str().unwrap();
    assert!(status == 409 && detail.contains("is stopped") && detail.contains("jointbench reset"), "{problem}");
    assert_eq!(second.post(&format!("{}/acknowledge", path()), r#"{"reason": " "}"#).0, 422);
    let (status, bench) = release(&second);
    assert_eq!((status, &bench["state"], &bench["blocked"]), (200, &"idle".into(), &Value::Null), "{bench}");
    assert_eq!(release(&second).0, 409, "nothing is left to be reset");
    let (_, record) = second.get(&format!("{}/safety", path()));
    let entries: Vec<_> =
        record.as_array().unwrap().iter().map(|entry| (&entry["stopped"], &entry["reason"])).collect();
    assert_eq!(entries[0], (&false.into(), &"hand out of the way".into()), "{record}");
    assert_eq!(
        (entries.len(), entries[2].0, &record[2]["run"]),
        (3, &true.into(), &id.into()),
        "every press: {record}"
    );
    assert_eq!(second.post("/api/v1/runs", SHORT_RUN).0, 201);
}

#[test]
fn a_stop_of_an_idle_bench_holds_too() {
    let daemon = TestDaemon::start();
    assert_eq!(daemon.post(&format!("{}/stop", path()), "").0, 200);
    daemon.wait_for(&path(), |bench| bench["state"] == "stopped");
    assert_eq!(daemon.post("/api/v1/runs", SHORT_RUN).0, 409);
}

#[test]
fn an_instrument_that_was_lost_in_a_run_is_not_ready_until_a_retry_finds_it() {
    let pulled = PlannedTrouble {
        instrument: MockInstrument::TorqueSensor,
        trouble: Trouble::Unplugged,
        from_s: PULLED_S,
        until_s: Some(BACK_S),
    };
    let mock = MockSettings { troubles: vec![pulled], pace: Some(4.0), ..MockSettings::new(Joint::JointA, 7) };
    let data = tempfile::tempdir().unwrap();
    let mut daemon = TestDaemon::start_with(None, |settings| {
        settings.data = data.path().into();
        settings.benches = vec![BenchDescription::mock(BENCH, mock)];
    });
    let (status, run) = daemon.post("/api/v1/runs", SHORT_RUN);
    assert_eq!(status, 201, "{run}");
    let run = daemon.wait_for_end(run["id"].as_i64().unwrap());
    assert_eq!(run["state"], "failed", "{run}");
    let bench = daemon.wait_for(&path(), |bench| bench["run"].is_null());
    assert_eq!(bench["state"], "fault", "{bench}");
    let lost = |bench: &Value| {
        bench["instruments"].as_array().unwrap().iter().find(|one| one["role"] == "torque_sensor").unwrap().clone()
    };
    let sensor = lost(&bench);
    assert_eq!(sensor["ready"], false, "{sensor}");
    assert!(sensor["fault"].as_str().unwrap().contains("port lost"), "{sensor}");
    assert!(sensor["since"].is_string(), "{sensor}");
    let (_, preview) = daemon.post("/api/v1/procedures/friction/preview", &format!(r#"{{"bench": "{BENCH}"}}"#));
    let checks = preview["checks"].as_array().unwrap();
    assert!(checks.iter().any(|check| check["name"] == "instruments" && check["ok"] == false), "{preview}");
    assert_eq!(daemon.post("/api/v1/runs", SHORT_RUN).0, 503, "it is tried again, and still away");
    assert_eq!(lost(&daemon.get(&path()).1)["since"], sensor["since"], "the same fault");

    let began = Instant::now();
    let bench = loop {
        let (status, bench) = daemon.post(&format!("{}/retry", path()), "");
        assert_eq!(status, 200, "{bench}");
        if lost(&bench)["ready"] == true {
            break bench;
        }
        assert!(began.elapsed() < Duration::from_secs(30), "it never comes back: {bench}");
        std::thread::sleep(Duration::from_millis(100));
    };
    assert_eq!((&bench["state"], &lost(&bench)["fault"]), (&"idle".into(), &Value::Null), "{bench}");
    let known = lost(&bench)["faults"].to_string();
    assert!(known.contains("port lost") && known.contains("cannot be opened"), "what was wrong stays known: {known}");
    daemon.stop();
    let daemon = TestDaemon::start_with(None, |settings| settings.data = data.path().into());
    let again = lost(&daemon.get(&path()).1);
    assert_eq!((again["faults"].to_string(), &again["ready"]), (known, &true.into()), "through a restart, too");
    assert_eq!(daemon.post("/api/v1/runs", SHORT_RUN).0, 201);
}
