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

/// The steps from the first model to the last one. `on_advance` gets each step as soon as it is made.
pub struct Path<'a, 'p> {
    pub start: TwoStageModel<'p>,
    pub advances: Vec<SelectionStep<'p>>,
    on_advance: &'a mut dyn FnMut(&SelectionStep),
}

impl<'a, 'p> Path<'a, 'p> {
    pub fn new(start: TwoStageModel<'p>, on_advance: &'a mut dyn FnMut(&SelectionStep)) -> Self {
        Self { start, advances: Vec::new(), on_advance }
    }

    pub fn end(&self) -> &TwoStageModel<'p> {
        self.advances.last().map_or(&self.start, |a| &a.after)
    }

    pub fn push(&mut self, advance: SelectionStep<'p>) {
        (self.on_advance)(&advance);
        self.advances.push(advance);
    }
}
