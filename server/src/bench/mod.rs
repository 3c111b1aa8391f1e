//! One bench, one thread: the thread owns the instruments, everybody else holds a [`BenchHandle`].

mod handle;
mod health;
mod instruments;
mod look;
mod recorder;
mod status;
mod thread;

pub use handle::BenchHandle;
pub use instruments::{Opened, open, reach};
pub use look::{Look, look};
pub use status::Status;
