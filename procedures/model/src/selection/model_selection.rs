//! What a search for missing effects ends with.

use crate::regression::linear_model::LinearModel;
use crate::regression::two_stage_model::TwoStageModel;
use crate::report::diagnosis::Imitated;
use crate::residual_analysis::maps::Maps;
use crate::selection::advance::SelectionStep;
use crate::selection::detection_limit::DetectionLimit;
use crate::selection::refused::Decided;
use crate::selection::removal::Withdrawn;

/// The way from the given model to the last one, and what was learnt on it.
pub struct ModelSelection<'p> {
    pub start: TwoStageModel<'p>,
    pub advances: Vec<SelectionStep<'p>>,
    pub withdrawn: Vec<Withdrawn<'p>>,
    /// The steady-state part of the last model.
    pub now: LinearModel<'p>,
    /// What it leaves beside all directions in which it could move.
    pub residual: Vec<f64>,
    /// Maps of that.
    pub maps: Maps,
    pub silences: Vec<DetectionLimit<'p>>,
    /// Effects of the last model, and what this run cannot tell them from.
    pub ties: Vec<(&'p str, &'p str)>,
    /// Effects of the last model that the error would hardly miss.
    pub upheld: Vec<Imitated>,
    /// One that may be there as well.
    pub open: Option<Imitated>,
    /// What one decision leaves, where the run is judged sample by sample.
    pub decided: Option<Decided<'p>>,
}

impl<'p> ModelSelection<'p> {
    pub fn end(&self) -> &TwoStageModel<'p> {
        self.advances.last().map_or(&self.start, |a| &a.after)
    }
}
