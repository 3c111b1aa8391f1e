//! Regression test of answers: digests of `diagnose`, `discover`, `fit`, `residuals` and `next_run` over hundreds of
//! runs, compared with those in this folder.
//!
//! A change that intends to change answers renews the digests, and its commit says so:
//!
//! `JOINTBENCH_DIGESTS=write cargo test -p jointbench-model --test digests`
//!
//! The digests hold for every number of threads (`RAYON_NUM_THREADS=1`). Libraries of other machines may round sines
//! differently: if the first line of a file differs, its answers are not compared.

mod answers;
mod arithmetic;
mod cases;
#[path = "../common/mod.rs"]
mod common;
#[allow(dead_code, unused_imports, reason = "the example uses the rest")]
#[path = "../../examples/evaluate/made/mod.rs"]
mod made;

use answers::answers;
use cases::Case;
use rayon::prelude::*;
use std::path::PathBuf;

/// With fewer runs, some paths of the diagnosis would not be tested.
const FEWEST: usize = 400;

#[test]
fn simulated_runs_are_answered_as_before() {
    let cases = cases::machines().par_bridge().flat_map_iter(cases::of_machine);
    let mut lines: Vec<String> = cases.map(|case| line(&case)).collect();
    lines.sort();
    assert!(lines.len() >= FEWEST, "{} runs", lines.len());
    compare("simulated.txt", &lines);
}

#[test]
fn recordings_are_answered_as_before() {
    let Some(data) = common::shared("data") else { return };
    let lines: Vec<String> = cases::recordings(&data).into_par_iter().map(|case| line(&case)).collect();
    compare("recordings.txt", &lines);
}

fn line(case: &Case) -> String {
    format!("{} {}", case.name, answers(case))
}

fn compare(file: &str, lines: &[String]) {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/digests").join(file);
    let found: Vec<String> = std::iter::once(arithmetic::line()).chain(lines.iter().cloned()).collect();
    if std::env::var("JOINTBENCH_DIGESTS").is_ok_and(|what| what == "write") {
        std::fs::write(&path, found.join("\n") + "\n").unwrap();
        return;
    }
    let kept = std::fs::read_to_string(&path).unwrap();
    let kept: Vec<&str> = kept.lines().collect();
    if kept.first() != found.first().map(String::as_str).as_ref() {
        println!("SKIPPED: this machine rounds another way than the one on which {} was written", path.display());
        return;
    }
    let differ: Vec<String> =
        found.iter().zip(&kept).filter(|(f, k)| f != *k).map(|(f, k)| format!("{k}\n{f}")).collect();
    assert!(differ.is_empty(), "{} of {} answers changed:\n{}", differ.len(), lines.len(), differ.join("\n"));
    assert_eq!(found.len(), kept.len(), "{file} holds other runs");
}
