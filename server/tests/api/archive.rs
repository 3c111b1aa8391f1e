//! The archive of ended runs: files, delays, and the removal of archived samples.

use crate::calibrations::made;
use crate::daemon::{BENCH, SHORT_RUN, TestDaemon};
use jointbench::config::{Archive, parse};
use jointbench_files::ReadOptions;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};
use tempfile::TempDir;

fn described(folder: &Path, raw: bool) -> Option<Archive> {
    let bench = "[[bench]]\nname = \"a\"\nmock.joint = \"a\"\n";
    let table = format!("[archive]\nurl = \"file://{}\"\nraw = {raw}\n", folder.display());
    parse("bench.toml", &format!("{bench}{table}")).unwrap().archive
}

fn daemon(folder: &Path, raw: bool) -> TestDaemon {
    TestDaemon::start_with(None, |settings| settings.archive = described(folder, raw))
}

/// A complete run of a unit.
fn run(daemon: &TestDaemon) -> i64 {
    let mut new: Value = serde_json::from_str(SHORT_RUN).unwrap();
    new["unit"] = json!({"serial": "SN7", "part": "JT/1", "revision": "C", "batch": "B 7"});
    let (status, run) = daemon.post("/api/v1/runs", &new.to_string());
    assert_eq!(status, 201, "{run}");
    let id = run["id"].as_i64().unwrap();
    assert_eq!(daemon.wait_for_end(id)["state"], "completed");
    id
}

fn wait_until_archived(daemon: &TestDaemon) -> Value {
    daemon.wait_for("/api/v1/archive", |archive| archive["owed"] == 0)
}

fn retry(daemon: &TestDaemon) {
    assert_eq!(daemon.post("/api/v1/archive/retry", "").0, 200);
}

/// The entry of the run for one table.
fn table(daemon: &TestDaemon, run: i64, content: &str) -> Value {
    let (_, run) = daemon.get(&format!("/api/v1/runs/{run}"));
    let tables = run["archive"].as_array().unwrap_or_else(|| panic!("{run}"));
    tables.iter().find(|table| table["content"] == content).unwrap().clone()
}

fn file(table: &Value) -> PathBuf {
    table["file"].as_str().unwrap_or_else(|| panic!("{table}")).into()
}

/// Where the file of a run will be.
fn path_of(daemon: &TestDaemon, folder: &Path, content: &str, run: i64) -> PathBuf {
    let mark = std::fs::read_to_string(daemon.data.path().join("jointbench.mark")).unwrap();
    let store = mark.split_whitespace().next().unwrap();
    folder.join(format!("{content}/part=JT%2F1/batch=B%207/bench={BENCH}/run-{store}-{run}.parquet"))
}

/// All files below a folder.
fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().map(|entry| entry.unwrap().path());
    entries.flat_map(|path| if path.is_dir() { files(&path) } else { vec![path] }).collect()
}

