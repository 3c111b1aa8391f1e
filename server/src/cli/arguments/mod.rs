//! What can be written on the command line.

mod columns;
mod kept;
mod model;
mod place;
mod steer;

pub use columns::Columns;
pub use kept::{Backup, Convert, Export, Identify, Import, Report, Reproduce, Runs, StorePlace, Verify};
pub use model::{Model, ModelCommand};
pub use place::{Place, Reach, ServedTokens};
pub use steer::{Reset, Steer, Stop};

use super::log::LogForm;
use super::own::OwnEffects;
use super::ports::Ports;
use super::require::Requirement;
use clap::{Args, Parser, Subcommand};
use std::path::PathBuf;

const EXAMPLES: &str = "\
Begin here:
  jointbench demo                              measure a simulated joint, find what its model lacks
  jointbench diagnose RUN.csv                  where does the model fail on my data, and what is missing?

Exit codes: 0 done, 1 the run failed or a limit was broken, 2 bad arguments or bad input, 3 could not be decided.
A verdict is done, whatever it says: 3 is where the data do not allow one.";

/// Test bench for robot joints: measure, fit a model, find where it fails and which effect it lacks.
#[derive(Debug, Parser)]
#[command(name = "jointbench", version, after_help = EXAMPLES, max_term_width = 100)]
pub struct Arguments {
    #[command(subcommand)]
    pub command: Command,
    /// Form of the log on standard error; RUST_LOG chooses what is told (such as RUST_LOG=debug).
    #[arg(long, global = true, value_enum, default_value = "text")]
    pub log: LogForm,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Show the whole loop on a simulated bench, then keep the dashboard open
    Demo(Demo),
    /// Run the daemon: benches, store, REST API and dashboard
    Serve(Serve),
    /// What the daemon starts for each bench: holds its instruments, by orders on its standard input
    #[command(hide = true)]
    Worker,
    /// One computation of a daemon, which starts it
    #[command(hide = true)]
    Job,
    /// Check a bench description and let its instruments identify themselves; moves nothing
    Check(Check),
    /// List this computer's serial ports: what is behind them, and what may not be opened and why
    Ports(Ports),
    /// List the procedures, or say what one does and what can be set (procedures friction)
    Procedures(Listed),
    /// List the effects that a model can hold and a diagnosis can name, and those a mock bench can hide
    Effects(Listed),
    /// Start a procedure on a running daemon, or make what is left of a run (--continue)
    #[command(
        override_usage = "jointbench run <PROCEDURE> [OPTIONS]\n       jointbench run --continue <RUN> [OPTIONS]",
        after_help = RUN
    )]
    Run(Run),
    /// End a run that is on: the brake is unloaded while the shaft turns, and what was measured is kept
    #[command(after_help = steer::STOP)]
    Stop(Stop),
    /// Let a run that is on come to rest between two steps, and wait there
    #[command(after_help = steer::STEER)]
    Pause(Steer),
    /// Let a paused run go on
    #[command(after_help = steer::STEER)]
    Resume(Steer),
    /// Release a bench after a software stop, or after an end that is not known to be safe
    Reset(Reset),
    /// List the runs of a daemon or of a folder
    Runs(Runs),
    /// Measure, diagnose and measure again on a running daemon, until nothing is missing
    #[command(after_help = AUTOPILOT)]
    Autopilot(Autopilot),
    /// Say where a model fails on a measured run and which effect is missing
    #[command(after_help = DECIDED)]
    Diagnose(Diagnose),
    /// Diagnose, add the best effect and fit again, until nothing is missing
    #[command(after_help = DECIDED)]
    Discover(Discover),
    /// Fit a model to a measured run
    Fit(Fit),
    /// Evaluate, compare, export and import models that `fit --out` has written
    Model(Model),
    /// Take measured files into the store
    Import(Import),
    /// Write a run of the store to a file
    Export(Export),
    /// Write what was understood of a file as a run table with its meta.json; no kind and no required columns are needed
    #[command(after_help = kept::CONVERT)]
    Convert(Convert),
    /// Say what a run of the store shows: its procedure's verdict, quantities and intervals
    Identify(Identify),
    /// Write a run as one page to send and to print
    Report(Report),
    /// Write the store to one file, also while a run is on, and check the copy
    Backup(Backup),
    /// Put a backup in the place of a store that no daemon has; what was there is kept beside it
    Restore(Backup),
    /// Read all that a store holds and say what is damaged; exit code 1 where something is. Also beside a running daemon
    Verify(Verify),
    /// Make the source documents' campaigns again on the mock bench, each table beside the document's
    Reproduce(Reproduce),
}

