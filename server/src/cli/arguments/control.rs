//! Arguments that control a run or a bench.

use super::Reach;
use clap::Args;

pub(super) const STOP: &str = "Exit codes: 0 the run has ended and the bench is in its safe state, 1 the run failed \
                               earlier or the safe state is not confirmed, 2 no run is active, or the named run has \
                               already ended.";

pub(super) const STEER: &str = "Exit codes: 0 done, 1 the run has ended or does not allow it now, 2 no such active \
                                run.";

#[derive(Debug, Args)]
pub struct Stop {
    /// Number of the run [default: the active run]
    pub run: Option<i64>,
    /// End the run immediately: the shaft stops, then the brake current is switched off. A loaded brake stays
    /// magnetised: run `demagnetise` before the next measurement with the brake
    #[arg(long)]
    pub now: bool,
    #[command(flatten)]
    pub reach: Reach,
}

#[derive(Debug, Args)]
pub struct Control {
    /// Number of the run [default: the active run]
    pub run: Option<i64>,
    #[command(flatten)]
    pub reach: Reach,
}

pub(super) const MEMORY: &str = "\
  jointbench servo-memory                        all variables of table 2.7
  jointbench servo-memory 0x04 --bench puma      only the velocity gain

Exit codes: 0 done, 1 a run is in progress or the servo does not answer, 2 bad arguments, or the bench has no such servo.";

#[derive(Debug, Args)]
pub struct ServoMemory {
    /// Address from 0x00 to 0x7F [default: all variables]
    #[arg(value_parser = address)]
    pub address: Option<u8>,
    /// Bench of the servo; optional if the daemon has only one
    #[arg(long, value_name = "NAME")]
    pub bench: Option<String>,
    /// Print the variables as JSON
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    pub reach: Reach,
}

fn address(text: &str) -> Result<u8, String> {
    let number = match text.strip_prefix("0x").or_else(|| text.strip_prefix("0X")) {
        Some(digits) => u8::from_str_radix(digits, 16),
        None => text.parse(),
    };
    number.ok().filter(|address| *address <= 0x7F).ok_or_else(|| "expected an address from 0x00 to 0x7F".to_owned())
}

#[derive(Debug, Args)]
pub struct Reset {
    /// Bench to release; optional if the daemon has only one
    pub bench: Option<String>,
    /// Findings and action taken; stored with the bench
    #[arg(long, value_name = "TEXT")]
    pub reason: String,
    #[command(flatten)]
    pub reach: Reach,
}

#[derive(Debug, Args)]
pub struct Notify {
    /// Send a test message to each target; exit code 1 if one does not get it
    #[arg(long)]
    pub test: bool,
    /// Print JSON
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    pub reach: Reach,
}
