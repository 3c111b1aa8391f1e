//! The arguments of the command line.

mod archive;
mod columns;
mod control;
mod model;
mod place;
mod run;
mod runs;
mod units;

pub use archive::Archive;
pub use columns::Columns;
pub use control::{Control, Notify, Reset, ServoMemory, Stop};
pub use model::{Model, ModelCommand};
pub use place::{Place, Reach, ServedTokens};
pub use run::{Queue, QueueCommand, Run};
pub use runs::{Backup, Convert, Export, Identify, Import, Report, Reproduce, Runs, StorePlace, Verify};
pub use units::{UnitArguments, Units};

use super::log::LogForm;
use super::ports::Ports;
use super::user_effects::OwnEffects;
use clap::{Args, Parser, Subcommand};
use jointbench_instrument::Kind;
use jointbench_model::thresholds::MOST_EFFECTS;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Getting started:
  jointbench demo                              measure a simulated joint and find the missing effect
  jointbench diagnose RUN.csv                  where does the model fail on my data, and which effect is missing?

Exit codes: 0 done, 1 the run failed or a limit was exceeded, 2 bad arguments or bad input, 3 undecided.
Any verdict ends with 0; 3 means that the data do not allow a verdict.";

/// Test bench for robot joints: measure, identify a model, and find where it fails and which effect is missing.
#[derive(Debug, Parser)]
#[command(name = "jointbench", version = crate::VERSION, after_help = EXAMPLES, max_term_width = 100)]
pub struct Arguments {
    #[command(subcommand)]
    pub command: Command,
    /// Format of the log on standard error; RUST_LOG sets the level (such as RUST_LOG=debug).
    #[arg(long, global = true, value_enum, default_value = "text")]
    pub log: LogForm,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Run the complete identification on a simulated bench, then keep the dashboard open
    Demo(Demo),
    /// Run the daemon: benches, store, REST API and dashboard
    Serve(Serve),
    /// What the daemon starts for each bench: holds its instruments, by orders on its standard input
    #[command(hide = true)]
    Worker,
    /// One computation of a daemon, which starts it
    #[command(hide = true)]
    Job,
    /// Check a bench description and identify its instruments, without motion
    Check(Check),
    /// List the serial ports of this computer, the instruments connected to them, and why a port cannot be opened
    Ports(Ports),
    /// List the procedures, or describe one with its parameters (procedures friction)
    Procedures(Listed),
    /// List the effects of the library and those that a mock bench can hide
    Effects(Listed),
    /// Start a procedure on a running daemon, or complete an interrupted run (--continue)
    #[command(
        override_usage = "jointbench run <PROCEDURE> [OPTIONS]\n       jointbench run --continue <RUN> [OPTIONS]",
        after_help = run::RUN
    )]
    Run(Run),
    /// End the active run: the brake is unloaded while the shaft turns, and measured samples are kept
    #[command(after_help = control::STOP)]
    Stop(Stop),
    /// Pause the active run after the current step
    #[command(after_help = control::STEER)]
    Pause(Control),
    /// Resume a paused run
    #[command(after_help = control::STEER)]
    Resume(Control),
    /// Release a bench after a software stop or after a run whose safe state is not confirmed
    Reset(Reset),
    /// Read the memory of a Puma-type servo (DIAGREAD) between runs, without motion
    #[command(after_help = control::MEMORY)]
    ServoMemory(ServoMemory),
    /// List the runs that wait for a bench, queue a test plan, or pause and resume a queue
    #[command(after_help = run::QUEUE)]
    Queue(Queue),
    /// List the targets of notifications with their waiting messages, or send each of them a test message
    Notify(Notify),
    /// Show the archive of ended runs, or remove archived samples from the store
    #[command(after_help = archive::ARCHIVE)]
    Archive(Archive),
    /// List the runs of a daemon or of a folder
    Runs(Runs),
    /// List the units under test with their verdicts, and first-pass yield by part, revision and batch
    #[command(after_help = units::UNITS)]
    Units(Units),
    /// Measure, diagnose and repeat on a running daemon, until no effect is missing
    #[command(after_help = AUTOPILOT)]
    Autopilot(Autopilot),
    /// Find where a model fails on a measured run and which effect is missing
    #[command(after_help = DECIDED)]
    Diagnose(Diagnose),
    /// Diagnose, add the best effect and refit, until no effect is missing
    #[command(after_help = DECIDED)]
    Discover(Discover),
    /// Fit a model to a measured run
    Fit(Fit),
    /// Evaluate, compare, export and import models written by `fit --out`
    Model(Model),
    /// Import measured files into the store
    Import(Import),
    /// Export a stored run to a file
    Export(Export),
    /// Convert a table of another program to a run table with its meta file; needs no kind and no required columns
    #[command(after_help = runs::CONVERT)]
    Convert(Convert),
    /// Print the result of a stored run: verdict, quantities and intervals
    Identify(Identify),
    /// Write a report of a run as one HTML page or as PDF
    Report(Report),
    /// Back up the store to one file, also during a run, and verify the copy
    Backup(Backup),
    /// Restore a backup into a folder that no daemon uses; the previous store is kept
    Restore(Backup),
    /// Verify all records of a store, also while a daemon uses it; exit code 1 if a record is damaged
    Verify(Verify),
    /// Repeat the campaigns of the source documents on the mock bench and compare the tables
    Reproduce(Reproduce),
    /// Serve the instruments of a simulated bench to other programs, without a daemon
    Simulate(Simulate),
    /// Write a script that completes the commands in a shell
    #[command(after_help = COMPLETIONS)]
    Completions {
        /// Shell of the script
        shell: clap_complete::Shell,
    },
    /// Write the man pages, one for each command
    Man {
        /// Folder of the pages
        folder: PathBuf,
    },
}

