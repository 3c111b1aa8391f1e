//! An exported C header on a controller: compiled, and called sample by sample.

use jointbench_model::Fit;
use jointbench_model::export::{Format, export};
use std::process::Command;

/// Result of the header's function at every row of its inputs, in the order of its struct. `None` without a compiler.
pub fn on_controller(fit: &Fit, unit: &str, rows: &[Vec<f64>]) -> Option<Vec<f64>> {
    if Command::new("cc").arg("--version").output().is_err() {
        println!("SKIPPED: there is no C compiler (cc) to run the exported header with");
        return None;
    }
    let folder = tempfile::tempdir().unwrap();
    let name = format!("joint_{}", fit.kind);
    let header = export(fit, Format::C).unwrap();
    std::fs::write(folder.path().join("joint.h"), &header).unwrap();
    let list = |row: &Vec<f64>| format!("{{{}}}", row.iter().map(f64::to_string).collect::<Vec<_>>().join(", "));
    let inputs: Vec<String> = rows.iter().map(list).collect();
    let state = if header.contains("_state *s") { "&s, " } else { "" };
    let declared = if state.is_empty() { String::new() } else { format!("{name}_state s = {{0}};") };
    let main = format!(
        "#include \"joint.h\"\n#include <stdio.h>\nstatic const {name}_input rows[] = {{{}}};\nint main(void) {{ {declared} \
         for (int i = 0; i < {}; i++) printf(\"%.17g\\n\", {name}_{unit}(&{name}_fitted, {state}&rows[i])); return 0; }}\n",
        inputs.join(",\n"),
        rows.len()
    );
    let (source, program) = (folder.path().join("main.c"), folder.path().join("main"));
    std::fs::write(&source, main).unwrap();
    let built = Command::new("cc").args(["-std=c99", "-O1", "-o"]).arg(&program).arg(&source).arg("-lm").output();
    let built = built.unwrap();
    assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
    let reported = Command::new(&program).output().unwrap();
    Some(String::from_utf8(reported.stdout).unwrap().lines().map(|line| line.parse().unwrap()).collect())
}
