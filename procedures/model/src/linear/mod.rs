//! Linear least squares: an orthonormal basis for selection, Gram matrices of blocks for repeated fits, and the
//! condition number of the columns by QR for the reported fit.

pub(crate) mod added_columns;
pub(crate) mod augmented_gram;
pub(crate) mod basis;
pub(crate) mod blocked_ridge;
pub(crate) mod cholesky;
pub(crate) mod condition;
pub(crate) mod gram;
pub mod moments;
pub(crate) mod non_negative;

pub use crate::linear::augmented_gram::AugmentedGrams;
pub(crate) use crate::linear::basis::Basis;
pub use crate::linear::cholesky::Cholesky;
pub(crate) use crate::linear::condition::condition;
pub use crate::linear::gram::BlockGrams;
