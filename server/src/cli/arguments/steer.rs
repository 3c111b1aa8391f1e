//! What a run that is on, or a bench that stands still, can be told.

use super::Reach;
use clap::Args;

pub(super) const STOP: &str = "\
Exit codes: 0 the run has ended and the bench is safe, 1 the run failed before it could be ended or the bench is not known \
to be safe, 2 nothing is there to be ended: no run is on, or the one that is named is over.";

pub(super) const STEER: &str = "\
Exit codes: 0 done, 1 the run ended before that, or cannot do it now, 2 no such run is on.";

#[derive(Debug, Args)]
pub struct Stop {
    /// Number of the run [default: the one that is on]
    pub run: Option<i64>,
    /// End it at once: the shaft comes to rest, then the brake's current is taken away. That leaves poles in a brake that
    /// was loaded: make `demagnetise` before the next run that counts on it
    #[arg(long)]
    pub now: bool,
    #[command(flatten)]
    pub reach: Reach,
}

#[derive(Debug, Args)]
pub struct Steer {
    /// Number of the run [default: the one that is on]
    pub run: Option<i64>,
    #[command(flatten)]
    pub reach: Reach,
}

#[derive(Debug, Args)]
pub struct Reset {
    /// Bench to release; not needed where the daemon has only one
    pub bench: Option<String>,
    /// What was found at the bench and done; kept with it
    #[arg(long, value_name = "TEXT")]
    pub reason: String,
    #[command(flatten)]
    pub reach: Reach,
}
