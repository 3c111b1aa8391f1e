//! Statistics that are independent of models.

pub(crate) mod grouped;
pub(crate) mod information_criterion;
pub mod jackknife;
pub(crate) mod permutation_test;
pub mod proportion;
pub mod student;
pub mod summary;
