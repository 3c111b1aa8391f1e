//! Arguments for stored runs.

use super::{Columns, Reach};
use crate::lab::FileFormat;
use clap::Args;
use std::path::PathBuf;

#[derive(Debug, Args)]
pub struct Runs {
    /// Words, and terms such as kind:friction, unit:SN123, state:failed or rows>1000; all must match. Excluded terms,
    /// such as -tag:oil, follow after --
    #[arg(value_name = "TERM")]
    pub search: Vec<String>,
    /// Maximum number of runs
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = clap::value_parser!(u32).range(1..=500))]
    pub limit: u32,
    /// started, state, procedure, bench, duration, rows, safe, error (validation error of the latest active model
    /// version), coulomb, or a quantity of the result as quantity:tau_c; --sort=-error lists the largest first [default: newest first]
    #[arg(long, value_name = "COLUMN", allow_hyphen_values = true)]
    pub sort: Option<String>,
    /// Print JSON
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    pub store: StorePlace,
}

#[derive(Debug, Args)]
pub struct Import {
    /// Run tables: text (.csv, .tsv, .txt, .dat and others, also .gz), .parquet or .arrow
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<PathBuf>,
    /// Meta file of the test conditions [default: RUN.meta.json or meta.json in the folder of each file, or embedded
    /// metadata]
    #[arg(long, value_name = "META.JSON")]
    pub meta: Option<PathBuf>,
    #[command(flatten)]
    pub columns: Columns,
    #[command(flatten)]
    pub store: StorePlace,
}

#[derive(Debug, Args)]
pub struct Export {
    /// Number of the run
    pub run: i64,
    /// File format [default: by the extension of --out, otherwise csv]
    #[arg(long, value_enum)]
    pub format: Option<FileFormat>,
    /// File to write; for CSV also NAME.meta.json with the test conditions [default: run-N.csv, run-N.parquet or
    /// run-N.mat]
    #[arg(short, long, visible_alias = "output", value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Prefix text cells of a CSV that start with = + - @ with an apostrophe, so that a spreadsheet does not interpret
    /// them as formulas
    #[arg(long)]
    pub spreadsheet_safe: bool,
    #[command(flatten)]
    pub store: StorePlace,
}

pub const CONVERT: &str = "\
  jointbench convert log.txt --out run.csv                     converted table and run.meta.json
  jointbench convert log.csv --map motor_current_a=Iq --unit motor_current_a=mA --out run.parquet
  jointbench convert log.csv --time-from-rate 200 --out run.csv

What was skipped or assumed is said on standard error, each with the option that changes it.";

#[derive(Debug, Args)]
pub struct Convert {
    /// Table: text (.csv, .tsv, .txt, .dat and others, also .gz), .parquet or .arrow
    pub file: PathBuf,
    /// Meta file of the test conditions [default: FILE.meta.json or meta.json in the folder of the file, or embedded
    /// metadata]
    #[arg(long, value_name = "META.JSON")]
    pub meta: Option<PathBuf>,
    /// File to write, .csv, .csv.gz or .parquet; for CSV also NAME.meta.json with the test conditions
    #[arg(short, long, visible_alias = "output", value_name = "RUN.CSV")]
    pub out: PathBuf,
    /// Print columns, rows, notes and omitted data as JSON
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    pub columns: Columns,
}

#[derive(Debug, Args)]
pub struct Backup {
    /// Backup file
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// Folder of the store
    #[arg(long, value_name = "DIR", env = "JOINTBENCH_DATA", default_value = "jointbench-data")]
    pub data: PathBuf,
}

#[derive(Debug, Args)]
pub struct Verify {
    /// Folder of the store
    #[arg(long, value_name = "DIR", env = "JOINTBENCH_DATA", default_value = "jointbench-data")]
    pub data: PathBuf,
    /// Print JSON
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Args)]
pub struct Identify {
    /// Number of the run
    pub run: i64,
    /// Print JSON
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    pub store: StorePlace,
}

#[derive(Debug, Args)]
pub struct Report {
    /// Number of the run
    pub run: i64,
    /// File to write: .html, or .pdf printed by an installed Chromium or Chrome (on PATH, or its path in
    /// JOINTBENCH_CHROMIUM) [default: run-N.html]
    #[arg(short, long, visible_alias = "output", value_name = "REPORT.HTML")]
    pub out: Option<PathBuf>,
    /// Only the first page, without the appendix: one sheet for a customer
    #[arg(long)]
    pub short: bool,
    #[command(flatten)]
    pub store: StorePlace,
}

#[derive(Debug, Args)]
pub struct Reproduce {
    /// Random seed of the simulated joints
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// Use a bench with exactly the values of the documents, count the intervals that contain them, and list every row
    /// of the documents with its state
    #[arg(long)]
    pub documents: bool,
    /// Number of seeds, from --seed on
    #[arg(long, value_name = "N", default_value_t = 1, requires = "documents", value_parser = clap::value_parser!(u64).range(1..))]
    pub seeds: u64,
    /// Write tables and figures to a page, such as docs/reproduction.md, and to a folder with the same name
    #[arg(short, long, visible_alias = "output", value_name = "PAGE.MD")]
    pub out: Option<PathBuf>,
}

/// The daemon where its address is given; else the folder, or the daemon on the usual address where one has the folder.
#[derive(Debug, Args)]
pub struct StorePlace {
    /// Folder of the store; takes precedence over JOINTBENCH_URL, but not over --daemon [default: jointbench-data]
    #[arg(long, value_name = "DIR", env = "JOINTBENCH_DATA")]
    pub data: Option<PathBuf>,
    #[command(flatten)]
    pub reach: Reach,
}
