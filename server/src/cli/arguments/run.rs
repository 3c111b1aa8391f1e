//! Arguments that start a run or queue it.

use super::{Reach, UnitArguments};
use crate::limits::Requirement;
use clap::{Args, Subcommand};
use std::path::PathBuf;
use std::time::Duration;

#[derive(Debug, Args)]
pub struct Run {
    /// Id of the procedure, such as friction or warm_up
    #[arg(required_unless_present = "continues")]
    pub procedure: Option<String>,
    /// Complete an interrupted run: warm up, demagnetise the brake, then continue with the first unfinished step. Both
    /// runs together form one measurement
    #[arg(long = "continue", value_name = "RUN", conflicts_with_all = ["procedure", "set", "bench", "unit", "operator"])]
    pub continues: Option<i64>,
    /// A parameter of the procedure, in SI units; repeatable
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// Bench to run on; optional if the daemon has only one
    #[arg(long, value_name = "NAME")]
    pub bench: Option<String>,
    #[command(flatten)]
    pub unit: UnitArguments,
    /// Wait for the end; Ctrl-C stops waiting, and the run only with --lease
    #[arg(long)]
    pub wait: bool,
    /// Print the run as JSON
    #[arg(long)]
    pub json: bool,
    /// Limit for a quantity of the result, such as 'tau_c < 0.035 Nm'; waits for the end; repeatable. The whole 95 %
    /// interval must be within the limit: exit code 1 if the value exceeds it, 3 if only the interval exceeds it
    #[arg(long, value_name = "LIMIT")]
    pub require: Vec<Requirement>,
    /// File with the limits of parts and revisions, which is kept with the run; waits for the end. Those of the part and
    /// revision of the unit apply
    #[arg(long, value_name = "LIMITS.TOML", conflicts_with = "continues")]
    pub limits: Option<PathBuf>,
    /// Write a JUnit report with one test case per limit; waits for the end
    #[arg(long, value_name = "REPORT.XML")]
    pub junit: Option<PathBuf>,
    /// Maximum time in the queue, and maximum duration of the run [s], by the clock; waits for the end. A run that takes longer is aborted, the bench
    /// is secured, and the exit code is 1 in both cases; the message states which time was exceeded
    #[arg(long, value_name = "S", value_parser = seconds)]
    pub timeout: Option<Duration>,
    /// Wait in the queue of the bench until it is free
    #[arg(long, conflicts_with = "continues")]
    pub queue: bool,
    /// In the queue, the largest priority starts first [default: 0]
    #[arg(long, value_name = "N", requires = "queue", allow_negative_numbers = true)]
    pub priority: Option<i32>,
    /// A repeated request with the same key is queued once (Idempotency-Key)
    #[arg(long, value_name = "KEY", requires = "queue")]
    pub key: Option<String>,
    /// A note about the run
    #[arg(long, value_name = "TEXT", conflicts_with = "continues")]
    pub note: Option<String>,
    /// End the run in order, or remove it from the queue, S seconds after this command has ended; waits for the end; 1 to
    /// 86400
    #[arg(long, value_name = "S", value_parser = lease, conflicts_with = "continues")]
    pub lease: Option<Duration>,
    #[command(flatten)]
    pub reach: Reach,
}

impl Run {
    /// Whether the command waits for the end of the run.
    pub fn waits(&self) -> bool {
        let is_judged = !self.require.is_empty() || self.limits.is_some();
        self.wait || self.junit.is_some() || self.timeout.is_some() || self.lease.is_some() || is_judged
    }
}

fn lease(text: &str) -> Result<Duration, String> {
    let is_possible = |lease: &Duration| (1..=86_400).contains(&lease.as_secs());
    seconds(text).ok().filter(is_possible).ok_or_else(|| "expected 1 to 86400 seconds".to_owned())
}

fn seconds(text: &str) -> Result<Duration, String> {
    let wrong = || "expected a number of seconds above 0, such as 600".to_owned();
    let seconds = text.parse::<f64>().ok().filter(|seconds| *seconds > 0.0).ok_or_else(wrong)?;
    Duration::try_from_secs_f64(seconds).map_err(|_| wrong())
}

