//! Exported data is identical to the imported data.

use crate::program::{jointbench, stderr};
use crate::shared::shared;
use jointbench_files::{ReadOptions, read};
use jointbench_instrument::RunTable;
use std::path::Path;

fn done(command: &mut std::process::Command) {
    let output = command.output().expect("jointbench starts");
    assert!(output.status.success(), "{command:?}: {}", stderr(&output));
}

fn table(path: &Path) -> RunTable {
    read(path, &ReadOptions::default()).unwrap_or_else(|fault| panic!("{fault}"))
}

#[test]
fn nothing_is_made_where_nothing_is() {
    let folder = tempfile::tempdir().expect("a folder");
    let data = folder.path().join("attic");
    let output =
        jointbench().args(["export", "1", "--format", "csv", "--data"]).arg(&data).output().expect("it starts");
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("no store in") && !data.exists(), "{}", stderr(&output));
    // An explicit address has priority over a folder.
    let nowhere = ["export", "1", "--format", "csv", "--daemon", "127.0.0.1:9", "--data"];
    let output = jointbench().args(nowhere).arg(&data).output().expect("it starts");
    assert!(stderr(&output).contains("no daemon answers at http://127.0.0.1:9"), "{}", stderr(&output));
    // An address from the environment has no priority over an explicit folder.
    let mut command = jointbench();
    command.env("JOINTBENCH_URL", "http://127.0.0.1:9").args(["export", "1", "--format", "csv", "--data"]).arg(&data);
    let output = command.output().expect("it starts");
    assert!(stderr(&output).contains("no store in"), "{}", stderr(&output));
}

#[test]
fn import_and_export_keep_every_bit() {
    let Some(source) = shared("data/placid-b5zd-brake/run.csv") else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let data = folder.path().join("data");
    done(jointbench().arg("import").arg(&source).arg("--data").arg(&data));
    for format in ["csv", "parquet"] {
        let out = folder.path().join(format!("out.{format}"));
        done(jointbench().args(["export", "1", "--format", format, "--output"]).arg(&out).arg("--data").arg(&data));
        let (before, after) = (table(&source), table(&out));
        assert_eq!(before.kind(), after.kind());
        assert_eq!(before.trace().columns(), after.trace().columns(), "{format}");
        assert_eq!(before.meta().baseline, after.meta().baseline);
    }
}
