//! The daemon on a real loopback port, as its callers meet it.

mod autopilots;
mod calibrations;
mod daemon;
mod differences;
mod disk;
mod door;
mod import;
mod live;
mod log;
mod own_effects;
mod problems;
mod revisions;
mod runs;
mod safety;
mod tables;
