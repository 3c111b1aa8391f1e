//! Statistics that know no model.

pub(crate) mod grouped;
pub(crate) mod permutation_test;