#[derive(Debug, Args)]
pub struct Demo {
    /// The effect to hide in the joint, such as stribeck or gravity
    #[arg(long, value_name = "ID", conflicts_with = "seed", default_value = "load_linear")]
    pub effect: String,
    /// Hide an effect at random, and tell it only at the end
    #[arg(long, value_name = "N")]
    pub seed: Option<u64>,
    /// End after the report instead of keeping the dashboard open
    #[arg(long)]
    pub exit: bool,
    #[command(flatten)]
    pub place: Place,
}

#[derive(Debug, Args)]
pub struct Serve {
    /// Bench description: a file, or one of the ready-made ones (joint-a-mock, joint-b-mock,
    /// encoder-bench-mock, puma-mock, joint-a, joint-b, encoder-bench, puma)
    #[arg(long, value_name = "BENCH.TOML", default_value = "joint-a-mock")]
    pub config: String,
    #[command(flatten)]
    pub place: Place,
}

#[derive(Debug, Args)]
pub struct Check {
    /// Bench description: a file, or the name of a ready-made one
    pub config: String,
    /// Print the description itself, to start an own one from
    #[arg(long)]
    pub print: bool,
}

/// Something of the library to be told of.
#[derive(Debug, Args)]
pub struct Listed {
    /// Only this one, with all there is to say of it
    pub id: Option<String>,
}

#[derive(Debug, Args)]
pub struct Run {
    /// Id of the procedure, such as friction or warm_up
    #[arg(required_unless_present = "continues")]
    pub procedure: Option<String>,
    /// Make what is left of a run that did not come to its end: the warm-up again, the brake demagnetised, then from the
    /// first step that was not finished. Both runs together are one measurement
    #[arg(long = "continue", value_name = "RUN", conflicts_with_all = ["procedure", "set", "bench"])]
    pub continues: Option<i64>,
    /// A parameter of the procedure, in SI units; may be given again
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// Bench to run on; not needed where the daemon has only one
    #[arg(long, value_name = "NAME")]
    pub bench: Option<String>,
    /// Wait for the end; Ctrl-C stops waiting, not the run
    #[arg(long)]
    pub wait: bool,
    /// Print the run as JSON
    #[arg(long)]
    pub json: bool,
    /// Demand something of the result, such as 'tau_c < 0.035 Nm'; waits for the end; may be given again. The whole
    /// 95 % interval must keep the limit: exit code 1 where the value breaks it, 3 where only the interval reaches over
    #[arg(long, value_name = "LIMIT")]
    pub require: Vec<Requirement>,
    /// Write how the run ended as a JUnit report, a case for each demand; waits for the end
    #[arg(long, value_name = "REPORT.XML")]
    pub junit: Option<PathBuf>,
    #[command(flatten)]
    pub reach: Reach,
}

const DECIDED: &str = "\
Exit codes: 0 a verdict, whatever it says, 2 bad arguments or bad input, 3 the data do not allow one: too little was measured \
to find fault with the model, or the columns contradict each other. With --json `undecided` says why, and is there with 3 \
only; `adequate` beside it says that nothing was found, not that nothing is there.";

const AUTOPILOT: &str = "\
It makes a run, fits the baseline and diagnoses it. What is missing and certain is added. Where two effects explain the
data equally well, or an effect could not have shown, it makes the run that is expected to decide, and begins again with
all runs together. Every step is kept with its before and after, and every run passes the bench's limits and guard.

  jointbench autopilot --runs 3 --wait                  at most three runs, told as they happen
  jointbench autopilot --bench-time-s 600 --set load_levels=2 --wait
  jointbench autopilot --after 4 --wait                 only the run that diagnosis 4 asks for

Exit codes: 0 nothing is left to add (also where structure remains that no effect explains: the \
verdict says so), 1 a run failed or somebody ended it, 2 bad arguments, 3 the data decide too little, \
or the budget is spent and something is still open.";