#[test]
fn an_ended_run_is_archived_with_its_provenance() {
    let folder = TempDir::new().unwrap();
    let daemon = daemon(folder.path(), true);
    let id = run(&daemon);
    let state = wait_until_archived(&daemon);
    assert_eq!((&state["archived"], &state["failed"], &state["last_error"]), (&json!(2), &json!(0), &Value::Null));
    assert_eq!(state["url"], format!("file://{}", folder.path().display()));
    assert_eq!(files(folder.path()).len(), 2, "no incomplete file: {:?}", files(folder.path()));

    let samples = table(&daemon, id, "samples");
    let path = file(&samples);
    assert_eq!(path, path_of(&daemon, folder.path(), "samples", id));
    let bytes = std::fs::read(&path).unwrap();
    assert_eq!(samples["bytes"].as_u64(), Some(bytes.len() as u64));
    let has = |text: &str| bytes.windows(text.len()).any(|window| window == text.as_bytes());
    for text in ["jointbench.sha256", samples["sha256"].as_str().unwrap(), "SN7", "JT/1", "B 7", "certificates"] {
        assert!(has(text), "{text}");
    }
    let read = jointbench_files::read(&path, &ReadOptions::default()).unwrap();
    let exported =
        daemon.get_raw(&format!("/api/v1/runs/{id}/export?format=parquet")).body_mut().read_to_vec().unwrap();
    let exported = jointbench_files::read_bytes("x.parquet", &exported, &ReadOptions::default()).unwrap();
    assert_eq!(read.trace(), exported.trace());

    let path = file(&table(&daemon, id, "means"));
    let means = jointbench_files::read(&path, &ReadOptions::default()).unwrap();
    let [time_s, speed, count] =
        ["time_s", "motor_velocity_rad_s", "samples"].map(|name| means.column(name).unwrap().to_vec());
    assert!(means.meta().operating_points && means.len() >= 8, "{}", means.len());
    assert!(time_s.windows(2).all(|pair| pair[0] < pair[1]), "{time_s:?}");
    assert!(count.iter().all(|count| *count > 10.0) && speed.iter().any(|speed| *speed < -1.0), "{speed:?}");
    // The mean of the first steady state, over the same time of the samples.
    let half_s = means.column("duration_s").unwrap()[0] / 2.0 + 1e-6;
    let rows = exported.column("time_s").unwrap().iter().zip(exported.column("motor_velocity_rad_s").unwrap());
    let within: Vec<f64> = rows.filter(|(at_s, _)| (*at_s - time_s[0]).abs() < half_s).map(|(_, v)| *v).collect();
    let expected = within.iter().sum::<f64>() / within.len() as f64;
    assert_eq!(within.len() as f64, count[0]);
    assert!((speed[0] - expected).abs() < 1e-9 * expected.abs(), "{} {expected}", speed[0]);

    let metrics = daemon.get_raw("/metrics").body_mut().read_to_string().unwrap();
    assert!(metrics.contains("jointbench_archive_owed 0.0"), "{metrics}");
}

#[test]
fn the_zero_of_the_torque_sensor_is_subtracted_once() {
    let folder = TempDir::new().unwrap();
    let daemon = daemon(folder.path(), false);
    let zero = made(&daemon, "torque_sensor_zero", json!({"duration_s": 60, "steady_nm_per_min": 1}));
    let applied = json!({"procedure": "torque_sensor_zero", "run": zero}).to_string();
    assert_eq!(daemon.post(&format!("/api/v1/bench/{BENCH}/calibrations"), &applied).0, 201);
    let id = run(&daemon);
    wait_until_archived(&daemon);

    let (_, stored) = daemon.get(&format!("/api/v1/runs/{id}"));
    assert!(stored["meta"]["torque_sensor_zero_nm"].as_f64().is_some_and(|zero_nm| zero_nm != 0.0), "{stored}");
    let means = jointbench_files::read(&file(&table(&daemon, id, "means")), &ReadOptions::default()).unwrap();
    let samples = daemon.get_raw(&format!("/api/v1/runs/{id}/export?format=parquet")).body_mut().read_to_vec().unwrap();
    let samples = jointbench_files::read_bytes("x.parquet", &samples, &ReadOptions::default()).unwrap();
    let [at_s, half_s] = [means.column("time_s").unwrap()[0], means.column("duration_s").unwrap()[0] / 2.0 + 1e-6];
    let rows = samples.column("time_s").unwrap().iter().zip(samples.column("link_torque_nm").unwrap());
    let within: Vec<f64> = rows.filter(|(t, _)| (*t - at_s).abs() < half_s).map(|(_, torque)| *torque).collect();
    let expected = within.iter().sum::<f64>() / within.len() as f64;
    let found = means.column("link_torque_nm").unwrap()[0];
    assert!((found - expected).abs() < 1e-9, "{found} {expected}");
}