#[derive(Debug, Args)]
pub struct Demo {
    /// The kind of run: friction, encoder, stiffness or brake [default: friction, or that of the effect]
    #[arg(long, value_name = "KIND", value_parser = kind)]
    pub kind: Option<Kind>,
    /// The effect to hide, such as gravity, slip or hardening [default: load_linear, or one of the kind]
    #[arg(long, value_name = "ID", conflicts_with = "seed")]
    pub effect: Option<String>,
    /// Hide a random effect, of a random kind without --kind, revealed at the end
    #[arg(long, value_name = "N")]
    pub seed: Option<u64>,
    /// Exit after the report instead of keeping the dashboard open
    #[arg(long)]
    pub exit: bool,
    #[command(flatten)]
    pub place: Place,
}

fn kind(name: &str) -> Result<Kind, String> {
    let known = || Kind::ALL.map(Kind::name).join(", ");
    Kind::ALL.into_iter().find(|kind| kind.name() == name).ok_or_else(|| format!("expected {}", known()))
}

#[derive(Debug, Args)]
pub struct Serve {
    /// Bench description: a file, or a built-in one (joint-a-mock, joint-b-mock, encoder-bench-mock, puma-mock,
    /// joint-a, joint-b, encoder-bench, puma)
    #[arg(long, value_name = "BENCH.TOML", default_value = "joint-a-mock")]
    pub config: String,
    #[command(flatten)]
    pub place: Place,
}

#[derive(Debug, Args)]
pub struct Check {
    /// Bench description: a file, or the name of a built-in one
    pub config: String,
    /// Print the description, as a template for your own
    #[arg(long)]
    pub print: bool,
}

#[derive(Debug, Args)]
pub struct Simulate {
    /// Simulated bench: a description, or a built-in one (joint-a-mock, joint-b-mock, encoder-bench-mock, puma-mock)
    #[arg(value_name = "BENCH.TOML", default_value = "joint-a-mock")]
    pub config: String,
    /// Loopback TCP ports instead of pseudo-terminals
    #[arg(long)]
    pub tcp: bool,
    /// Seconds of simulation per second
    #[arg(long, default_value_t = 1.0)]
    pub pace: f64,
    /// Bytes take the time that they take on the real line
    #[arg(long)]
    pub paced_lines: bool,
    /// One JSON object for each instrument instead of a table
    #[arg(long)]
    pub json: bool,
}

/// An item of the library to describe.
#[derive(Debug, Args)]
pub struct Listed {
    /// Id of one item to describe in detail
    pub id: Option<String>,
}

const COMPLETIONS: &str = "\
  jointbench completions bash > ~/.local/share/bash-completion/completions/jointbench
  jointbench completions zsh > ~/.zfunc/_jointbench
  jointbench completions fish > ~/.config/fish/completions/jointbench.fish";

const DECIDED: &str = "\
Exit codes: 0 any verdict, 2 bad arguments or bad input, 3 the data do not allow a verdict: too few data to test the model, \
or contradictory columns. With exit code 3 the JSON field `undecided` gives the reason; `adequate` then means that no \
missing effect was found, not that none exists.";

const AUTOPILOT: &str = "\
The autopilot performs a run, fits the baseline model and diagnoses it. It adds effects whose evidence is sufficient. If two
effects are confounded or an effect is not testable, it performs the run that is expected to decide and repeats the diagnosis
with all runs. Every step is stored, and every run is checked against the limits of the bench.

  jointbench autopilot --runs 3 --wait                  at most three runs, with progress
  jointbench autopilot --bench-time-s 600 --set load_levels=2 --wait
  jointbench autopilot --after 4 --wait                 only the run that diagnosis 4 recommends

