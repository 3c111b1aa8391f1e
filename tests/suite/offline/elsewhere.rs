//! A stored model on other runs, and files that are given with it: differences are reported.

use super::user_effects::{done, run_in, write_run};
use crate::program::{stderr, stdout};
use std::path::Path;

const MODEL: &str = "load_transmission,coulomb,viscous";

fn fitted(folder: &Path) {
    write_run(folder);
    done(folder, &["fit", "run.csv", "--model", MODEL, "--out", "model.json"]);
}

fn refused(folder: &Path, arguments: &[&str], words: &[&str]) {
    let output = run_in(folder, arguments);
    let message = stderr(&output);
    assert!(matches!(output.status.code(), Some(2 | 3)), "{arguments:?}: {message}");
    assert!(!message.contains("os error"), "{message}");
    words.iter().for_each(|words| assert!(message.contains(words), "{words}: {message}"));
}

#[test]
fn a_missing_column_of_another_run_is_reported() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    fitted(folder);
    let text = done(folder, &["model", "evaluate", "model.json", "run.csv"]);
    assert!(text.starts_with("on run.csv: error ") && !text.contains("note"), "{text}");
    assert!(text.contains("steady-state means, 80 %") && text.contains("(7200 samples)"), "{text}");

    // The fifth column is the link torque.
    let table = std::fs::read_to_string(folder.join("run.csv")).expect("a table");
    let without = |line: &str| {
        let fields = line.split(',').enumerate().filter(|(i, _)| *i != 4).map(|(_, field)| field);
        fields.collect::<Vec<&str>>().join(",")
    };
    std::fs::create_dir(folder.join("bare")).expect("a folder");
    let bare: Vec<String> = table.lines().map(without).collect();
    std::fs::write(folder.join("bare/run.csv"), bare.join("\n")).expect("a table");
    let meta = std::fs::read_to_string(folder.join("meta.json")).expect("facts");
    std::fs::write(folder.join("bare/meta.json"), meta.replace("50", "100")).expect("facts");
    let text = done(folder, &["model", "evaluate", "model.json", "bare"]);
    assert!(text.contains("load_transmission is omitted, because the run has no column link_torque_nm"), "{text}");
    assert!(text.contains("gear_ratio is 100 in the facts of this run and 50 in those of the fitted one"), "{text}");

    done(folder, &["fit", "bare", "--model", MODEL, "--out", "bare.json"]);
    let text = done(folder, &["model", "evaluate", "bare.json", "run.csv"]);
    assert!(text.contains("load_transmission counts here, but the run that was fitted had no column"), "{text}");
    done(folder, &["fit", "run.csv", "--model", "coulomb,load_linear", "--out", "loaded.json"]);
    refused(folder, &["model", "evaluate", "loaded.json", "bare"], &["bare: effect load_linear", "link_torque_nm"]);
}

#[test]
fn a_file_that_will_not_do_is_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    fitted(folder);
    done(folder, &["model", "export", "model.json", "--format", "c", "-o", "joint.h"]);
    let header = std::fs::read_to_string(folder.join("joint.h")).expect("a header");
    assert!(!header.contains("acceleration") && header.contains("Fitted where velocity is -64"), "{header}");
    refused(folder, &["model", "evaluate", "joint.h", "run.csv"], &["joint.h", "give a JSON file", "--format json"]);
    refused(folder, &["model", "evaluate", "run.csv", "model.json"], &["run.csv", "first the model, then the run"]);
    refused(
        folder,
        &["model", "compare", "model.json", "nope.json", "run.csv"],
        &["nope.json: there is no such file: check the name"],
    );
    refused(folder, &["fit", "run.csv", "--effect-file", "nope.toml"], &["nope.toml: there is no such file"]);
    refused(folder, &["diagnose", "1"], &["file 1 does not exist", "jointbench export 1"]);
    refused(folder, &["model", "export", "model.json", "--format", "c", "-o", "."], &[". is a folder: give the file"]);
    refused(folder, &["fit", "run.csv", "--out", "."], &[". is a folder: give the file"]);
    refused(folder, &["fit", "run.csv", "--out", "no/model.json"], &["no/model.json", "folder no does not exist"]);

    std::fs::create_dir(folder.join("short")).expect("a folder");
    refused(folder, &["fit", "short"], &["short is a folder without run.csv"]);
    let table = std::fs::read_to_string(folder.join("run.csv")).expect("a table");
    let few: Vec<&str> = table.lines().take(9).collect();
    std::fs::write(folder.join("short/run.csv"), few.join("\n")).expect("a table");
    std::fs::copy(folder.join("meta.json"), folder.join("short/meta.json")).expect("facts");
    refused(folder, &["diagnose", "short"], &["short: too few samples: 8 usable samples"]);
    refused(folder, &["fit", "short", "short/run.csv"], &["named twice"]);
    std::fs::write(folder.join("short/run.csv"), &table).expect("a table");
    refused(folder, &["diagnose", "run.csv", "short"], &["runs number 1 and 2 of the list contain the same samples"]);
    let facts = std::fs::read_to_string(folder.join("meta.json")).expect("facts");
    std::fs::write(folder.join("short/meta.json"), facts.replace("gear_ratio", "gear_ratoi")).expect("facts");
    refused(
        folder,
        &["diagnose", "short"],
        &["short/meta.json, line", "gear_ratoi is not known: did you mean gear_ratio?"],
    );
    let data = folder.join("data").display().to_string();
    refused(folder, &["import", "short/run.csv", "--data", &data], &["did you mean gear_ratio?"]);
    done(folder, &["import", "run.csv", "--data", &data]);
    let text = done(folder, &["import", "run.csv", "--data", &data]);
    assert!(text.contains("its samples are identical to those of run 1"), "{text}");
    assert!(!text.contains("attention"), "{text}");
    let text = done(folder, &["import", "run.csv", "--scale", "motor_current_a=1000", "--data", &data]);
    assert!(text.contains("warning: motor_current_a with the torque constant and the gear ratio is "), "{text}");
    refused(
        folder,
        &["export", "1", "-o", "x.foo", "--data", &data],
        &["unknown file extension .foo", ".csv, .parquet"],
    );
    assert!(!folder.join("x.foo").exists(), "nothing is written");
    refused(folder, &["check", "joint-a-mok", "--print"], &["did you mean joint-a-mock?", "puma-mock"]);
    refused(folder, &["check", "nosuch"], &["file not found", "joint-a-mock"]);
}

