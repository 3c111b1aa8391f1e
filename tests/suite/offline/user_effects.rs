//! Users' effects and models on the command line.

use crate::program::{Daemon, jointbench, stderr, stdout};
use serde_json::Value;
use std::path::Path;
use std::process::Output;

const META: &str = r#"{"kind": "friction", "torque_constant_nm_per_a": 0.1, "gear_ratio": 50,
    "baseline": ["load_transmission", "coulomb", "viscous"]}"#;
const RUB: &str = "rub: tau = a * tanh(velocity / w0) * abs(load); a [1] 0..1; w0 [rad/s] 1..100";
const FILE: &str = r#"
[[effect]]
id = "rub"
formula = "tau = a * tanh(velocity / w0) * abs(load)"
sentence = "Something rubs, the more the faster and the more loaded."
parameters = [
    { name = "a", unit = "1", min = 0, max = 1 },
    { name = "w0", unit = "rad/s", min = 1, max = 100, start = [5, 50] },
]
"#;

/// Writes a run of speeds and loads with a rub to a folder.
pub fn write_run(folder: &Path) {
    let mut table =
        String::from("time_s,motor_position_rad,motor_velocity_rad_s,motor_current_a,link_torque_nm,segment,repeat\n");
    let (mut time, mut position, mut segment, mut noise) = (0.0f64, 0.0f64, 0, 9u64);
    for repeat in 0..2 {
        for load in [2.0, 8.0, 20.0] {
            for velocity in [2.0, -4.0, 8.0, -16.0, 32.0, -64.0, 64.0, -32.0, 16.0, -8.0, 4.0, -2.0f64] {
                for _ in 0..100 {
                    time += 0.004;
                    position += 0.004 * velocity;
                    noise = noise.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                    let error = 4e-3 * ((noise >> 40) as f64 / (1u64 << 24) as f64 - 0.5);
                    let rub = 0.05 * (velocity / 12.0).tanh() * load / 50.0;
                    let torque = 0.03 * velocity.signum() + 1e-4 * velocity + rub + load / 50.0 + error;
                    table += &format!("{time},{position},{velocity},{},{load},{segment},{repeat}\n", torque / 0.1);
                }
                segment += 1;
            }
        }
    }
    std::fs::write(folder.join("run.csv"), table).expect("a table");
    std::fs::write(folder.join("meta.json"), META).expect("facts");
    std::fs::write(folder.join("effects.toml"), FILE).expect("effects");
}

pub fn run_in(folder: &Path, arguments: &[&str]) -> Output {
    jointbench().args(arguments).current_dir(folder).output().expect("jointbench starts")
}

pub fn done(folder: &Path, arguments: &[&str]) -> String {
    let output = run_in(folder, arguments);
    assert!(output.status.success(), "{arguments:?}: {}", stderr(&output));
    stdout(&output)
}

#[test]
fn an_effect_in_one_line_and_one_in_a_file_are_the_same() {
    let folder = tempfile::tempdir().expect("a folder");
    write_run(folder.path());
    let model = "load_transmission,coulomb,viscous,rub";
    let inline = done(folder.path(), &["fit", "run.csv", "--own", RUB, "--model", model, "--json"]);
    let from_file =
        done(folder.path(), &["fit", "run.csv", "--effect-file", "effects.toml", "--model", model, "--json"]);
    let value = |text: &str| -> f64 {
        let fit: Value = serde_json::from_str(text).expect("JSON");
        let named = |p: &&Value| p["name"] == "w0";
        fit["parameters"].as_array().expect("parameters").iter().find(named).expect("w0")["value"].as_f64().expect("w0")
    };
    assert!((value(&inline) - 12.0).abs() < 1.0, "{inline}");
    assert!((value(&inline) / value(&from_file) - 1.0).abs() < 1e-3);
    let diagnosis = done(folder.path(), &["diagnose", "run.csv", "--own", RUB, "--json"]);
    let diagnosis: Value = serde_json::from_str(&diagnosis).expect("JSON");
    assert_eq!(diagnosis["suggestions"][0]["effect"], "rub", "{}", diagnosis["summary"]);
}

