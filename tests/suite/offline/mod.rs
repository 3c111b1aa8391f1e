//! `fit`, `diagnose`, `discover`, `import` and `export` on files, without a daemon.

mod elsewhere;
mod emps;
mod maps;
mod practice;
mod refused;
mod report;
mod round_trip;
mod simulate;
mod user_effects;

use crate::program::{jointbench, stderr};
use serde_json::Value;
use std::path::Path;

/// Output of a command with `--json`.
fn json(verb: &str, folder: &Path, more: &[&str]) -> Value {
    let table = ["run.csv", "run.csv.gz"].map(|name| folder.join(name)).into_iter().find(|path| path.exists());
    let table = table.expect("a run table");
    let output = jointbench().arg(verb).arg(&table).args(more).arg("--json").output().expect("jointbench starts");
    serde_json::from_slice(&output.stdout)
        .unwrap_or_else(|fault| panic!("{verb} {}: {fault}: {}", table.display(), stderr(&output)))
}

fn effects(list: &Value) -> Vec<&str> {
    list.as_array().into_iter().flatten().filter_map(|effect| effect.as_str().or(effect["effect"].as_str())).collect()
}