Exit codes: 0 no further effect to add (unexplained structure may remain, see the verdict), 1 a run failed or was stopped, \
2 bad arguments, 3 the data do not decide, or the budget is used up.";

#[derive(Debug, Args)]
pub struct Autopilot {
    /// Maximum number of runs, including the first
    #[arg(long, value_name = "N", default_value_t = 3)]
    pub runs: u32,
    /// Maximum bench time [s]
    #[arg(long, value_name = "S")]
    pub bench_time_s: Option<f64>,
    /// Procedure of the first run
    #[arg(long, value_name = "ID", default_value = "friction")]
    pub procedure: String,
    /// A parameter of the first run, in SI units; repeatable
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// Effects of the initial model, comma-separated [default: `baseline` of the procedure]
    #[arg(long, value_name = "EFFECTS")]
    pub model: Option<String>,
    /// Maximum number of effects to add
    #[arg(long, value_name = "N", default_value_t = 6)]
    pub max_effects: u32,
    /// Perform only the run that this diagnosis recommends, then diagnose its model with the new data
    #[arg(long, value_name = "DIAGNOSIS", conflicts_with_all = ["runs", "bench_time_s", "procedure", "set", "model", "max_effects"])]
    pub after: Option<i64>,
    /// Bench to run on; optional if the daemon has only one
    #[arg(long, value_name = "NAME")]
    pub bench: Option<String>,
    /// Wait for the end; Ctrl-C stops waiting, not the autopilot
    #[arg(long)]
    pub wait: bool,
    /// Print the autopilot with all its steps as JSON
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    pub reach: Reach,
}

/// One or several measured runs of one joint, with import and preprocessing options.
#[derive(Debug, Args)]
pub struct Measured {
    /// Run table: text (.csv, .tsv, .txt, .dat and others, also .gz), .parquet or .arrow, or the folder of a run.csv;
    /// further runs of the same kind and joint are analysed together with the first, in chronological order
    #[arg(required = true, value_name = "RUN")]
    pub files: Vec<PathBuf>,
    /// Meta file of the test conditions, for all files [default: RUN.meta.json or meta.json in the folder of each file,
    /// or embedded metadata]
    #[arg(long, value_name = "META.JSON")]
    pub meta: Option<PathBuf>,
    /// Effects of the model, comma-separated [default: `baseline` of the meta file]
    #[arg(long, value_name = "EFFECTS")]
    pub model: Option<String>,
    /// Print JSON
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    pub columns: Columns,
    #[command(flatten)]
    pub own: OwnEffects,
    #[command(flatten)]
    pub preparation: Preparation,
}

/// Preprocessing of the run. Omitted options are chosen from the data and printed with the fit.
#[derive(Debug, Args)]
#[command(next_help_heading = "Preprocessing (chosen from the data if omitted)")]
pub struct Preparation {
    /// Kind of residual
    #[arg(long, value_name = "KIND", value_parser = ["raw", "plateau_mean"])]
    pub residual: Option<String>,
    /// Cut-off frequency of the zero-phase low-pass filter [Hz]
    #[arg(long, value_name = "HZ", allow_negative_numbers = true)]
    pub cutoff_hz: Option<f64>,
    /// Decimation factor
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub decimation: Option<usize>,
    /// Averaging time of the steady-state means [s]
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    pub chunk_s: Option<f64>,
    /// Family-wise error rate of all tests, as a fraction
    #[arg(long, value_name = "SHARE", allow_negative_numbers = true)]
    pub alpha: Option<f64>,
}

#[derive(Debug, Args)]
pub struct Diagnose {
    #[command(flatten)]
    pub run: Measured,
    /// Also print the residual maps over each quantity; with --json also over selected pairs
    #[arg(long)]
    pub maps: bool,
}

#[derive(Debug, Args)]
pub struct Discover {
    #[command(flatten)]
    pub run: Measured,
    /// Maximum number of effects to add
    #[arg(long, value_name = "N", default_value_t = MOST_EFFECTS as usize)]
    pub max_effects: usize,
}

#[derive(Debug, Args)]
pub struct Fit {
    #[command(flatten)]
    pub run: Measured,
    /// Evaluate the fitted model on another run
    #[arg(long, value_name = "OTHER.CSV")]
    pub evaluate: Option<PathBuf>,
    /// Write the complete fit to a file, for `jointbench model`
    #[arg(long, value_name = "MODEL.JSON")]
    pub out: Option<PathBuf>,
}
