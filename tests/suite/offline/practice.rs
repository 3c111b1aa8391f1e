//! The practice cases with a hidden effect, evaluated by the rules of `hidden-effects/README.md`.

use super::{effects, json};
use crate::program::run;
use crate::shared::shared;
use serde_json::Value;
use std::path::Path;

fn read(path: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(path).expect("a file")).expect("JSON")
}

fn groups(answer: &Value) -> Vec<Vec<&str>> {
    answer["accept"].as_array().expect("groups").iter().map(effects).collect()
}

/// Checks one case and returns the problem.
fn judge(folder: &Path) -> Result<(), String> {
    let answer = read(&folder.join("answer.json"));
    let meta = read(&folder.join("meta.json"));
    let diagnosis = json("diagnose", folder, &[]);
    let discovery = json("discover", folder, &[]);
    let suggested = effects(&diagnosis["suggestions"]);
    let baseline = effects(&meta["baseline"]);
    let added: Vec<&str> =
        effects(&discovery["model"]).into_iter().filter(|effect| !baseline.contains(effect)).collect();
    let failure = format!("suggested {suggested:?}, added {added:?}, verdict {}", discovery["verdict"]);
    let is_right = match answer["verdict"].as_str() {
        Some("adequate") => diagnosis["verdict"] == "adequate" && suggested.is_empty() && added.is_empty(),
        Some("unexplained_structure") => discovery["verdict"] == "unexplained_structure",
        _ => {
            let accepted = groups(&answer);
            let optional = effects(&answer["optional"]);
            let in_group = |effect: &&str| accepted.iter().any(|group| group.contains(effect));
            let counted = added.iter().filter(|effect| in_group(effect) || !optional.contains(effect)).count();
            let floor = discovery["noise_floor_rms"].as_f64().unwrap_or(0.0);
            let reached = discovery["steps"].as_array().and_then(|steps| steps.last()?["validation_rms"].as_f64());
            suggested.first().is_some_and(in_group)
                && counted == accepted.len()
                && accepted.iter().all(|group| added.iter().any(|effect| group.contains(effect)))
                && reached.is_some_and(|rms| rms <= 1.1 * floor)
        }
    };
    if is_right { Ok(()) } else { Err(failure) }
}

/// No effect is missing in either run; one of the runs has no repeats.
#[test]
fn a_verdict_that_decides_nothing_says_so_and_ends_with_3() {
    let Some(case) = shared("hidden-effects/friction-none") else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let whole = read_table(&case);
    let lines: Vec<&str> = whole.lines().collect();
    let names: Vec<&str> = lines[0].split(',').collect();
    let repeat = names.iter().position(|name| *name == "repeat").expect("the column");
    let first = |line: &&&str| line.split(',').nth(repeat) == Some("0");
    let once: Vec<&str> = lines[..1].iter().chain(lines[1..].iter().filter(first)).copied().collect();
    for (name, lines) in [("whole", &lines), ("once", &once)] {
        let table = folder.path().join(format!("{name}.csv"));
        std::fs::write(&table, lines.join("\n") + "\n").expect("a table");
        std::fs::copy(case.join("meta.json"), folder.path().join("meta.json")).expect("facts");
        for verb in ["diagnose", "discover"] {
            let output = run(&[verb, &table.display().to_string(), "--json"]);
            let diagnosis: Value = serde_json::from_slice(&output.stdout).expect("JSON");
            assert_eq!(diagnosis["verdict"], "adequate", "{verb} {name}: {}", diagnosis["summary"]);
            let code = if diagnosis["undecided"].is_string() { 3 } else { 0 };
            assert_eq!(
                (output.status.code(), name == "once"),
                (Some(code), code == 3),
                "{verb}: {}",
                diagnosis["summary"]
            );
        }
    }
}

fn read_table(case: &Path) -> String {
    let packed = std::fs::File::open(case.join("run.csv.gz")).expect("a table");
    std::io::read_to_string(flate2::read::GzDecoder::new(packed)).expect("text")
}

#[test]
fn the_practice_cases_are_right() {
    let Some(cases) = shared("hidden-effects") else { return };
    let mut wrong = Vec::new();
    for entry in std::fs::read_dir(cases).expect("a folder") {
        let folder = entry.expect("an entry").path();
        if folder.is_dir()
            && let Err(failure) = judge(&folder)
        {
            wrong.push(format!("{}: {failure}", folder.file_name().unwrap_or_default().display()));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
