//! The memory of a Puma-type servo.

use crate::daemon::{BENCH, TestDaemon};
use jointbench::config::BenchDescription;
use jointbench_devices::{Joint, MockSettings, PumaGains};
use serde_json::{Value, json};

const PATH: &str = "/api/v1/bench/arm/servo-memory";

fn daemon_with_arm(pace: Option<f64>) -> TestDaemon {
    TestDaemon::start_with(pace, |settings| {
        let gains = PumaGains { velgan: Some(8), ..PumaGains::default() };
        let arm = MockSettings { gains, pace, ..MockSettings::new(Joint::Puma, 7) };
        settings.benches.push(BenchDescription::mock("arm", arm));
    })
}

#[test]
fn all_variables_are_read_between_runs_and_none_during_one() {
    let daemon = daemon_with_arm(Some(10.0));
    let (status, memory) = daemon.get(PATH);
    assert_eq!(status, 200, "{memory}");
    let variables = memory["variables"].as_array().unwrap();
    let named = |name: &str| variables.iter().find(|one| one["name"] == name).unwrap_or(&Value::Null);
    assert_eq!(variables.len(), 28, "27 of table 2.7, and the address of the manual");
    assert_eq!((&named("ninter")["value"], &named("ninter")["shown"]), (&json!(32.0), &json!("32 ticks")));
    assert_eq!(named("pos")["bytes"].as_array().map(Vec::len), Some(32));

    let (status, run) = daemon.post("/api/v1/runs", r#"{"bench": "arm", "procedure": "puma_friction"}"#);
    assert_eq!(status, 201, "{run}");
    let (status, refused) = daemon.get(PATH);
    assert_eq!((status, &refused["type"]), (409, &json!("urn:jointbench:conflict")), "{refused}");
    daemon.post(&format!("/api/v1/runs/{}/abort", run["id"]), "{}");
    let run = daemon.wait_for_end(run["id"].as_i64().unwrap());
    assert_eq!(run["safe"], "safe_verified", "{run}");

    // These variables are written when the servo is armed.
    let at = |address: u8| daemon.get(&format!("{PATH}?address={address}")).1["variables"][0].clone();
    assert_eq!((&at(0x04)["name"], &at(0x04)["value"]), (&json!("velgan"), &json!(8.0)));
    assert_eq!((&at(0x5C)["name"], &at(0x5C)["value"]), (&json!("(unused)"), &json!(0.0)));
    assert_eq!(at(0x0B)["name"], "deltae", "the variable that the address belongs to");
}

#[test]
fn what_has_no_such_memory_is_refused() {
    let daemon = daemon_with_arm(None);
    let (status, refused) = daemon.get(&format!("/api/v1/bench/{BENCH}/servo-memory"));
    assert_eq!(status, 422, "{refused}");
    assert!(refused["detail"].as_str().unwrap().contains("no servo whose memory"), "{refused}");
    assert_eq!(daemon.get("/api/v1/bench/nosuch/servo-memory").0, 404);
    assert_eq!(daemon.get(&format!("{PATH}?address=128")).0, 422);
    assert_eq!(daemon.get(&format!("{PATH}?address=x")).0, 400);
}