#[test]
fn nothing_is_advised_before_contradicting_columns_are_mended() {
    let folder = tempfile::tempdir().expect("a folder");
    write_run(folder.path());
    for verb in ["diagnose", "discover"] {
        let diagnose = |more: &[&str]| {
            let output = run_in(folder.path(), &[&[verb, "run.csv"], more].concat());
            (output.status.code(), stdout(&output))
        };
        let (code, whole) = diagnose(&[]);
        assert!(code == Some(0) && whole.contains("recommended next run"), "{whole}");
        let (code, broken) = diagnose(&["--scale", "motor_current_a=1000"]);
        assert!(
            code == Some(3) && broken.contains("Data problem: motor_current_a with the torque constant"),
            "{broken}"
        );
        for advice in ["recommended next run", "define your own effect", "ΔBIC over independent blocks"] {
            assert!(!broken.contains(advice), "{broken}");
        }
        let json = stdout(&run_in(folder.path(), &[verb, "run.csv", "--scale", "motor_current_a=1000", "--json"]));
        let json: serde_json::Value = serde_json::from_str(&json).expect("JSON");
        assert!(json["experiment"].is_null(), "{}", json["experiment"]);
    }
}

#[test]
fn the_library_is_listed() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    let text = done(folder, &["procedures"]);
    assert!(text.lines().any(|line| line.starts_with("friction ")), "{text}");
    assert!(done(folder, &["procedures", "friction"]).contains("--set load_levels=3"), "what can be set");
    refused(folder, &["procedures", "frction"], &["unknown procedure frction: did you mean friction?"]);
    let text = done(folder, &["effects"]);
    assert!(text.contains("  stribeck ") && text.contains("jointbench demo --effect"), "{text}");
    assert!(done(folder, &["effects", "stribeck"]).contains("residual if missing: "), "what it means");
    let text = done(folder, &["effects", "load_linear"]);
    let (plain, weighed) =
        text.split_once("a gravity load that the torque sensor does not measure:").expect("both formulas");
    assert!(plain.contains("\n  μ·|τ_link/N|·sign ω\n") && weighed.contains("|τ_link/N + g_c·cos θ_link"), "{text}");
    refused(folder, &["effects", "stribek"], &["unknown effect stribek: did you mean stribeck?"]);
}

#[test]
fn advice_names_the_axis_of_the_summary_as_a_formula_does() {
    let folder = tempfile::tempdir().expect("a folder");
    write_run(folder.path());
    let text = stdout(&run_in(folder.path(), &["diagnose", "run.csv"]));
    assert!(text.contains("ΔBIC over independent blocks") && !text.contains("as a formula of"), "{text}");
    // A bump over the speed is not an effect of the library; the rub depends on speed and load.
    let table = std::fs::read_to_string(folder.path().join("run.csv")).expect("a table");
    let bumped = table.lines().enumerate().map(|(i, line)| {
        let mut fields: Vec<String> = line.split(',').map(str::to_owned).collect();
        if i > 0 {
            let velocity: f64 = fields[2].parse().expect("a velocity");
            let current: f64 = fields[3].parse().expect("a current");
            fields[3] = format!("{}", current + 0.2 * f64::from(u8::from((9.0..40.0).contains(&velocity.abs()))));
        }
        fields.join(",")
    });
    let bumped: Vec<String> = bumped.collect();
    std::fs::write(folder.path().join("run.csv"), bumped.join("\n")).expect("a table");
    let text = stdout(&run_in(folder.path(), &["discover", "run.csv", "--max-effects", "0"]));
    assert!(text.contains("The requested number of effects is reached"), "{text}");
    assert!(text.contains("it is largest over motor velocity and link torque, and a function"), "{text}");
    assert!(text.contains("as a formula of velocity and load with --own"), "{text}");
    let text = stdout(&run_in(folder.path(), &["diagnose", "run.csv"]));
    assert!(text.contains("as a formula of velocity and load") && !text.contains("ΔBIC"), "{text}");
}
