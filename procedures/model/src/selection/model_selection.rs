//! The result of a selection.

use crate::regression::linear_model::LinearModel;
use crate::regression::two_stage_model::TwoStageModel;
use crate::report::diagnosis::Imitated;
use crate::residual_analysis::maps::Maps;
use crate::selection::detection_limit::DetectionLimit;
use crate::selection::path::SelectionStep;
use crate::selection::refused::EvidenceResult;
use crate::selection::removal::Withdrawn;

/// The steps from the given model to the last one, with all findings.
pub struct ModelSelection<'p> {
    pub start: TwoStageModel<'p>,
    pub steps: Vec<SelectionStep<'p>>,
    pub withdrawn: Vec<Withdrawn<'p>>,
    /// The steady-state part of the last model.
    pub now: LinearModel<'p>,
    /// Residual of that model, orthogonal to its tangent space.
    pub residual: Vec<f64>,
    /// Maps of that residual.
    pub maps: Maps,
    pub detection_limits: Vec<DetectionLimit<'p>>,
    /// Effects of the last model with the effects that are confounded with them.
    pub ties: Vec<(&'p str, &'p str)>,
    /// Effects of the last model that hardly reduce the error, but prevent biased coefficients.
    pub retained: Vec<Imitated>,
    /// An effect that may be present as well.
    pub open: Option<Imitated>,
    /// Result of the evidence search, for runs that are judged sample by sample.
    pub decided: Option<EvidenceResult<'p>>,
}

impl<'p> ModelSelection<'p> {
    pub fn end(&self) -> &TwoStageModel<'p> {
        self.steps.last().map_or(&self.start, |a| &a.after)
    }
}