#[test]
fn a_caret_stands_below_the_mistake() {
    let folder = tempfile::tempdir().expect("a folder");
    write_run(folder.path());
    let output = run_in(folder.path(), &["fit", "run.csv", "--own", "rub: tau = a * velocty; a [Nm]"]);
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{message}");
    let below = "  rub: tau = a * velocty; a [Nm]\n                 ^^^^^^^\n";
    assert!(message.contains("did you mean velocity?") && message.ends_with(below), "{message}");

    let seconds = RUB.replace("[rad/s]", "[s]");
    let message = stderr(&run_in(folder.path(), &["diagnose", "run.csv", "--own", &seconds]));
    assert!(message.contains("tanh takes a plain number, but this is in 1/s²") && message.contains("^^"), "{message}");
    // The unit is valid for a sliding joint; this joint rotates.
    let metres = RUB.replace("[rad/s]", "[m/s]");
    let message = stderr(&run_in(folder.path(), &["diagnose", "run.csv", "--own", &metres]));
    assert!(message.contains("note: effect rub: tanh takes a plain number, but this is in 1/m"), "{message}");
    let response = "rub: tau = a * motor_torque; a [1]";
    let message = stderr(&run_in(folder.path(), &["diagnose", "run.csv", "--own", response]));
    assert!(
        message.contains("note: effect rub: motor_torque is the response that a friction model predicts"),
        "{message}"
    );
    let output = run_in(folder.path(), &["fit", "run.csv", "--own", RUB]);
    assert_eq!(output.status.code(), Some(2), "an effect that takes no part");
    assert!(stderr(&output).contains("--model load_transmission,coulomb,viscous,rub"), "{}", stderr(&output));

    std::fs::write(folder.path().join("effects.toml"), FILE.replace("/ w0", "/ w1")).expect("effects");
    let message = stderr(&run_in(folder.path(), &["diagnose", "run.csv", "--effect-file", "effects.toml"]));
    assert!(message.contains("effects.toml: effect rub: w1") && message.contains(" ^^\n"), "{message}");
    std::fs::write(folder.path().join("effects.toml"), FILE.replace("unit", "units")).expect("effects");
    let output = run_in(folder.path(), &["diagnose", "run.csv", "--effect-file", "effects.toml"]);
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    assert!(stderr(&output).contains("effects.toml") && stderr(&output).contains("units"), "{}", stderr(&output));
}

#[test]
fn a_model_goes_out_and_is_held_against_runs() {
    let folder = tempfile::tempdir().expect("a folder");
    write_run(folder.path());
    let model = "load_transmission,coulomb,viscous,rub";
    done(folder.path(), &["fit", "run.csv", "--out", "old.json"]);
    done(folder.path(), &["fit", "run.csv", "--own", RUB, "--model", model, "--out", "new.json"]);
    let held = done(folder.path(), &["model", "evaluate", "new.json", "run.csv", "--json"]);
    let held: Value = serde_json::from_str(&held).expect("JSON");
    assert!(held["rms"].as_f64().is_some_and(|rms| rms < 1e-3), "{held}");
    let text = done(folder.path(), &["model", "compare", "old.json", "new.json", "run.csv"]);
    assert!(text.contains("only in second  rub"), "{text}");
    for (format, words) in
        [("c", "joint_friction_fitted"), ("lut", "load_nm"), ("mujoco", "<joint "), ("urdf", "<dynamics ")]
    {
        assert!(done(folder.path(), &["model", "export", "new.json", "--format", format]).contains(words), "{format}");
    }
    done(folder.path(), &["model", "export", "new.json", "--format", "json", "-o", "again.json"]);
    let bytes = |name: &str| std::fs::read(folder.path().join(name)).expect("a model");
    assert!(bytes("new.json") == bytes("again.json"), "bit for bit");
    std::fs::write(folder.path().join("none.json"), "{}").expect("no model");
    let output = run_in(folder.path(), &["model", "evaluate", "none.json", "run.csv"]);
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    assert!(stderr(&output).contains("none.json: this is no exported model"), "{}", stderr(&output));
}

