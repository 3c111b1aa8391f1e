//! A full disk during a run: simulated by the mock bench, with SQLite's own refusal.

use crate::daemon::{BENCH, TestDaemon};
use jointbench::config::BenchDescription;
use jointbench_devices::sim::{MockInstrument, PlannedTrouble, Trouble};
use jointbench_devices::{Joint, MockSettings};
use serde_json::Value;

/// Takes a minute.
const RUN: &str = r#"{"bench": "joint-a-mock", "procedure": "friction", "parameters":
    {"repeats": 2, "load_levels": 1, "dwell_s": 0.5, "warm_up_s": 1.0, "top_speed_rad_s": 60.0}}"#;
/// During the strokes.
const FULL_S: f64 = 30.0;
/// After the end of the run.
const HEALED_S: f64 = 42.0;

#[test]
fn a_full_disk_ends_a_run_and_the_end_is_stored_later() {
    let full = PlannedTrouble {
        instrument: MockInstrument::Disk,
        trouble: Trouble::DiskFull,
        from_s: FULL_S,
        until_s: Some(HEALED_S),
    };
    let mock = MockSettings { troubles: vec![full], ..MockSettings::new(Joint::JointA, 7) };
    let daemon = TestDaemon::start_with(None, |settings| settings.benches = vec![BenchDescription::mock(BENCH, mock)]);
    let (status, run) = daemon.post("/api/v1/runs", RUN);
    assert_eq!(status, 201, "{run}");
    let path = format!("/api/v1/runs/{}", run["id"]);

    let run = daemon.wait_for(&path, |run| run["state"] == "failed");
    assert_eq!(run["safe"], "safe_verified", "known at once: {run}");
    let not_stored = |value: &Value| value.as_str().is_some_and(|why| why.contains("the disk is full"));
    assert!(not_stored(&run["not_stored"]), "and that it is not stored: {run}");
    let (_, list) = daemon.get("/api/v1/runs");
    assert_eq!(list["runs"][0]["state"], "failed", "{list}");
    let (_, bench) = daemon.get(&format!("/api/v1/bench/{BENCH}"));
    assert!(bench["state"] == "idle" && not_stored(&bench["unstored"]["fault"]), "{bench}");
    assert_eq!(daemon.post("/api/v1/runs", RUN).0, 409, "no run that could not be stored");

    let run = daemon.wait_for(&path, |run| run["not_stored"].is_null());
    assert!(run["rows"].as_u64() > Some(100), "{run}");
    let reason = run["reason"].as_str().unwrap();
    assert!(reason.contains("the disk is full") && reason.contains("free some space"), "{reason}");

    let (_, csv) = daemon.get(&format!("{path}/export?format=csv"));
    let times: Vec<f64> =
        csv.as_str().unwrap().lines().skip(1).map(|row| row.split(',').next().unwrap().parse().unwrap()).collect();
    assert_eq!(times.len() as u64, run["rows"].as_u64().unwrap());
    assert!(times.windows(2).all(|pair| pair[0] < pair[1]));
    assert!(times.last().is_some_and(|last_s| *last_s >= FULL_S), "what waited in memory is there: {:?}", times.last());

    let (status, next) = daemon.post("/api/v1/runs", RUN);
    assert_eq!(status, 201, "{next}");
    let next = daemon.wait_for_end(next["id"].as_i64().unwrap());
    assert_eq!(
        (&next["state"], &next["safe"]),
        (&"completed".into(), &"safe_verified".into()),
        "{} {}",
        next["reason"],
        next["rows"]
    );
    assert!(next["rows"].as_u64() > run["rows"].as_u64(), "{next}");
}
