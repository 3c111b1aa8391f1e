//! One bench, one worker: a process of its own holds the instruments ([`worker`]), everybody else a [`BenchHandle`]. Between
//! them go messages ([`wire`]); what is to be stored goes through one task ([`keeper`]), which alone waits for the disk.

mod display;
mod handle;
mod health;
mod instruments;
mod keeper;
mod leftovers;
mod look;
mod shared;
mod status;
mod supervisor;
mod wire;
pub mod worker;

pub use handle::{Beginning, BenchHandle, facts};
pub use instruments::{Opened, open, reach};
pub use leftovers::store_all as store_leftovers;
pub use look::{Look, look};
pub use status::Status;
