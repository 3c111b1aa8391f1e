//! The daemon on a real loopback port, as its callers meet it.

mod daemon;
mod door;
mod import;
mod live;
mod problems;
mod runs;
