//! The CI jobs of `docs/ci`: the command of both examples, carried out on a mock bench.

use super::{docs, page};
use crate::program::{Daemon, jointbench, stderr, stdout};
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::Duration;

/// The command of a job: the line that calls the script.
fn command_of(job: &str) -> String {
    let text = page(job);
    let mut calls = text.lines().filter_map(|line| line.split_once("sh ci/measure.sh").map(|(_, rest)| rest));
    let (Some(rest), None) = (calls.next(), calls.next()) else { panic!("docs/{job} calls the script once") };
    format!("sh ci/measure.sh{rest}")
}

/// A repository with the folder `ci`, as a job finds it.
fn checkout() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::create_dir(folder.path().join("ci")).expect("a folder");
    for file in ["measure.sh", "mock.toml", "limits.toml"] {
        std::fs::copy(docs().join("ci").join(file), folder.path().join("ci").join(file)).expect("a file of docs/ci");
    }
    folder
}

/// The command in the shell of a job. Variables that are not set in the CI system are empty there.
fn job(folder: &Path, command: &str, url: &str) -> Command {
    let mut shell = Command::new("sh");
    shell.args(["-c", command]).current_dir(folder).env_remove("JOINTBENCH_DATA").env_remove("JOINTBENCH_TOKEN_FILE");
    shell.env("JOINTBENCH_PROGRAM", jointbench().get_program()).env("JOINTBENCH_TOKEN", "").env("JOINTBENCH_URL", url);
    shell
}

fn text(output: &Output) -> String {
    stdout(output) + &stderr(output)
}

#[test]
fn the_page_shows_the_files() {
    let shown = page("ci.md");
    for file in ["ci/limits.toml", "ci/github.yml", "ci/gitlab.yml"] {
        assert!(shown.contains(&page(file)), "docs/ci.md differs from docs/{file}");
    }
    assert_eq!(command_of("ci/github.yml"), command_of("ci/gitlab.yml"));
}

#[test]
fn a_job_without_a_daemon_measures_on_the_mock_bench() {
    let folder = checkout();
    let ended = job(folder.path(), &command_of("ci/github.yml"), "").output().expect("sh runs");
    assert_eq!(ended.status.code(), Some(0), "{}", text(&ended));
    assert!(stdout(&ended).contains("pass: tau_c < 0.035 Nm"), "{}", text(&ended));
    let report = std::fs::read_to_string(folder.path().join("report.xml")).expect("the report");
    assert!(report.contains("name=\"mock\" tests=\"2\" failures=\"0\" errors=\"0\" skipped=\"0\""), "{report}");
    let vain = job(folder.path(), "sh ci/measure.sh friction", "").output().expect("sh runs");
    assert_eq!(vain.status.code(), Some(2), "{}", text(&vain));
}

#[test]
fn a_job_fails_by_the_limits_of_its_part() {
    let folder = checkout();
    let daemon = Daemon::serve(&folder.path().join("data"), &docs().join("ci/mock.toml"));
    let limits = folder.path().join("ci/limits.toml");
    let given = std::fs::read_to_string(&limits).expect("the limits");
    // The value is near 0.029 Nm: beyond the first limit, and inside the second one by less than its guard band.
    let in_band = "the value itself is in the guard band";
    for (upper, code, why) in [("upper = 0.02", 1, "tau_c = "), ("upper = 0.035\nguard_band = 0.01", 3, in_band)] {
        std::fs::write(&limits, given.replace("upper = 0.035", upper)).expect("written");
        let ended = job(folder.path(), &command_of("ci/gitlab.yml"), &daemon.base).output().expect("sh runs");
        assert_eq!(ended.status.code(), Some(code), "{}", text(&ended));
        let report = std::fs::read_to_string(folder.path().join("report.xml")).expect("the report");
        assert!(report.contains("tests=\"2\" failures=\"1\"") && report.contains(why), "{report}");
    }
    assert_eq!(daemon.get("/runs?search=unit:SN123")["total"], 2);
}

#[test]
fn the_run_of_a_killed_job_ends_by_its_lease() {
    let folder = checkout();
    let bench = folder.path().join("bench.toml");
    std::fs::write(&bench, page("ci/mock.toml") + "pace = 5.0\n").expect("the bench description");
    let daemon = Daemon::serve(&folder.path().join("data"), &bench);
    // The shell becomes the program, as in a runner that kills the job.
    let command = format!("exec {}", command_of("ci/github.yml"));
    let mut killed = job(folder.path(), &command, &daemon.base)
        .env("JOINTBENCH_LEASE_S", "2")
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("sh runs");
    daemon.wait_for("/runs", Duration::from_secs(60), |runs| runs["runs"][0]["state"] == "running");
    killed.kill().expect("the job runs");
    killed.wait().expect("the job ends");
    let ended = daemon.wait_for("/runs/1", Duration::from_secs(60), |run| run["safe"].is_string());
    assert_eq!((&ended["state"], &ended["safe"]), (&"stopped".into(), &"safe_verified".into()), "{ended}");
    daemon.wait_for("/bench", Duration::from_secs(60), |benches| benches[0]["state"] == "idle");
}
