//! Metrics for Prometheus.

use crate::daemon::{BENCH, SHORT_RUN, TestDaemon};

fn scraped(daemon: &TestDaemon) -> String {
    let mut response = daemon.get_raw("/metrics");
    assert!(response.headers()["content-type"].to_str().unwrap().starts_with("application/openmetrics-text"));
    response.body_mut().read_to_string().unwrap()
}

#[test]
fn benches_queues_runs_and_the_store_are_metrics() {
    let daemon = TestDaemon::start();
    let (_, run) = daemon.post("/api/v1/runs", SHORT_RUN);
    daemon.wait_for_end(run["id"].as_i64().unwrap());
    daemon.wait_for("/api/v1/bench", |benches| benches[0]["state"] == "idle");
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

    daemon.post(&format!("/api/v1/bench/{BENCH}/stop"), "");
    assert!(scraped(&daemon).contains(&format!("jointbench_bench_blocked{{bench=\"{BENCH}\"}} 1.0")));
}

#[test]
fn metrics_need_the_token_of_the_daemon() {
    let token = "a-token-of-24-characters";
    let daemon = TestDaemon::start_with(None, |settings| settings.token = Some(token.into()));
    assert_eq!(daemon.get("/metrics").0, 401);
    let bearer = format!("Bearer {token}");
    assert_eq!(daemon.get_raw_with("/metrics", &[("authorization", bearer.as_str())]).status(), 200);
}