const RUN: &str = "\
Exit codes, where the end is waited for: 0 the procedure has identified what it is for and every \
demand is kept, 1 the run or its identification failed or a limit was broken, 2 bad arguments (also \
--continue of a run of which nothing is left, and --require of a quantity that the result does not have), 3 the identification is inconclusive or a demand unsure.";

#[derive(Debug, Args)]
pub struct Autopilot {
    /// At most so many runs, the first included
    #[arg(long, value_name = "N", default_value_t = 3)]
    pub runs: u32,
    /// At most so much time of the bench [s]
    #[arg(long, value_name = "S")]
    pub bench_time_s: Option<f64>,
    /// Procedure of the first run
    #[arg(long, value_name = "ID", default_value = "friction")]
    pub procedure: String,
    /// A parameter of the first run, in SI units; may be given again
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// Effects of the model to start from, with commas between [default: `baseline` of the procedure]
    #[arg(long, value_name = "EFFECTS")]
    pub model: Option<String>,
    /// Add at most so many effects
    #[arg(long, value_name = "N", default_value_t = 6)]
    pub max_effects: u32,
    /// Make only the run that this diagnosis asks for, and diagnose its model again with it
    #[arg(long, value_name = "DIAGNOSIS", conflicts_with_all = ["runs", "bench_time_s", "procedure", "set", "model", "max_effects"])]
    pub after: Option<i64>,
    /// Bench to run on; not needed where the daemon has only one
    #[arg(long, value_name = "NAME")]
    pub bench: Option<String>,
    /// Follow it to its end; Ctrl-C stops waiting, not the autopilot
    #[arg(long)]
    pub wait: bool,
    /// Print the autopilot with all its steps as JSON
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    pub reach: Reach,
}

/// A measured run, or several of one joint, and how to read and prepare it.
#[derive(Debug, Args)]
pub struct Measured {
    /// Run table: text (.csv, .tsv, .txt, .dat and others, also .gz), .parquet or .arrow, or the folder of a run.csv; further runs of the same kind and
    /// joint are looked at together with the first, in the order in which they were made
    #[arg(required = true, value_name = "RUN")]
    pub files: Vec<PathBuf>,
    /// Facts about the set-up, for all files [default: RUN.meta.json or meta.json beside each file, or what is embedded]
    #[arg(long, value_name = "META.JSON")]
    pub meta: Option<PathBuf>,
    /// Effects of the model, with commas between [default: `baseline` of the facts]
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

/// How the run is prepared. Everything left out is chosen from the data and told with the fit.
#[derive(Debug, Args)]
#[command(next_help_heading = "Preparation (chosen from the data where left out)")]
pub struct Preparation {
    /// What the residual is made of
    #[arg(long, value_name = "KIND", value_parser = ["raw", "plateau_mean"])]
    pub residual: Option<String>,
    /// Corner of the zero-phase low-pass filter [Hz]
    #[arg(long, value_name = "HZ", allow_negative_numbers = true)]
    pub cutoff_hz: Option<f64>,
    /// Keep one of so many samples
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub decimation: Option<usize>,
    /// Length of the pieces that plateaus are averaged over [s]
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    pub chunk_s: Option<f64>,
    /// Family-wise error that is accepted for everything that is shown
    #[arg(long, value_name = "SHARE", allow_negative_numbers = true)]
    pub alpha: Option<f64>,
}

#[derive(Debug, Args)]
pub struct Diagnose {
    #[command(flatten)]
    pub run: Measured,
    /// Draw what the model leaves over each quantity, too; with --json over chosen pairs as well
    #[arg(long)]
    pub maps: bool,
}

#[derive(Debug, Args)]
pub struct Discover {
    #[command(flatten)]
    pub run: Measured,
    /// Add at most so many effects
    #[arg(long, value_name = "N", default_value_t = 6)]
    pub max_effects: usize,
}

#[derive(Debug, Args)]
pub struct Fit {
    #[command(flatten)]
    pub run: Measured,
    /// Predict another run with the fit, and tell the error there
    #[arg(long, value_name = "OTHER.CSV")]
    pub evaluate: Option<PathBuf>,
    /// Write the complete fit to a file, for `jointbench model`
    #[arg(long, value_name = "MODEL.JSON")]
    pub out: Option<PathBuf>,
}
