//! Malformed files are refused with the position of the error, and leave no data behind.

use crate::program::{jointbench, run, stderr, stdout};

const HEADER: &str = "time_s,motor_position_rad,motor_current_a\n";

#[test]
#[cfg(unix)]
fn a_reader_that_has_seen_enough_is_no_fault() {
    use std::os::unix::process::ExitStatusExt;
    let folder = tempfile::tempdir().expect("a folder");
    let table = folder.path().join("run.csv");
    std::fs::write(&table, format!("{HEADER}0,0,0\n0.1,0,0\n")).expect("a table");
    std::fs::write(folder.path().join("meta.json"), r#"{"kind":"friction","torque_constant_nm_per_a":0.04}"#)
        .expect("facts");
    let (reader, writer) = std::io::pipe().expect("a pipe");
    drop(reader);
    let mut import = jointbench();
    import.arg("import").arg(&table).arg("--data").arg(folder.path().join("data"));
    let output = import.stdout(writer).output().expect("jointbench starts");
    assert!(output.stderr.is_empty(), "{}", stderr(&output));
    assert_eq!(output.status.signal(), Some(13), "the first word that nobody reads ends it");
}

#[test]
fn the_place_of_the_fault_is_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let data = folder.path().join("data");
    std::fs::write(folder.path().join("meta.json"), r#"{"kind":"friction","torque_constant_nm_per_a":0.04}"#)
        .expect("facts");
    for (what, rows, line, words) in [
        ("text", "0,0,0\n0.1,abc,0\n", "3", "motor_position_rad"),
        ("narrow", "0,0,0\n0.1,0,0\n0.2,0\n", "4", "3"),
        ("back", "0,0,0\n0.2,0,0\n0.1,0,0\n", "4", "time_s"),
        ("nan", "0,0,0\n0.1,0,NaN\n", "3", "motor_current_a"),
    ] {
        let path = folder.path().join(format!("{what}.csv"));
        std::fs::write(&path, format!("{HEADER}{rows}")).expect("a table");
        let output =
            jointbench().arg("import").arg(&path).arg("--data").arg(&data).output().expect("jointbench starts");
        let message = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{what}: {message}");
        assert!(
            message.contains(&format!("{what}.csv")) && message.contains(line) && message.contains(words),
            "{what}: {message}"
        );
    }
    // The store contains no run.
    let output = run(&["export", "1", "--format", "csv", "--data", &data.display().to_string()]);
    assert_ne!(output.status.code(), Some(0), "{}", stdout(&output));
}
