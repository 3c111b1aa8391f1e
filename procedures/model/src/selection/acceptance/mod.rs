//! Rules that a candidate has to pass before it enters a model, one file for each rule.

pub(crate) mod aliasing;
pub(crate) mod between_leg_variance;
pub(crate) mod feasible_parameters;
pub(crate) mod formula_error;