#[test]
fn an_archive_that_is_away_disturbs_no_run_and_gets_what_it_is_owed() {
    let parent = TempDir::new().unwrap();
    let folder = parent.path().join("archive");
    let mut daemon = daemon(&folder, true);
    let began = Instant::now();
    let id = run(&daemon);
    let took = began.elapsed();
    assert!(took < Duration::from_secs(20), "the run took {took:?}");
    let failed = |why: &'static str| {
        move |archive: &Value| archive["last_error"].as_str().is_some_and(|error| error.contains(why))
    };
    let state = daemon.wait_for("/api/v1/archive", failed("does not exist"));
    assert_eq!((&state["owed"], &state["archived"]), (&json!(2), &json!(0)), "{state}");
    assert!(state["oldest_owed"].is_string(), "{state}");

    std::fs::write(&folder, "a file").unwrap();
    daemon.restart_with(None, |settings| settings.archive = described(&folder, true));
    retry(&daemon);
    daemon.wait_for("/api/v1/archive", failed("is no folder"));
    std::fs::remove_file(&folder).unwrap();

    // A file where a folder of the archive is needed: writing fails.
    std::fs::create_dir(&folder).unwrap();
    for content in ["means", "samples"] {
        std::fs::write(folder.join(content), "a file").unwrap();
    }
    retry(&daemon);
    daemon.wait_for("/api/v1/archive", failed("not available"));
    run(&daemon);
    for content in ["means", "samples"] {
        std::fs::remove_file(folder.join(content)).unwrap();
    }
    retry(&daemon);
    let state = wait_until_archived(&daemon);
    assert_eq!((&state["archived"], &state["failed"], &state["last_error"]), (&json!(4), &json!(0), &Value::Null));
    assert!(path_of(&daemon, &folder, "samples", id).is_file());
}

#[test]
fn a_file_with_other_data_is_not_replaced_and_the_same_data_count() {
    let parent = TempDir::new().unwrap();
    let folder = parent.path().join("archive");
    let mut daemon = daemon(&folder, false);
    let id = run(&daemon);
    daemon.wait_for("/api/v1/archive", |archive| archive["last_error"].is_string());
    let path = path_of(&daemon, &folder, "means", id);
    daemon.stop();
    let database = daemon.data.path().join("jointbench.db");
    let before = std::fs::read(&database).unwrap();
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    std::fs::write(&path, "other data").unwrap();
    daemon.restart_with(None, |settings| settings.archive = described(&folder, false));
    retry(&daemon);
    let state = wait_until_archived(&daemon);
    assert_eq!((&state["archived"], &state["failed"]), (&json!(0), &json!(1)), "{state}");
    assert!(state["last_error"].as_str().unwrap().contains("cannot be read"), "{state}");
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "other data");
    assert_eq!(table(&daemon, id, "means")["state"], "failed");

    std::fs::remove_file(&path).unwrap();
    retry(&daemon);
    assert_eq!(wait_until_archived(&daemon)["archived"], 1);
    let written = std::fs::metadata(&path).unwrap().modified().unwrap();
    let first = table(&daemon, id, "means");

    // The daemon ended after the file was written, before this was stored.
    daemon.stop();
    std::fs::write(&database, before).unwrap();
    std::fs::remove_file(daemon.data.path().join("jointbench.mark")).unwrap();
    daemon.restart_with(None, |settings| settings.archive = described(&folder, false));
    retry(&daemon);
    assert_eq!(wait_until_archived(&daemon)["archived"], 1);
    assert_eq!(table(&daemon, id, "means")["sha256"], first["sha256"]);
    assert_eq!(std::fs::metadata(&path).unwrap().modified().unwrap(), written);
    assert_eq!(files(&folder), [path]);
}

#[test]
fn samples_stay_in_the_store_if_their_file_is_damaged_or_missing() {
    let folder = TempDir::new().unwrap();
    let daemon = daemon(folder.path(), true);
    let id = run(&daemon);
    wait_until_archived(&daemon);
    let of_run = |path: &str| format!("/api/v1/runs/{id}/{path}");
    let file = file(&table(&daemon, id, "samples"));
    let mut damaged = std::fs::read(&file).unwrap();
    damaged[100] ^= 1;
    std::fs::write(&file, damaged).unwrap();
    let (status, problem) = daemon.delete(&of_run("samples"));
    assert!(status == 409 && problem["detail"].as_str().unwrap().contains("samples/part="), "{status}: {problem}");
    std::fs::remove_file(&file).unwrap();
    let (status, problem) = daemon.delete(&of_run("samples"));
    assert!(status == 409 && problem["detail"].as_str().unwrap().contains("not in the archive"), "{problem}");
    assert_eq!(daemon.get(&of_run("samples?px=20000")).0, 200);
}

/// Coefficients of a fit.
fn fitted(daemon: &TestDaemon, run: i64) -> Value {
    let request = json!({"run": run, "effects": ["coulomb", "viscous"]});
    let (status, model) = daemon.post("/api/v1/models", &request.to_string());
    assert_eq!(status, 201, "{model}");
    json!([model["rms"], model["validation_rms"], model["fit"]["parameters"], model["parameters"]])
}

