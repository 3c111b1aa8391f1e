//! Which effects are missing: forward steps, acceptance, pruning, and the stages that follow.

pub(crate) mod acceptance;
pub(crate) mod advance;
pub(crate) mod detection_limit;
pub(crate) mod equivalence;
pub(crate) mod floating_search;
pub(crate) mod forward_step;
pub(crate) mod hysteresis_stage;
pub(crate) mod model_selection;
pub(crate) mod offset_terms;
pub(crate) mod omitted_variable_bias;
pub(crate) mod pruning;
pub(crate) mod ramp_stage;
pub(crate) mod removal;
