//! Bytes in, bytes out: each firmware against what its maker publishes.

mod adam;
mod dmm;
mod dp800;
mod fuzz;
mod gcs;
mod hmp;
mod lorenz;
mod odrive;
mod puma;
mod puma_memory;
mod qsb;
