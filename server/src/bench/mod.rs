//! Each bench has one worker process, which owns the instruments ([`worker`]). Other code uses a [`BenchHandle`]. They
//! exchange messages ([`wire`]). One task ([`keeper`]) stores all data, and only this task waits for the disk.

mod display;
mod error;
mod handle;
mod health;
mod instrument_check;
mod instruments;
mod item;
mod keeper;
mod leftovers;
mod shared;
mod status;
mod supervisor;
mod view;
mod wire;
pub mod worker;

pub use error::BenchError;
pub use handle::{BenchHandle, InitialState, facts};
pub use instrument_check::{InstrumentCheck, check_instruments};
pub use instruments::{Opened, open, reach};
pub use leftovers::store_all as store_leftovers;
pub use status::Status;
pub use view::{bench_view, show_unstored_end};
