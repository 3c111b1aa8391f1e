//! Faults of the daemon, tested through REST.

mod integrity;
#[cfg(unix)]
mod limits;

use crate::program::{Daemon, run, stderr, stdout};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// A slow mock bench, so that faults can occur during a run.
fn bench(folder: &Path, joint: &str, pace: f64) -> PathBuf {
    let config = folder.join("bench.toml");
    let text = format!(
        "[[bench]]\nname = \"mock\"\n[bench.mock]\njoint = \"{joint}\"\nseed = 4\neffects = []\npace = {pace:.1}\n"
    );
    std::fs::write(&config, text).expect("the bench description is written");
    config
}

fn start(daemon: &Daemon, procedure: &str) -> i64 {
    let (status, run) = daemon.post("/runs", &json!({ "bench": "mock", "procedure": procedure, "parameters": {} }));
    assert_eq!(status, 201, "{run}");
    run["id"].as_i64().expect("the run has a number")
}

fn rows(run: &Value) -> i64 {
    run["rows"].as_i64().expect("the run counts its rows")
}

#[test]
fn kill_9_loses_nothing_that_was_acknowledged() {
    check_kill_9("b", "friction");
}

#[test]
fn nor_does_it_on_an_encoder_bench() {
    check_kill_9("encoder_shaft", "encoder_alignment");
}

fn check_kill_9(joint: &str, procedure: &str) {
    let folder = tempfile::tempdir().expect("a folder");
    let config = bench(folder.path(), joint, 20.0);
    let data = folder.path().join("data");

    let daemon = Daemon::serve(&data, &config);
    let id = start(&daemon, procedure);
    let path = format!("/runs/{id}");
    let before = daemon.wait_for(&path, Duration::from_secs(60), |run| rows(run) > 1000);
    assert_eq!(before["state"], "running", "{before}");
    daemon.kill();

    let daemon = Daemon::serve(&data, &config);
    let after = daemon.get(&path);
    assert_eq!(after["state"], "interrupted", "{after}");
    assert_eq!(after["safe"], "safe_verified", "the bench was secured at the start: {after}");
    assert!(rows(&after) >= rows(&before), "{} rows were acknowledged, {} are left", rows(&before), rows(&after));

    // Every committed sample exists once: the reported number, at rising times.
    let samples = daemon.get_text(&format!("{path}/export?format=csv"));
    let times: Vec<f64> = samples.lines().skip(1).filter_map(|row| row.split(',').next()?.parse().ok()).collect();
    assert_eq!(times.len() as i64, rows(&after));
    assert!(times.windows(2).all(|pair| pair[0] < pair[1]), "a sample is there twice or out of order");

    // The events agree with this, without a gap.
    let events = daemon.get(&format!("{path}/events"));
    let numbers: Vec<i64> =
        events.as_array().expect("events").iter().filter_map(|event| event["sequence"].as_i64()).collect();
    assert!(!numbers.is_empty() && numbers.windows(2).all(|pair| pair[1] == pair[0] + 1), "{numbers:?}");

    // No run restarts by itself, and the next run can start.
    assert_eq!(daemon.get("/bench")[0]["run"], Value::Null);
    assert_eq!(daemon.get("/runs")["total"], 1);
    let next = start(&daemon, procedure);
    let (status, _) = daemon.post(&format!("/runs/{next}/abort"), &json!({}));
    assert!((200..300).contains(&status), "{status}");
    let ended = daemon.wait_for(&format!("/runs/{next}"), Duration::from_secs(60), |run| run["safe"].is_string());
    assert_eq!((&ended["state"], &ended["safe"]), (&json!("aborted"), &json!("safe_verified")));
}

#[test]
fn runs_are_listed_and_ended_from_the_command_line() {
    let folder = tempfile::tempdir().expect("a folder");
    let config = bench(folder.path(), "b", 20.0);
    let daemon = Daemon::serve(&folder.path().join("data"), &config);
    let command = |arguments: &[&str]| run(&[arguments, &["--daemon", daemon.base.as_str()]].concat());
    let idle = command(&["stop"]);
    assert_eq!(idle.status.code(), Some(2));
    assert!(stderr(&idle).contains("no run is active"), "{}", stderr(&idle));
    for (option, value, why) in [
        ("--require", "tau_x < 1 Nm", "does not determine tau_x; did you mean tau_c? available: tau_c, tau_h"),
        ("--require", "tau_c < 35 kg", "tau_c is in Nm"),
        ("--junit", "/nowhere/out.xml", "folder /nowhere does not exist"),
    ] {
        let vain = command(&["run", "friction", option, value]);
        assert_eq!(vain.status.code(), Some(2));
        assert!(stderr(&vain).contains(why), "{}", stderr(&vain));
    }
    assert_eq!(daemon.get("/runs")["total"], 0, "nothing has moved");

    let id = start(&daemon, "friction");
    daemon.wait_for(&format!("/runs/{id}"), Duration::from_secs(60), |run| rows(run) > 100);
    for (how, state) in [("pause", "paused"), ("resume", "running")] {
        let steered = command(&[how]);
        assert!(steered.status.success(), "{how}: {}", stderr(&steered));
        assert_eq!(daemon.get(&format!("/runs/{id}"))["state"], state, "`{how}` returns when the run is {state}");
    }
    let stopped = command(&["stop"]);
    assert!(stopped.status.success(), "{}", stderr(&stopped));
    assert!(stdout(&stopped).contains(&format!("run {id} stopped")), "{}", stdout(&stopped));
    for (late, why) in
        [(&["stop", "1"][..], "run 1 has already ended (stopped)"), (&["stop", "9"], "run 9 does not exist")]
    {
        let late = command(late);
        assert_eq!(late.status.code(), Some(2), "{}", stderr(&late));
        assert!(stderr(&late).contains(why), "{}", stderr(&late));
    }
    let listed = stdout(&command(&["runs", "state:stopped"]));
    let [head, run] = listed.lines().collect::<Vec<_>>()[..] else { panic!("{listed}") };
    assert!(head.ends_with("error") && run.contains("friction"), "{listed}");
    assert!(stdout(&command(&["runs", "state:failed"])).contains("no run matches"));
}

