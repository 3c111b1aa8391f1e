//! Arguments of `jointbench archive`.

use super::Reach;
use clap::Args;
use std::time::Duration;

pub(super) const ARCHIVE: &str = "\
The file of each run is read and compared before its samples are removed. Results, journal and overview of the run stay. For its
samples, import the file again: `jointbench runs` and REST name it.";

#[derive(Debug, Args)]
pub struct Archive {
    /// Try all tables that wait or have failed again, now
    #[arg(long, conflicts_with = "drop_samples")]
    pub retry: bool,
    /// Remove the samples of archived runs from the store
    #[arg(long, requires = "older_than")]
    pub drop_samples: bool,
    /// Only of runs that ended at least this time ago, such as 90d
    #[arg(long, value_name = "AGE", value_parser = age, requires = "drop_samples")]
    pub older_than: Option<Duration>,
    /// Only list these runs
    #[arg(long, requires = "drop_samples")]
    pub dry_run: bool,
    /// Print JSON
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    pub reach: Reach,
}

const UNITS: [(char, u64); 3] = [('h', 3600), ('d', 86_400), ('w', 7 * 86_400)];

fn age(text: &str) -> Result<Duration, String> {
    let parsed = UNITS.iter().find_map(|(unit, seconds)| {
        let count: u32 = text.strip_suffix(*unit)?.parse().ok()?;
        Some(Duration::from_secs(u64::from(count) * seconds))
    });
    parsed.ok_or_else(|| "expected hours, days or weeks, such as 12h, 90d or 4w".to_owned())
}
