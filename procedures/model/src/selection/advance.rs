//! One step of a selection.

use crate::regression::two_stage_model::TwoStageModel;
use crate::selection::forward_step::ScoredCandidate;

/// What was added or removed, and the model after it.
pub struct SelectionStep<'p> {
    pub added: Option<ScoredCandidate<'p>>,
    pub removed: Option<&'p str>,
    pub ties: Vec<&'p str>,
    pub after: TwoStageModel<'p>,
}
