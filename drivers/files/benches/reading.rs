//! Reading speed of a plain CSV, compared with polars on the same file in the same run.
//!
//! `cargo bench -p jointbench-files --bench reading -- 1024` creates a file of 1024 MiB.
//!
//! polars runs through Python (`JOINTBENCH_PYTHON`, else python3), because its crate takes longer to build than the
//! rest of this benchmark. Without polars only our own result is printed.

use jointbench_files::{ReadOptions, understand};
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;
use std::process::Command;
use std::time::Instant;

const MIB: u64 = 1 << 20;
const USUAL_MIB: u64 = 256;
/// Repeats; the fastest one counts.
const TRIES: usize = 3;

/// Reads the named file repeatedly and prints the best time.
const POLARS: &str = "
import sys, time
import polars
def once():
    begin = time.perf_counter()
    polars.read_csv(sys.argv[1])
    return time.perf_counter() - begin
print(min(once() for _ in range(int(sys.argv[2]))))
";

fn main() {
    let mib = std::env::args().filter_map(|text| text.parse().ok()).next_back().unwrap_or(USUAL_MIB);
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("run.csv");
    let rows = write(&path, mib * MIB).expect("a file");
    let bytes = path.metadata().expect("the file").len() as f64;
    let rate = |took_s: f64| bytes / MIB as f64 / took_s;
    let once = || {
        let begin = Instant::now();
        let table = understand(&path, &ReadOptions::default()).expect("a table");
        assert_eq!(table.trace.len(), rows);
        begin.elapsed().as_secs_f64()
    };
    let ours_s = (0..TRIES).map(|_| once()).fold(f64::INFINITY, f64::min);
    println!("{:.0} MiB, {rows} rows: jointbench {ours_s:.2} s ({:.0} MiB/s)", bytes / MIB as f64, rate(ours_s));
    match polars(&path) {
        Some(polars_s) => {
            println!("polars {polars_s:.2} s ({:.0} MiB/s): {:.2} of its speed", rate(polars_s), polars_s / ours_s);
        }
        None => println!("polars is not there: JOINTBENCH_PYTHON=PYTHON names a Python that has it"),
    }
}

fn write(path: &Path, bytes: u64) -> std::io::Result<usize> {
    let mut out = BufWriter::new(File::create(path)?);
    let mut written =
        out.write(b"time_s,motor_position_rad,motor_velocity_rad_s,motor_current_a,link_torque_nm\n")? as u64;
    let mut row = 0;
    while written < bytes {
        let t = row as f64 * 1e-3;
        let line = format!(
            "{t:.3},{:.6},{:.5},{:.4},{:.5}\n",
            30.0 * t.sin(),
            30.0 * t.cos(),
            (7.0 * t).sin(),
            (3.0 * t).cos()
        );
        out.write_all(line.as_bytes())?;
        written += line.len() as u64;
        row += 1;
    }
    // The write-back to disk must not overlap with the reading.
    out.into_inner()?.sync_all()?;
    Ok(row)
}

fn polars(path: &Path) -> Option<f64> {
    let python = std::env::var("JOINTBENCH_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let tries = TRIES.to_string();
    let output = Command::new(python).args(["-c", POLARS]).arg(path).arg(&tries).output().ok()?;
    String::from_utf8_lossy(&output.stdout).trim().parse().ok()
}