#[test]
fn units_are_started_and_listed_from_the_command_line() {
    let folder = tempfile::tempdir().expect("a folder");
    let config = bench(folder.path(), "b", 20.0);
    let daemon = Daemon::serve(&folder.path().join("data"), &config);
    let command = |arguments: &[&str]| run(&[arguments, &["--daemon", daemon.base.as_str()]].concat());
    assert!(stdout(&command(&["units"])).contains("start one with --unit SERIAL"));
    for (vain, why) in [
        (&["--batch", "7"][..], "--unit <SERIAL>"),
        (&["--unit", " ", "--batch", "7"], "the serial number is missing"),
        (&["--unit", "SN1", "--operator", "a\u{7}"], "operator: write 1 to 80 characters"),
    ] {
        let vain = command(&[&["run", "friction"], vain].concat());
        assert_eq!(vain.status.code(), Some(2));
        assert!(stderr(&vain).contains(why), "{}", stderr(&vain));
    }
    let unit = ["--unit", "SN123", "--part", "P", "--revision", "B", "--batch", "7", "--operator", "A. Smith"];
    let begun = command(&[&["run", "friction"], &unit[..]].concat());
    assert!(stdout(&begun).contains("unit SN123, part P, revision B, batch 7"), "{}", stdout(&begun) + &stderr(&begun));
    assert_eq!(daemon.get("/runs/1")["operator"], "A. Smith");
    assert!(command(&["stop"]).status.success());
    let listed = stdout(&command(&["units", "part:P"]));
    let [head, row] = listed.lines().collect::<Vec<_>>()[..] else { panic!("{listed}") };
    assert!(
        head.contains("first verdict") && row.starts_with("SN123             P     B         7      1"),
        "{listed}"
    );
    let json: Value = serde_json::from_str(&stdout(&command(&["units", "--json"]))).expect("JSON");
    assert_eq!((&json["total"], &json["units"][0]["serial"]), (&json!(1), &json!("SN123")), "{json}");
    assert!(stdout(&command(&["units", "unit:X"])).contains("no unit matches"));
    assert!(stdout(&command(&["runs", "unit:SN123"])).contains("unit SN123, part P"));
}

#[test]
fn a_run_that_takes_too_long_is_aborted_and_its_limits_are_skipped() {
    let folder = tempfile::tempdir().expect("a folder");
    let config = bench(folder.path(), "b", 20.0);
    let daemon = Daemon::serve(&folder.path().join("data"), &config);
    let junit = folder.path().join("out.xml");
    let report = junit.to_str().expect("a path");
    let limits = ["--require", "tau_c < 1 Nm", "--junit", report, "--timeout", "1", "--daemon", &daemon.base];
    let ended = run(&[&["run", "friction"], &limits[..]].concat());
    let text = stdout(&ended) + &stderr(&ended);
    assert_eq!(ended.status.code(), Some(1), "{text}");
    assert!(text.contains("run 1 aborted") && text.contains("longer than --timeout 1 s"), "{text}");
    assert_eq!(daemon.get("/runs/1")["safe"], "safe_verified");
    let report = std::fs::read_to_string(&junit).expect("the report");
    assert!(report.contains("tests=\"2\" failures=\"1\" errors=\"0\" skipped=\"1\""), "{report}");
}

#[test]
fn a_stopped_autopilot_is_reported_once() {
    let folder = tempfile::tempdir().expect("a folder");
    let config = bench(folder.path(), "b", 20.0);
    let daemon = Daemon::serve(&folder.path().join("data"), &config);
    let output = std::thread::scope(|scope| {
        let waiting = scope.spawn(|| run(&["autopilot", "--wait", "--daemon", daemon.base.as_str()]));
        let started = |all: &Value| !all[0]["runs"].as_array().is_none_or(Vec::is_empty);
        daemon.wait_for("/autopilots", Duration::from_secs(60), started);
        let (status, _) = daemon.post("/autopilots/1/stop", &json!({}));
        assert_eq!(status, 200);
        waiting.join().expect("the command ends")
    });
    let text = stdout(&output) + &stderr(&output);
    assert_eq!(output.status.code(), Some(1), "{text}");
    assert_eq!(text.matches("(local)").count(), 1, "{text}");
}

