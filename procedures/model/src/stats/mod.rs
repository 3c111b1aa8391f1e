//! Statistics that are independent of models.

pub(crate) mod grouped;
pub(crate) mod permutation_test;
