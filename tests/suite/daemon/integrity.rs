//! Stored data does not change, or the change is reported.

use super::bench;
use crate::program::{Daemon, run, stderr, stdout};
use serde_json::Value;
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

fn verify(data: &Path) -> (Option<i32>, Value) {
    let done = run(&["verify", "--json", "--data", data.to_str().expect("UTF-8")]);
    (done.status.code(), serde_json::from_str(&stdout(&done)).unwrap_or_else(|_| panic!("{}", stderr(&done))))
}

#[test]
fn one_daemon_has_the_folder_until_its_terminal_is_closed() {
    let folder = tempfile::tempdir().expect("a folder");
    let (config, data) = (bench(folder.path(), "b", 1.0), folder.path().join("data"));
    let daemon = Daemon::serve(&data, &config);
    std::fs::remove_file(data.join("lock")).expect("the lock file is there");
    let config = config.to_str().expect("UTF-8");
    let second =
        run(&["serve", "--listen", "127.0.0.1:0", "--config", config, "--data", data.to_str().expect("UTF-8")]);
    assert_eq!(second.status.code(), Some(2), "{}", stderr(&second));
    assert!(stderr(&second).contains("in use by another jointbench"), "{}", stderr(&second));
    assert_eq!(verify(&data).0, Some(0), "beside the daemon");

    let health = daemon.get("/health");
    assert_eq!(health["store"]["damaged"], serde_json::json!([]), "{health}");
    let hung_up = Command::new("kill").args(["-HUP", &health["process"].to_string()]).status();
    assert!(hung_up.expect("kill is there").success());
    // Only an orderly end removes the write-ahead log.
    let until = Instant::now() + Duration::from_secs(30);
    while data.join("jointbench.db-wal").exists() {
        assert!(Instant::now() < until, "the daemon ends when its terminal does; this test cannot run under nohup");
        std::thread::sleep(Duration::from_millis(50));
    }
    assert_eq!(verify(&data).0, Some(0));
}

#[test]
fn a_changed_byte_is_named_and_hides_no_other_run() {
    let folder = tempfile::tempdir().expect("a folder");
    let data = folder.path().join("data");
    let to_data = data.to_str().expect("UTF-8");
    for constant in ["0.0641", "0.0642"] {
        let table = folder.path().join("run.csv");
        let rows: String = (0..50).map(|row| format!("{},{},0.1\n", f64::from(row) * 0.01, row)).collect();
        std::fs::write(&table, format!("time_s,motor_position_rad,motor_current_a\n{rows}")).expect("written");
        let meta = format!("{{\"kind\": \"friction\", \"torque_constant_nm_per_a\": {constant}, \"gear_ratio\": 50}}");
        std::fs::write(folder.path().join("run.meta.json"), meta).expect("written");
        let imported = run(&["import", table.to_str().expect("UTF-8"), "--data", to_data]);
        assert_eq!(imported.status.code(), Some(0), "{}", stderr(&imported));
    }
    // The end of an import may be only in the write-ahead log. A restored copy is one complete file.
    let copy = folder.path().join("lab.db");
    let copy = copy.to_str().expect("UTF-8");
    let data = folder.path().join("restored");
    for (command, place) in [("backup", to_data), ("restore", data.to_str().expect("UTF-8"))] {
        let done = run(&[command, copy, "--data", place]);
        assert_eq!(done.status.code(), Some(0), "{}", stderr(&done));
    }
    let to_data = data.to_str().expect("UTF-8");
    assert_eq!(verify(&data).0, Some(0));

    let file = data.join("jointbench.db");
    let mut bytes = std::fs::read(&file).expect("the database is there");
    // At every occurrence: an unused page may contain it, too.
    let places: Vec<usize> = (0..bytes.len() - 6).filter(|at| &bytes[*at..at + 6] == b"0.0641").collect();
    assert!(!places.is_empty(), "the fact is in the file");
    places.iter().for_each(|at| bytes[at + 5] = b'9');
    std::fs::write(&file, bytes).expect("written");

    let (code, report) = verify(&data);
    assert_eq!(
        (code, &report["damaged"][0]["run"], &report["damaged"][0]["table"]),
        (Some(1), &1.into(), &"runs".into())
    );
    let list = run(&["runs", "--json", "--data", to_data]);
    let list: Value = serde_json::from_str(&stdout(&list)).expect("JSON");
    assert_eq!(list["total"], 2, "{list}");
    assert!(list["runs"][0]["damaged"].is_null() && list["runs"][1]["damaged"].is_string(), "{list}");
    let refused = run(&["export", "1", "--data", to_data]);
    assert!(stderr(&refused).contains("table runs, id 1"), "{}", stderr(&refused));
}
