//! `cargo bench -p jointbench-model`: seconds of one diagnosis, and of the same ranking by SciPy, on the same rows.
//!
//! `-- 50000 1000000` for other numbers of rows. SciPy's part is skipped if python3 or SciPy is missing.

use jointbench_instrument::{Channel, Kind, Meta, RunTable, Trace};
use jointbench_model::{ModelSpec, Options, diagnose};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use std::path::Path;
use std::process::Command;
use std::time::Instant;

const NAMES: [&str; 10] = [
    "time_s",
    "motor_position_rad",
    "motor_velocity_rad_s",
    "motor_current_a",
    "link_position_rad",
    "link_torque_nm",
    "temperature_c",
    "brake_torque_command_nm",
    "segment",
    "repeat",
];
const GEAR: f64 = 60.0;
const TORQUE_CONSTANT: f64 = 0.08;

fn main() {
    let asked: Vec<usize> = std::env::args().filter_map(|a| a.parse().ok()).collect();
    let sizes = if asked.is_empty() { vec![50_000, 1_000_000] } else { asked };
    println!("| rows × columns | diagnose | SciPy, each candidate refitted | ratio |\n| --- | --- | --- | --- |");
    for rows in sizes {
        let columns = columns(rows);
        let peer_s = scipy(&columns);
        let run = table(columns);
        let spec = ModelSpec::baseline(&run).expect("the baseline is known");
        let seconds = || {
            let start = Instant::now();
            let found = diagnose(&run, &spec, &Options::default()).expect("the run can be diagnosed");
            assert_eq!(found.suggestions[0].effect, "load_linear", "{}", found.summary);
            start.elapsed().as_secs_f64()
        };
        let own_s = (0..3).map(|_| seconds()).fold(f64::INFINITY, f64::min);
        let (peer, ratio) = match peer_s {
            Some(s) => (format!("{s:.2} s"), format!("{:.1}", s / own_s)),
            None => ("skipped: python3 with SciPy is missing".into(), "–".into()),
        };
        println!("| {rows} × {} | {own_s:.2} s | {peer} | {ratio} |", NAMES.len());
    }
}

/// Steps of nine speeds in both directions at three loads, 250 samples each, as many as the rows require;
/// load-dependent friction, which the baseline lacks.
fn columns(rows: usize) -> Vec<Vec<f64>> {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let mut noise = || -> f64 { StandardNormal.sample(&mut random) };
    let mut columns = vec![Vec::with_capacity(rows); NAMES.len()];
    let (mut angle, mut offset) = (0.0, 0.0);
    for row in 0..rows {
        let segment = row / 250;
        let (step, side) = (segment / 2, if segment.is_multiple_of(2) { 1.0 } else { -1.0 });
        let (speed, load) = (2.5 * 1.6f64.powi((step % 9) as i32), [0.0, 4.0, 12.0][step / 9 % 3]);
        if row.is_multiple_of(250) {
            offset = 2e-4 * noise();
        }
        angle += side * speed * 0.004;
        let torque = side * (0.03 + 1.5e-4 * speed + 1.06 * load / GEAR) + offset + 2e-3 * noise();
        let values = [
            row as f64 * 0.004,
            angle,
            side * speed + 1e-3 * noise(),
            torque / TORQUE_CONSTANT,
            angle / GEAR,
            side * load + 0.01 * noise(),
            25.0 + 10.0 * (1.0 - (-(row as f64) / 1e5).exp()),
            load,
            segment as f64,
            (segment / 54) as f64,
        ];
        columns.iter_mut().zip(values).for_each(|(c, v)| c.push(v));
    }
    columns
}

fn table(columns: Vec<Vec<f64>>) -> RunTable {
    let meta = Meta {
        kind: Some(Kind::Friction),
        torque_constant_nm_per_a: Some(TORQUE_CONSTANT),
        gear_ratio: Some(GEAR),
        baseline: ["load_transmission", "coulomb", "viscous"].map(String::from).into(),
        ..Meta::default()
    };
    RunTable::new(meta, Trace::from_columns(NAMES.map(Channel::new).to_vec(), columns)).expect("a valid table")
}

/// Duration of SciPy in seconds, without starting and reading.
fn scipy(columns: &[Vec<f64>]) -> Option<f64> {
    let file = std::env::temp_dir().join(format!("jointbench-selection-{}.f64", std::process::id()));
    let bytes: Vec<u8> = columns.iter().flatten().flat_map(|v| v.to_le_bytes()).collect();
    std::fs::write(&file, bytes).expect("the temporary folder can be written");
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/selection/peer.py");
    let output = Command::new("python3").arg(script).arg(&file).output();
    std::fs::remove_file(&file).expect("the file was written");
    let output = output.ok().filter(|t| t.status.success())?;
    String::from_utf8(output.stdout).ok()?.trim().parse().ok()
}
