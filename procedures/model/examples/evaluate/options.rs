//! Command line options.

use clap::Parser;
use clap::builder::PossibleValuesParser;
use std::path::PathBuf;

const PARTS: [&str; 9] =
    ["hidden", "removed", "practice", "measured", "null", "power", "detectable", "speed", "styles"];

/// Measures the diagnosis, as docs/diagnosis.md reports it.
///
/// hidden: machines with hidden effects, simulated here. removed: one effect taken out of their complete models.
/// practice: measurements with a known answer from beside the repository. measured: measurements made by others, beside
/// what is asked of each. null: runs with nothing hidden. power: weak effects. detectable: effects of the size from which
/// they are said to be found. speed: seconds and memory. styles: excitations and laws of a second generator.
#[derive(Parser)]
#[command(name = "evaluate")]
pub struct Asked {
    /// Only these, with commas between them
    #[arg(long = "part", value_delimiter = ',', value_parser = PossibleValuesParser::new(PARTS), default_values = PARTS)]
    parts: Vec<String>,
    /// Rounds over all effects of all families
    #[arg(long, default_value_t = 3)]
    pub rounds: u64,
    /// Null runs, runs of each kind of `styles`, and runs for each weak or just detectable effect: a tenth of it
    #[arg(long, default_value_t = 400)]
    pub count: u64,
    /// Number of the first round, null run or weak effect: other numbers are other machines and other noise
    #[arg(long, default_value_t = 0)]
    pub first: u64,
    /// Only families whose name contains this
    #[arg(long, default_value = "", hide_default_value = true)]
    family: String,
    /// Only cases whose name contains this
    #[arg(long, default_value = "", hide_default_value = true)]
    only: String,
    /// One case of `speed`, in this process
    #[arg(long, hide = true)]
    pub case: Option<usize>,
    /// Write the cases of `styles` as folders into this one instead of scoring them
    #[arg(long)]
    pub write: Option<PathBuf>,
    /// Tables only
    #[arg(long)]
    pub quiet: bool,
    /// A folder that holds a run, or one of such folders with answers: these alone
    pub folder: Option<PathBuf>,
}

impl Asked {
    pub fn wants(&self, part: &str) -> bool {
        self.parts.iter().any(|p| p == part)
    }

    pub fn takes(&self, family: &str, name: &str) -> bool {
        family.contains(&self.family) && name.contains(&self.only)
    }
}
