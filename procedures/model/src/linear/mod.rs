//! Linear least squares: an orthonormal basis for selection, Gram matrices of blocks for everything that is repeated
//! many times, and QR on scaled columns for the fit that is shown.

mod basis;
mod gram;
mod qr;

pub use basis::{Basis, dot};
pub use gram::{BlockGrams, Spd};
pub use qr::solve;
