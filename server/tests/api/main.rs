//! Tests of the daemon on a real loopback port, as its clients use it.

mod auth;
mod autopilots;
mod calibrations;
mod daemon;
mod disk;
mod headers;
mod import;
mod jobs;
mod limits;
mod live;
mod log;
mod names;
mod presses;
mod problems;
mod process_list;
mod readers;
mod revisions;
mod run_comparison;
mod runs;
mod safety;
mod servo_memory;
mod spreadsheets;
mod tables;
mod tls;
mod units;
mod user_effects;
