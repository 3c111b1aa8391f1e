//! Questions over thousands of joints, answered from the archive of Parquet files that the daemon writes.
//!
//! `archive` reads the layout of docs/archive.md, `session` makes the tables for SQL, `gram` is the mergeable Gram
//! matrix as an aggregate function. `fit` and `diagnose` use the model of the daemon for each unit, and `statistics`
//! combines the units.

#![warn(missing_docs)]

pub mod archive;
pub mod cli;
pub mod compact;
pub mod diagnose;
mod fault;
pub mod fit;
pub mod gram;
pub mod query;
pub mod report;
pub mod session;
pub mod statistics;
mod table;
pub mod units;

pub use fault::Fault;
