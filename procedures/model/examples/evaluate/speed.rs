//! Duration and memory of one diagnosis, after loading.

use crate::made::{Dice, friction_run};
use jointbench_instrument::{Channel, RunTable, Trace};
use jointbench_model::{ModelSpec, Options, diagnose};
use std::error::Error;
use std::process::Command;
use std::time::Instant;

const HIDDEN: [(&str, &[&str]); 3] = [
    ("nothing hidden", &[]),
    ("stribeck and load_linear", &["stribeck", "load_linear"]),
    ("stribeck, and structure over the speed", &["stribeck", "hump"]),
];
const ROWS: [usize; 2] = [50_000, 1_000_000];

/// Every case runs in a separate process, because the allocator of a process keeps memory of earlier cases.
pub fn measure(case: Option<usize>) -> Result<(), Box<dyn Error>> {
    if let Some(case) = case {
        return one(HIDDEN[case / ROWS.len() % HIDDEN.len()], ROWS[case % ROWS.len()]);
    }
    println!("\nSeconds of one diagnosis after loading, whole friction library\n");
    println!(
        "| run | verdict | rows × columns | s (best of three) | memory above the run, as multiple of it |\n| --- | --- | --- | --- | --- |"
    );
    for case in 0..HIDDEN.len() * ROWS.len() {
        let done =
            Command::new(std::env::current_exe()?).args(["--part", "speed", "--case", &case.to_string()]).status()?;
        if !done.success() {
            return Err(format!("case {case}: {done}").into());
        }
    }
    println!();
    Ok(())
}

fn one((label, hidden): (&str, &[&str]), rows: usize) -> Result<(), Box<dyn Error>> {
    // The first diagnosis loads the pages of the program.
    let small = of_length(&friction_run(&mut Dice::new(4), &[]), 2_000);
    diagnose(&small, &ModelSpec::baseline(&small)?, &Options::default())?;
    let run = of_length(&friction_run(&mut Dice::new(4), hidden), rows);
    let spec = ModelSpec::baseline(&run)?;
    let before = resident();
    let (mut best, mut verdict) = (f64::INFINITY, String::new());
    for _ in 0..3 {
        let start = Instant::now();
        let found = diagnose(&run, &spec, &Options::default())?;
        best = best.min(start.elapsed().as_secs_f64());
        let named: Vec<&str> = found.suggestions.iter().map(|s| s.effect.as_str()).collect();
        let beyond = if found.structure_remains { ", structure remains" } else { "" };
        verdict = format!("{}{beyond}", if named.is_empty() { "nothing".into() } else { named.join(", ") });
    }
    let own = (run.len() * run.trace().channels().len() * 8) as f64;
    let memory = match (before, peak()) {
        (Some(before), Some(peak)) => format!("{:.1}", (peak - before) / own),
        _ => "–".into(),
    };
    println!("| {label} | {verdict} | {} × {} | {best:.3} | {memory} |", run.len(), run.trace().channels().len());
    Ok(())
}

/// Repeats the run until it has this number of rows, with continued time, segments and repeats.
fn of_length(run: &RunTable, rows: usize) -> RunTable {
    let n = run.len();
    let channels: Vec<Channel> = run.trace().channels().to_vec();
    let columns = channels.iter().map(|c| {
        let values = run.column(&c.name).unwrap_or_default();
        let next = match c.name.as_str() {
            "time_s" => values[n - 1] + values[1] - values[0],
            "segment" | "repeat" => values[n - 1] + 1.0,
            "motor_position_rad" | "link_position_rad" => values[n - 1] - values[0],
            _ => 0.0,
        };
        (0..rows).map(|i| values[i % n] + (i / n) as f64 * next).collect()
    });
    let columns = columns.collect();
    RunTable::new(run.meta().clone(), Trace::from_columns(channels, columns)).expect("the run was a valid table")
}

/// Resident memory of this process, if the system reports it.
fn resident() -> Option<f64> {
    // Resets the peak of an earlier part.
    std::fs::write("/proc/self/clear_refs", "5").ok()?;
    status("VmRSS:")
}

fn peak() -> Option<f64> {
    status("VmHWM:")
}

fn status(entry: &str) -> Option<f64> {
    let text = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = text.lines().find(|l| l.starts_with(entry))?;
    Some(line.split_whitespace().nth(1)?.parse::<f64>().ok()? * 1024.0)
}
