//! Tests of the daemon on a real loopback port, as its clients use it.

mod autopilots;
mod calibrations;
mod daemon;
mod differences;
mod disk;
mod door;
mod headers;
mod import;
mod jobs;
mod limits;
mod live;
mod log;
mod names;
mod own_effects;
mod presses;
mod problems;
mod process_list;
mod readers;
mod revisions;
mod runs;
mod safety;
mod servo_memory;
mod spreadsheets;
mod tables;
mod tls;
