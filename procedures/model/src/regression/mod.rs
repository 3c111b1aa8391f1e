//! Models as sums of effects: candidate regressors, canonical fits, and the part that each effect explains given the
//! others.

pub(crate) mod candidates;
pub(crate) mod canonical_fit;
pub(crate) mod cross_validation;
pub(crate) mod evidence;
pub(crate) mod form_selection;
pub(crate) mod hysteresis_form;
pub(crate) mod layout;
pub(crate) mod least_squares;
pub(crate) mod linear_model;
pub(crate) mod partial_regression;
pub(crate) mod remainder;
pub(crate) mod significance;
pub(crate) mod solution;
pub(crate) mod term;
pub(crate) mod two_stage_model;
pub(crate) mod weights;
