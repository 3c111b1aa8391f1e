//! The base crate: the measurements and commands of a joint test bench.
//!
//! Units, samples, run tables, instrument roles, limits, faults and clocks. No I/O, no threads, no async: every other
//! crate depends on this one. It depends only on serde, serde_json and thiserror.

#![warn(missing_docs)]
#![cfg_attr(not(test), warn(clippy::unwrap_used))]

pub mod bench;
pub mod clock;
pub mod fault;
mod join;
pub mod limits;
pub mod link_latency;
pub mod meta;
pub mod roles;
pub mod skew;
pub mod spelling;
pub mod table;
pub mod trace;
pub mod units;
pub mod zero;

pub use bench::Bench;
pub use clock::{Clock, SystemClock};
pub use fault::{Fault, FaultKind};
pub use join::JoinFault;
pub use limits::{Breach, Limits, TorsionLimit};
pub use link_latency::{LatencyCounter, LinkLatency};
pub use meta::{FactShape, Kind, Meta, Motion};
pub use table::{RunTable, TableFault};
pub use trace::{Channel, Trace};
