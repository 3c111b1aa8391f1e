//! The arguments.

use clap::{Args, Parser, Subcommand};
use std::num::NonZeroUsize;
use std::path::PathBuf;

/// Answers questions over all joints of an archive: which effect is missing in which proportion of the units, how parameters
/// are distributed, which batches and units differ.
///
/// The archive is the folder of Parquet files that jointbench writes ([archive] url = "file:///…"). This program only
/// reads it; compact also replaces small files.
#[derive(Debug, Parser)]
#[command(name = "jointbench-fleet", version, arg_required_else_help = true)]
pub struct Arguments {
    #[command(subcommand)]
    pub command: Command,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Run an SQL query (DataFusion) over the tables means, samples and runs.
    ///
    /// means: one row for each steady state. samples: all samples. runs: one row for each run and table, from the
    /// footers. Functions: gram(y, x1, …) is the Gram matrix of a least-squares problem; regressor('coulomb', velocity)
    /// is the column of an effect.
    ///
    /// Example: jointbench-fleet query "SELECT part, batch, count(DISTINCT serial) AS units FROM runs GROUP BY part,
    /// batch" --archive file:///srv/jointbench
    Query {
        /// The query.
        sql: String,
        #[command(flatten)]
        common: Common,
    },
    /// Fit a model to the means of each unit: mean, variance between units, shifted batches and outliers.
    ///
    /// The latest completed friction run of each serial number represents its unit.
    Fit(Modelled),
    /// Find the missing effects of each unit: proportion of units with each effect, by batch, and the list of the units.
    ///
    /// Each unit has the diagnosis of the daemon. The false discovery rate over units is 5 %.
    Diagnose(Modelled),
    /// Diagnose, and write the result as one HTML page without references to other files.
    Report {
        /// The page.
        #[arg(long, value_name = "FILE.html")]
        out: PathBuf,
        #[command(flatten)]
        modelled: Modelled,
    },
    /// Join the small files of each partition of the means to one sorted file.
    ///
    /// The new file is read back and compared before the old files are removed. Its footer lists the facts of each run.
    Compact {
        #[command(flatten)]
        common: Common,
    },
}

/// A model over the units of the archive.
#[derive(Debug, Args)]
pub struct Modelled {
    /// Effects of the model; jointbench effects lists them.
    #[arg(long, default_value = "coulomb + viscous")]
    pub model: String,
    /// Only units of this part number.
    #[arg(long)]
    pub part: Option<String>,
    #[command(flatten)]
    pub common: Common,
}

#[derive(Debug, Args)]
pub struct Common {
    /// Folder of the archive, or file:/// and its absolute path.
    #[arg(long, env = "JOINTBENCH_ARCHIVE", value_name = "URL")]
    pub archive: String,
    /// Print JSON. An unbounded end of an interval is null.
    #[arg(long)]
    pub json: bool,
    /// Omit damaged and foreign files. Each is named on standard error and in the result.
    #[arg(long)]
    pub skip_damaged: bool,
    /// Number of threads [default: all processors].
    #[arg(long, value_name = "N")]
    pub threads: Option<NonZeroUsize>,
}
