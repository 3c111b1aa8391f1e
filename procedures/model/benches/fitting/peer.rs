//! SciPy with the same task.

use std::path::Path;
use std::process::Command;

/// Its duration in seconds, without starting and reading, and its answer. `None` if python3 or SciPy is missing.
pub fn ask(task: &str, columns: &[&[f64]]) -> Option<(f64, Vec<f64>)> {
    let file = std::env::temp_dir().join(format!("jointbench-{task}-{}.f64", std::process::id()));
    let bytes: Vec<u8> = columns.iter().flat_map(|c| c.iter()).flat_map(|v| v.to_le_bytes()).collect();
    std::fs::write(&file, bytes).expect("the temporary folder can be written");
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/fitting/peer.py");
    let output = Command::new("python3").arg(script).arg(task).arg(&file).arg(columns.len().to_string()).output();
    std::fs::remove_file(&file).expect("the file was written");
    let output = output.ok().filter(|output| output.status.success())?;
    let numbers = String::from_utf8(output.stdout).ok()?;
    let mut numbers = numbers.split_whitespace().map(|n| n.parse().expect("SciPy's script tells numbers"));
    Some((numbers.next()?, numbers.collect()))
}