pub(super) const RUN: &str = "\
A limits file has one [[limit]] for each quantity; part, revision and procedure are optional, and the entry that names most
of them applies. `pass` needs the whole 95 % interval inside the limits by the guard band; `fail` is a value beyond a limit; all
between is `marginal`; a value without an interval is `inconclusive`. A run that continues another one keeps its limits.

  [[limit]]
  part = \"JA-100\"
  quantity = \"tau_c\"
  lower = 0.02
  upper = 0.035
  unit = \"Nm\"
  guard_band = 0.0005

Exit codes, when waiting for the end: 0 identified and all limits met, 1 the run or its identification failed, a limit was \
exceeded, or --timeout ended the wait in the queue or the run, 2 bad arguments (also --continue of a complete run, and --require of a quantity that the result does not contain), \
3 the identification is inconclusive, or a limit is marginal or inconclusive.";

pub(super) const QUEUE: &str = "\
A test plan has runs of one bench and one unit, in order:

  proceed_if = \"identified\"
  [[run]]
  procedure = \"warm_up\"
  [[run]]
  procedure = \"friction\"
  parameters = { repeats = 3 }
  limits = \"limits.toml\"

  jointbench queue add plan.toml --unit SN123 --wait --junit report.xml

The same as JSON in a .json file. The limits file is relative to the test plan. `proceed_if` is \"completed\" (default), \
\"identified\", or \"pass\" (identified and all limits met). If a run does not meet it, the rest of its test plan is removed. The \
runs of a test plan that has begun stay together.

A queue proceeds after a completed run, and after one that its lease ended. It is paused after any other end, if the next run is \
of another unit, if the bench is not ready, and after a restart of the daemon. Then nothing moves until `jointbench queue resume`.";

#[derive(Debug, Args)]
pub struct Queue {
    #[command(subcommand)]
    pub command: Option<QueueCommand>,
    /// Print JSON
    #[arg(long, global = true)]
    pub json: bool,
    #[command(flatten)]
    pub reach: Reach,
}

#[derive(Debug, Subcommand)]
pub enum QueueCommand {
    /// List the waiting runs with their expected start, and the last five that left the queue (the default); all with --json
    List,
    /// Queue the runs of a test plan for one unit
    Add {
        /// Test plan, TOML or JSON
        #[arg(value_name = "PLAN")]
        plan: PathBuf,
        /// Bench to run on, instead of that of the test plan; optional if the daemon has only one
        #[arg(long, value_name = "NAME")]
        bench: Option<String>,
        /// The largest priority starts first
        #[arg(long, value_name = "N", default_value_t = 0, allow_negative_numbers = true)]
        priority: i32,
        /// Wait for the end of all runs; the exit code is that of the worst, as of `jointbench run`
        #[arg(long)]
        wait: bool,
        /// Write a JUnit report with one test case per run and limit; waits for the end
        #[arg(long, value_name = "REPORT.XML")]
        junit: Option<PathBuf>,
        #[command(flatten)]
        unit: UnitArguments,
    },
    /// Remove a waiting run
    Remove {
        /// Number of the entry
        entry: i64,
    },
    /// Undo the removal of a run: it waits again, in its former place
    Restore {
        /// Number of the entry
        entry: i64,
    },
    /// Change the priority of a waiting run: the largest starts first
    Priority {
        /// Number of the entry
        entry: i64,
        /// New priority
        #[arg(allow_negative_numbers = true)]
        priority: i32,
    },
    /// Start no further run; the active one continues
    Pause {
        /// Bench; optional if the daemon has only one
        bench: Option<String>,
    },
    /// Start waiting runs again
    Resume {
        /// Bench; optional if the daemon has only one
        bench: Option<String>,
    },
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_timeout_is_a_number_of_seconds() {
        assert_eq!(seconds("1.5"), Ok(Duration::from_millis(1500)));
        for text in ["0", "-1", "soon", "inf", "NaN"] {
            assert!(seconds(text).unwrap_err().contains("seconds above 0"), "{text}");
        }
    }
}