#[test]
fn a_model_that_went_out_comes_into_the_store_again() {
    let folder = tempfile::tempdir().expect("a folder");
    write_run(folder.path());
    let model = "load_transmission,coulomb,viscous,rub";
    done(folder.path(), &["fit", "run.csv", "--own", RUB, "--model", model, "--out", "new.json"]);
    let refused = |arguments: &[&str]| {
        let output = run_in(folder.path(), arguments);
        assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
        stderr(&output)
    };
    let message = refused(&["model", "import", "new.json", "--run", "1"]);
    assert!(message.contains("no store in jointbench-data: give its folder with --data"), "{message}");
    done(folder.path(), &["import", "run.csv"]);
    let message = refused(&["model", "import", "new.json", "--run", "7"]);
    assert!(message.contains("new.json: run 7 does not exist"), "{message}");
    let text = done(folder.path(), &["model", "import", "new.json", "--run", "1"]);
    assert!(text.starts_with("model 1 of run 1: load_transmission + coulomb + viscous + rub\nerror "), "{text}");
    let kept: Value =
        serde_json::from_str(&done(folder.path(), &["model", "import", "new.json", "--run", "1", "--json"]))
            .expect("JSON");
    let file: Value =
        serde_json::from_str(&std::fs::read_to_string(folder.path().join("new.json")).expect("a model")).expect("JSON");
    assert_eq!((&kept["id"], &kept["fit"]["terms"]), (&Value::from(2), &file["fit"]["terms"]), "unchanged");

    let geared = META.replace("\"gear_ratio\": 50", "\"gear_ratio\": 40");
    std::fs::write(folder.path().join("geared.json"), geared).expect("facts");
    done(folder.path(), &["import", "run.csv", "--meta", "geared.json"]);
    let text = done(folder.path(), &["model", "import", "new.json", "--run", "2"]);
    let note = "note      gear_ratio is 40 in the facts of this run and 50 in those of the fitted one";
    assert!(text.contains(note), "{text}");
    assert!(done(folder.path(), &["model", "evaluate", "new.json", "run.csv", "--meta", "geared.json"]).contains(note));

    let brake = "time_s,position_rad,brake_current_a,brake_torque_nm\n0,0,0,0\n0.1,0.1,0.1,0.2\n";
    std::fs::create_dir(folder.path().join("brake")).expect("a folder");
    std::fs::write(folder.path().join("brake/run.csv"), brake).expect("a table");
    std::fs::write(folder.path().join("brake/meta.json"), r#"{"kind": "brake"}"#).expect("facts");
    done(folder.path(), &["import", "brake/run.csv"]);
    let message = refused(&["model", "import", "new.json", "--run", "3"]);
    assert!(message.contains("the model is of kind friction, run 3 of kind brake: choose a run"), "{message}");
    std::fs::write(folder.path().join("joint.h"), "#ifndef JOINT_H").expect("a header");
    let message = refused(&["model", "import", "joint.h", "--run", "1"]);
    assert!(message.contains("give a JSON file written by `jointbench fit --out`"), "{message}");

    let daemon = Daemon::serve(&folder.path().join("jointbench-data"), Path::new("joint-b-mock"));
    let text = done(folder.path(), &["model", "import", "new.json", "--run", "1", "--daemon", &daemon.base]);
    assert!(text.contains("model 4 of run 1") && text.contains("/workbench/1?model=4"), "{text}");
    assert_eq!(daemon.get("/models/4")["fit"]["terms"], file["fit"]["terms"]);
}

/// All data of an effect, and the shape of its residual.
#[test]
fn an_effect_tells_all_of_itself() {
    let message = done(Path::new("."), &["effects", "load_linear"]);
    for words in [
        "τ",
        "  requires link_torque_nm in addition to the columns of every friction run (time_s, ",
        "source: ",
        "residual if missing: ",
    ] {
        assert!(message.contains(words), "{words}: {message}");
    }
    let message = done(Path::new("."), &["effects", "coulomb"]);
    assert!(message.contains("  requires the columns of every friction run (time_s, "), "{message}");
}