#[test]
fn dropped_samples_are_named_and_give_the_same_result_after_an_import() {
    let folder = TempDir::new().unwrap();
    let daemon = daemon(folder.path(), true);
    let id = run(&daemon);
    wait_until_archived(&daemon);
    let of_run = |path: &str| format!("/api/v1/runs/{id}/{path}");
    let result = daemon.get(&of_run("identification")).1;
    let before = fitted(&daemon, id);
    let file = file(&table(&daemon, id, "samples"));

    let listed = daemon.get("/api/v1/archive/samples?older_than_s=0").1;
    assert_eq!((listed.as_array().unwrap().len(), &listed[0]["run"]), (1, &json!(id)), "{listed}");
    assert_eq!(daemon.get("/api/v1/archive/samples?older_than_s=3600").1, json!([]));
    assert_eq!(daemon.get("/api/v1/archive/samples?older_than_s=-1").0, 422);

    let command = |arguments: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_jointbench"));
        let command = command.arg("archive").args(arguments).args(["--daemon", &daemon.address()]);
        String::from_utf8(command.output().unwrap().stdout).unwrap()
    };
    let dropping = ["--drop-samples", "--older-than", "0h"];
    assert!(command(&[&dropping[..], &["--dry-run"]].concat()).contains(&format!("run {id}: ")));
    assert_eq!(daemon.get(&of_run("samples?px=100")).0, 200, "a dry run");
    let dropped = command(&dropping);
    assert!(dropped.contains(&format!("ok    run {id}: dropped")), "{dropped}");
    assert!(command(&[]).contains("samples dropped"));

    let (status, overview) = daemon.get(&of_run("samples?px=20000"));
    let points = overview["time_s"].as_array().map_or(0, Vec::len);
    assert!(status == 200 && overview["exact"] == false && points > 10, "the overview is kept: {points} points");
    assert_eq!(daemon.get(&format!("/api/v1/trends?search=id:{id}")).0, 200);
    for path in ["samples?px=20000&from_s=1", "statistics", "export?format=csv"] {
        let (status, problem) = daemon.get(&of_run(path));
        let detail = problem["detail"].as_str().unwrap_or_else(|| panic!("{path}: {problem}"));
        assert_eq!((status, &problem["type"]), (410, &json!("urn:jointbench:gone")), "{path}: {problem}");
        assert!(detail.contains(file.to_str().unwrap()) && detail.contains("jointbench import"), "{detail}");
    }
    let arrow = [("accept", "application/vnd.apache.arrow.stream")];
    assert_eq!(daemon.get_with(&of_run("samples"), &arrow).0, 410, "no stream begins");
    assert_eq!(daemon.get(&of_run("identification")).1, result, "the result is kept");
    assert!(table(&daemon, id, "samples")["dropped_at"].is_string());
    assert_eq!(daemon.delete(&of_run("samples")).0, 200, "a second time");
    let report = daemon.runtime.block_on(jointbench::store::verify(daemon.data.path())).unwrap();
    assert!(report.is_whole(), "{report:?}");

    let mut import = Command::new(env!("CARGO_BIN_EXE_jointbench"));
    let import = import.arg("import").arg(&file).args(["--daemon", &daemon.address()]).output().unwrap();
    assert!(import.status.success(), "{import:?}");
    let (_, runs) = daemon.get("/api/v1/runs");
    let imported = runs["runs"][0]["id"].as_i64().unwrap();
    assert_ne!(imported, id);
    let (_, run) = daemon.get(&format!("/api/v1/runs/{imported}"));
    assert_eq!((&run["unit"]["serial"], &run["archive"]), (&json!("SN7"), &Value::Null), "{run}");
    assert_eq!(fitted(&daemon, imported), before);
}

#[test]
fn without_an_archive_a_run_owes_nothing() {
    let daemon = TestDaemon::start();
    let id = run(&daemon);
    let (_, state) = daemon.get("/api/v1/archive");
    assert_eq!((&state["url"], &state["owed"]), (&Value::Null, &json!(0)), "{state}");
    let (status, problem) = daemon.delete(&format!("/api/v1/runs/{id}/samples"));
    assert!(status == 409 && problem["detail"].as_str().unwrap().contains("not archived"), "{problem}");
    assert!(!daemon.get_raw("/metrics").body_mut().read_to_string().unwrap().contains("archive"));
}
