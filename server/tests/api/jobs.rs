//! Computations in separate processes: limits, and clients that disconnect.

use crate::daemon::TestDaemon;
use crate::import::upload;
use serde_json::json;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

const META: &str = r#"{"kind": "friction", "torque_constant_nm_per_a": 0.04}"#;
/// A fit to these rows takes much longer than an abandoned request.
const MANY: usize = 120_000;
const PATIENCE: Duration = Duration::from_secs(60);

/// Strokes in both directions at many speeds.
fn table(rows: usize) -> String {
    let mut table = "time_s,motor_position_rad,motor_velocity_rad_s,motor_current_a\n".to_owned();
    for row in 0..rows {
        let phase = row as f64 * 0.004;
        let (velocity, position) = (8.0 * phase.sin() * (0.05 * phase).cos(), -8.0 * phase.cos());
        let noise = (row * 7919 % 1000) as f64 * 1e-5;
        let current = 0.4 * velocity.signum() + 0.01 * velocity + noise;
        writeln!(table, "{},{position},{velocity},{current}", row as f64 * 0.004).unwrap();
    }
    table
}

fn run(daemon: &TestDaemon, rows: usize) -> i64 {
    let (status, run) = upload(daemon, &table(rows), &[("meta", META)]);
    assert_eq!(status, 201, "{run}");
    run["id"].as_i64().unwrap()
}

fn model(run: i64) -> String {
    json!({"run": run, "effects": ["coulomb", "viscous"]}).to_string()
}

/// Requests a fit and disconnects.
fn ask_and_leave(daemon: &TestDaemon, query: &str, run: i64) {
    let config = ureq::Agent::config_builder().timeout_global(Some(Duration::from_millis(300)));
    let agent = ureq::Agent::new_with_config(config.build());
    let request = agent.post(format!("http://{}/api/v1/models{query}", daemon.address()));
    let left = request.header("content-type", "application/json").send(model(run));
    assert!(left.is_err(), "the fit was done before its client has left: make the run longer");
}

/// Number of processes that compute with the data of this daemon.
#[cfg(target_os = "linux")]
fn computing(data: &Path) -> usize {
    let processes = std::fs::read_dir("/proc").unwrap().flatten().map(|process| process.path());
    let is_job = |process: &PathBuf| std::fs::read(process.join("cmdline")).is_ok_and(|it| it == b"jointbench\0job\0");
    let has_open = |process: &PathBuf| {
        let files = std::fs::read_dir(process.join("fd")).into_iter().flatten().flatten();
        files.filter_map(|file| std::fs::read_link(file.path()).ok()).any(|file| file.starts_with(data))
    };
    processes.filter(|process| is_job(process) && has_open(process)).count()
}

#[test]
fn a_computation_beyond_the_memory_limit_is_refused() {
    let daemon = TestDaemon::start_with(None, |settings| settings.analysis.memory_bytes = 32 << 20);
    let (status, problem) = upload(&daemon, &table(MANY), &[("meta", META)]);
    assert_eq!(status, 413, "{problem}");
    let detail = problem["detail"].as_str().unwrap();
    assert!(detail.contains("0.03125 GiB of memory") && detail.contains("--analysis-memory"), "{detail}");
    assert_eq!(daemon.get("/api/v1/runs").1["total"], 0, "nothing is kept");
}

#[test]
fn a_computation_beyond_the_time_limit_is_refused() {
    let daemon = TestDaemon::start_with(None, |settings| settings.analysis.time = Duration::from_millis(1));
    let (status, problem) = upload(&daemon, &table(MANY), &[("meta", META)]);
    assert_eq!(status, 413, "{problem}");
    assert!(problem["detail"].as_str().unwrap().contains("takes longer than"), "{problem}");
}

#[cfg(target_os = "linux")]
#[test]
fn a_fit_ends_when_its_client_leaves() {
    let mut daemon = TestDaemon::start();
    let data = daemon.data.path().canonicalize().unwrap();
    let run = run(&daemon, MANY);
    ask_and_leave(&daemon, "", run);
    let began = Instant::now();
    while computing(&data) > 0 {
        assert!(began.elapsed() < PATIENCE, "it still computes");
        std::thread::sleep(Duration::from_millis(20));
    }
    assert_eq!(daemon.get(&format!("/api/v1/models?run={run}")).1, json!([]), "nothing is kept");

    ask_and_leave(&daemon, "?detach=true", run);
    let models = daemon.wait_for(&format!("/api/v1/models?run={run}"), |models| models != &json!([]));
    assert_eq!(models[0]["effects"], json!(["coulomb", "viscous"]), "it goes on where that is asked for");

    let other = self::run(&daemon, MANY + 1);
    ask_and_leave(&daemon, "?detach=true", other);
    daemon.stop();
    assert_eq!(computing(&data), 0, "the daemon takes its computations with it");
}
