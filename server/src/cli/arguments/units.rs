//! Arguments for units under test.

use super::StorePlace;
use clap::Args;

/// The unit under test of a run, and its operator.
#[derive(Debug, Args)]
#[command(next_help_heading = "Unit under test")]
pub struct UnitArguments {
    /// Serial number of the unit, as a scanner reads it
    #[arg(long, value_name = "SERIAL")]
    pub unit: Option<String>,
    /// Part number of the unit
    #[arg(long, value_name = "PART", requires = "unit")]
    pub part: Option<String>,
    /// Revision of the part
    #[arg(long, value_name = "REVISION", requires = "unit")]
    pub revision: Option<String>,
    /// Batch of the unit
    #[arg(long, value_name = "BATCH", requires = "unit")]
    pub batch: Option<String>,
    /// Name of the person who starts the run
    #[arg(long, value_name = "NAME")]
    pub operator: Option<String>,
}

pub(super) const UNITS: &str = "\
A run belongs to a unit if it was started with its serial number: `jointbench run friction --unit SN123 --part P --batch 7`.

  jointbench units                             all units, newest first
  jointbench units part:P batch:7              units with a run that matches, and their yield
  jointbench runs unit:SN123                   the runs of one unit
  jointbench units --reference REF1            REF1 checks the bench: yields and control charts exclude it

First-pass yield is the fraction of units whose first complete run of a procedure was identified, with its 95 % interval. Stopped \
and failed runs do not count.";

#[derive(Debug, Args)]
pub struct Units {
    /// Words and terms as in `jointbench runs`, such as unit:SN1, part:P or batch:7; all must match
    #[arg(value_name = "TERM")]
    pub search: Vec<String>,
    /// Mark a unit as a reference unit, which yields and control charts exclude
    #[arg(long, value_name = "SERIAL", conflicts_with_all = ["search", "no_reference"])]
    pub reference: Option<String>,
    /// The unit is no reference unit any longer
    #[arg(long, value_name = "SERIAL", conflicts_with = "search")]
    pub no_reference: Option<String>,
    /// Print JSON
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    pub store: StorePlace,
}
