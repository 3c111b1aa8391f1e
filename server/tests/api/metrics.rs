//! Metrics for Prometheus.

use crate::daemon::{BENCH, SHORT_RUN, TestDaemon};
use serde_json::Value;

fn scraped(daemon: &TestDaemon) -> String {
    let mut response = daemon.get_raw("/metrics");
    assert!(response.headers()["content-type"].to_str().unwrap().starts_with("application/openmetrics-text"));
    response.body_mut().read_to_string().unwrap()
}

#[test]
fn benches_queues_runs_and_the_store_are_metrics() {
    let daemon = TestDaemon::start();
    let (_, run) = daemon.post("/api/v1/runs", SHORT_RUN);
    let run = daemon.wait_for_end(run["id"].as_i64().unwrap());
    let benches = daemon.wait_for("/api/v1/bench", |benches| benches[0]["state"] == "idle");
    let text = scraped(&daemon);
    for line in [
        format!("jointbench_bench_state{{bench=\"{BENCH}\",state=\"idle\"}} 1.0"),
        format!("jointbench_bench_state{{bench=\"{BENCH}\",state=\"stopped\"}} 0.0"),
        format!("jointbench_queue_entries{{bench=\"{BENCH}\"}} 0.0"),
        format!("jointbench_runs_total{{bench=\"{BENCH}\",procedure=\"friction\",state=\"completed\"}} 1"),
        "jointbench_store_damaged_records 0.0".to_owned(),
    ] {
        assert!(text.lines().any(|there| there == line), "{line} is missing:\n{text}");
    }
    let commits = format!("jointbench_commit_seconds_count{{bench=\"{BENCH}\"}} ");
    let count: u64 = text.lines().find_map(|line| line.strip_prefix(&commits)).unwrap().parse().unwrap();
    assert!(count > 0 && text.ends_with("# EOF\n"), "{text}");
    assert!(text.contains(&format!("jointbench_late_ticks_total{{bench=\"{BENCH}\"}} ")), "{text}");
    every_instrument_has_a_link_latency(&text, &benches[0]["instruments"], run["rows"].as_f64().unwrap());

    daemon.post(&format!("/api/v1/bench/{BENCH}/stop"), "");
    assert!(scraped(&daemon).contains(&format!("jointbench_bench_blocked{{bench=\"{BENCH}\"}} 1.0")));
}

/// Each row needs an exchange with the joint.
fn every_instrument_has_a_link_latency(text: &str, instruments: &Value, rows: f64) {
    let names: Vec<&str> = instruments.as_array().unwrap().iter().map(|one| one["name"].as_str().unwrap()).collect();
    assert!(rows > 100.0 && names == ["joint", "torque_sensor", "brake_a"], "{rows} rows, {names:?}");
    for name in names {
        let labels = format!("bench=\"{BENCH}\",instrument=\"{name}\"");
        let value = |series: String| -> f64 {
            let found = text.lines().find_map(|line| line.strip_prefix(&series));
            found.unwrap_or_else(|| panic!("{series} is missing:\n{text}")).parse().unwrap()
        };
        let count = value(format!("jointbench_link_seconds_count{{{labels}}} "));
        assert!(count >= if name == "joint" { rows } else { 1.0 }, "{rows} rows: {text}");
        assert!(value(format!("jointbench_link_seconds_sum{{{labels}}} ")) > 0.0, "{text}");
        assert_eq!(value(format!("jointbench_link_seconds_bucket{{le=\"+Inf\",{labels}}} ")), count, "{text}");
    }
}

#[test]
fn metrics_need_the_token_of_the_daemon() {
    let token = "a-token-of-24-characters";
    let daemon = TestDaemon::start_with(None, |settings| settings.token = Some(token.into()));
    assert_eq!(daemon.get("/metrics").0, 401);
    let bearer = format!("Bearer {token}");
    assert_eq!(daemon.get_raw_with("/metrics", &[("authorization", bearer.as_str())]).status(), 200);
}