#[test]
fn a_run_that_decides_nothing_is_no_success() {
    let folder = tempfile::tempdir().expect("a folder");
    let config = bench(folder.path(), "a", 200.0);
    let daemon = Daemon::serve(&folder.path().join("data"), &config);
    // Swings above breakaway: the joint slides.
    let mut arguments = vec!["run", "presliding", "--wait", "--daemon", daemon.base.as_str()];
    for choice in ["top_torque_nm=0.045", "repeats=2", "amplitudes=2", "swings=1"] {
        arguments.extend(["--set", choice]);
    }
    let ended = run(&arguments);
    let text = stdout(&ended);
    assert!(text.contains("run 1 completed") && text.contains("run 1: inconclusive"), "{text} {}", stderr(&ended));
    assert_eq!(ended.status.code(), Some(3));
    let late = run(&["run", "--continue", "1", "--require", "tau_c < 35 kg", "--daemon", daemon.base.as_str()]);
    assert_eq!((late.status.code(), daemon.get("/runs")["total"].as_i64()), (Some(2), Some(1)));
    assert!(stderr(&late).contains("tau_c is in Nm"), "{}", stderr(&late));
    let complete = run(&["run", "--continue", "1", "--daemon", daemon.base.as_str()]);
    assert_eq!(complete.status.code(), Some(2));
    assert!(stderr(&complete).contains("run 1 is complete: there is nothing to resume"), "{}", stderr(&complete));
    let again = run(&["identify", "1", "--daemon", daemon.base.as_str()]);
    assert_eq!(again.status.code(), Some(3), "{}", stdout(&again));
}

#[test]
fn a_test_plan_is_waited_for_to_its_end_and_reported() {
    let folder = tempfile::tempdir().expect("a folder");
    let config = bench(folder.path(), "a", 200.0);
    let daemon = Daemon::serve(&folder.path().join("data"), &config);
    let plan = folder.path().join("plan.toml");
    let junit = folder.path().join("plan.xml");
    let wait = |proceed_if: &str, more: &[&str]| {
        let sliding = "{ top_torque_nm = 0.06, repeats = 2, amplitudes = 2, swings = 1 }";
        let runs = format!(
            "proceed_if = \"{proceed_if}\"\n[[run]]\nprocedure = \"presliding\"\nparameters = {sliding}\n\
             [[run]]\nprocedure = \"demagnetise\"\nparameters = {{ turns = 1, speed_rad_s = 3 }}\n"
        );
        std::fs::write(&plan, runs).expect("the plan");
        let arguments = ["queue", "add", &plan.display().to_string(), "--unit", "SN1", "--daemon", &daemon.base];
        let ended = run(&[&arguments[..], more].concat());
        (ended.status.code(), stdout(&ended), stderr(&ended))
    };
    let (code, text, fault) = wait("completed", &["--wait"]);
    assert_eq!(code, Some(3), "the first result is inconclusive: {text} {fault}");
    assert!(text.contains("run 1: inconclusive") && text.contains("run 2: identified"), "{text}");

    let (code, text, fault) = wait("identified", &["--junit", &junit.display().to_string()]);
    assert_eq!(code, Some(1), "the second run was not made: {text} {fault}");
    assert!(fault.contains("was removed (run 3 of the test plan is inconclusive)"), "{fault}");
    let report = std::fs::read_to_string(&junit).expect("the report");
    assert!(report.contains("tests=\"2\"") && report.contains("errors=\"1\""), "{report}");
}

#[test]
fn a_second_daemon_on_the_same_folder_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let config = bench(folder.path(), "b", 20.0);
    let data = folder.path().join("data");
    let _first = Daemon::serve(&data, &config);
    let second = crate::program::jointbench()
        .args(["serve", "--listen", "127.0.0.1:0", "--data"])
        .arg(&data)
        .arg("--config")
        .arg(&config)
        .output()
        .expect("jointbench starts");
    let text = crate::program::stderr(&second);
    assert_eq!(second.status.code(), Some(2), "{text}");
    assert!(text.contains(&data.display().to_string()), "the folder is named: {text}");
}

#[test]
fn a_port_that_is_taken_is_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let taken = std::net::TcpListener::bind("127.0.0.1:0").expect("a free port");
    let address = taken.local_addr().expect("an address").to_string();
    let data = folder.path().join("data");
    let output = crate::program::run(&["serve", "--listen", &address, "--data", &data.display().to_string()]);
    let text = crate::program::stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{text}");
    assert!(text.contains("is in use") && text.contains("--listen"), "{text}");
}
