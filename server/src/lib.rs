//! The top layer: configuration, one thread for each bench, store, API, live stream, command line.
//!
//! Only this crate uses tokio, axum and sqlx.

#![cfg_attr(not(test), warn(clippy::unwrap_used))]

pub mod api;
mod archive;
pub mod bench;
pub mod cli;
pub mod config;
pub mod daemon;
pub mod error;
pub mod job;
pub mod lab;
pub mod limits;
pub mod listener;
pub mod live;
mod notify;
mod priority;
pub mod program;
pub mod report;
pub mod store;
pub mod view;

/// Version, in a release build with the revision.
pub const VERSION: &str = match option_env!("JOINTBENCH_VERSION") {
    Some(version) => version,
    None => env!("CARGO_PKG_VERSION"),
};
