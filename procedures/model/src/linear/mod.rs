//! Linear least squares: an orthonormal basis for selection, Gram matrices of blocks for everything that is repeated
//! many times, and the condition of the columns by QR for the fit that is shown.

mod basis;
mod beside;
mod condition;
mod gram;

pub use basis::{Basis, dot};
pub use beside::Beside;
pub use condition::condition;
pub use gram::{BlockGrams, Spd};
