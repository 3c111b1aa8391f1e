//! Scores `diagnose` and `discover` on folders of cases with a known answer:
//!
//! `cargo run --release -p jointbench-model --example score_cases -- FOLDER… --kind friction`.
//!
//! A case is a folder with `run.csv` or `run.csv.gz`, `meta.json` and `answer.json`: `category`, `style`, `hidden`, `acceptable`,
//! `optional`, `identifiable` and `truth` (true parameters as `effect.name`), or `accept` as practice cases of one family have it.

#[path = "../../tests/common/mod.rs"]
mod common;
mod score;

use clap::Parser;
use rayon::prelude::*;
use score::{Answer, Judged, Table};
use std::error::Error;
use std::path::PathBuf;

/// Scores the diagnosis on cases with a known answer
#[derive(Parser)]
#[command(name = "score_cases")]
struct Asked {
    /// Folders of cases, or cases
    #[arg(required = true)]
    folders: Vec<PathBuf>,
    /// Only cases of this kind
    #[arg(long)]
    kind: Option<String>,
    /// Only cases whose name contains this
    #[arg(long, default_value = "")]
    only: String,
    /// The totals alone
    #[arg(long)]
    quiet: bool,
}

fn main() -> Result<(), Box<dyn Error>> {
    let asked = Asked::parse();
    let mut cases = Vec::new();
    for folder in &asked.folders {
        if folder.join("answer.json").exists() {
            cases.push(folder.clone());
            continue;
        }
        let inside = std::fs::read_dir(folder)?.filter_map(|entry| Some(entry.ok()?.path()));
        cases.extend(inside.filter(|path| path.join("answer.json").exists()));
    }
    cases.sort();
    cases.retain(|case| case.to_string_lossy().contains(&asked.only));
    let answer = |case: &PathBuf| Some((case.clone(), Answer::read(case).ok()?));
    let mut cases: Vec<(PathBuf, Answer)> = cases.iter().filter_map(answer).collect();
    cases.retain(|(_, answer)| asked.kind.as_ref().is_none_or(|kind| *kind == answer.kind));
    let judged: Vec<Judged> = cases.into_par_iter().map(|(case, answer)| Judged::new(&case, answer)).collect();
    let mut table = Table::default();
    for case in &judged {
        if !asked.quiet {
            println!("{}", case.line());
        }
        table.add(case);
    }
    table.print();
    Ok(())
}
