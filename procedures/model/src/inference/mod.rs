//! Inference: intervals and states of parameters, confounding, and the range of validity.

pub(crate) mod block_intervals;
pub(crate) mod changepoint;
pub(crate) mod confounding;
pub(crate) mod drag_remanence;
pub(crate) mod form_error;
pub(crate) mod harmonic_order;
pub(crate) mod intervals;
pub(crate) mod parameter_state;
pub(crate) mod validity_range;
