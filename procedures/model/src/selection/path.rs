//! The steps of a selection.

use crate::regression::two_stage_model::TwoStageModel;
use crate::report::reasons::RemovalReason;
use crate::selection::forward_step::ScoredCandidate;

/// An added or removed effect, and the model after this step.
pub struct SelectionStep<'p> {
    pub added: Option<ScoredCandidate<'p>>,
    pub removed: Option<(&'p str, RemovalReason)>,
    pub ties: Vec<&'p str>,
    pub after: TwoStageModel<'p>,
}

/// The steps from the first model to the last one.
pub struct Path<'p> {
    pub start: TwoStageModel<'p>,
    pub steps: Vec<SelectionStep<'p>>,
}

impl<'p> Path<'p> {
    pub fn new(start: TwoStageModel<'p>) -> Self {
        Self { start, steps: Vec::new() }
    }

    pub fn end(&self) -> &TwoStageModel<'p> {
        self.steps.last().map_or(&self.start, |a| &a.after)
    }

    pub fn push(&mut self, step: SelectionStep<'p>) {
        self.steps.push(step);
    }
}
