//! Bytes in, bytes out: each firmware compared with its maker's documents.

mod adam;
mod dmm;
mod dp800;
mod fuzz;
mod gcs;
mod hmp;
mod kepco;
mod lorenz;
mod odrive;
mod puma;
mod puma_memory;
mod qsb;
mod supply;
