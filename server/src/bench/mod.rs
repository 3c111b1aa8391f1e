//! One bench, one thread: the thread owns the instruments, everybody else holds a [`BenchHandle`].

mod handle;
mod instruments;
mod recorder;
mod status;
mod thread;

pub use handle::BenchHandle;
pub use instruments::{Opened, open};
pub use status::Status;
