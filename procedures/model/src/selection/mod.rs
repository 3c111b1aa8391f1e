//! Selection of missing effects: forward steps, acceptance, pruning, and the stages that follow.

pub(crate) mod acceptance;
pub(crate) mod detection_limit;
pub(crate) mod equivalence;
pub(crate) mod evidence_search;
pub(crate) mod floating_search;
pub(crate) mod forward_step;
pub(crate) mod hysteresis_stage;
#[cfg(test)]
mod listed_rules;
pub(crate) mod model_selection;
pub(crate) mod offset_terms;
pub(crate) mod omitted_variable_bias;
pub(crate) mod path;
pub(crate) mod pruning;
pub(crate) mod ramp_stage;
pub(crate) mod refused;
pub(crate) mod removal;
pub(crate) mod staged_search;
#[cfg(test)]
pub(crate) mod tiny;

use crate::preprocess::Prepared;
use crate::selection::model_selection::ModelSelection;
use crate::{ModelError, ModelSpec, Options};

/// Searches for at most `most` missing effects: by evidence if the run is judged sample by sample, else in stages.
pub(crate) fn search<'p>(
    prepared: &'p Prepared,
    spec: &'p ModelSpec,
    options: &Options,
    most: usize,
) -> Result<ModelSelection<'p>, ModelError> {
    match prepared.main.form_error {
        Some(_) => evidence_search::search(prepared, spec, options, most),
        None => staged_search::search(prepared, spec, options, most),
    }
}
