//! Offset terms have a fixed coefficient of one, so that no size is searched: the model includes the effect or not.

use crate::Options;
use crate::regression::candidates::CandidateSet;
use crate::regression::cross_validation::{is_tie, validation_losses};
use crate::regression::linear_model::Term;
use crate::regression::partial_regression::PartialRegression;
use crate::regression::significance::significance;
use crate::regression::two_stage_model::TwoStageModel;
use crate::report::reasons::AdditionReason;
use crate::selection::forward_step::ScoredCandidate;
use crate::selection::path::SelectionStep;

/// Adds the power balance if the model lacks it and the data supports it. Friction effects must not explain power
/// that the joint only transmits.
pub fn step<'p>(start: &TwoStageModel<'p>, library: &CandidateSet<'p>, options: &Options) -> Option<SelectionStep<'p>> {
    let problem = start.main.problem;
    let is_out = |id: &str| !start.effects.iter().any(|e| e == id);
    let missing =
        |e: &&dyn crate::Effect| e.traits().is_offset && is_out(e.info().id) && e.hidden(&problem.view).is_none();
    let effect = start.spec.known().find(missing)?;
    let form = effect.forms(&problem.view).into_iter().next()?;
    let term = Term::new(effect, form, Vec::new(), problem);
    let mut with = start.main.clone();
    for column in &term.columns {
        with.given.iter_mut().zip(column).for_each(|(g, c)| *g += c);
    }
    with.refine();
    let (was, is) = (validation_losses(&start.main), validation_losses(&with));
    let share = 1.0 - with.linear().sse / start.main.linear().sse;
    let p_value = significance(&term, library, &PartialRegression::of(&start.main), options);
    if share < options.practical_share || p_value > options.alpha || is_tie(&is, &was) {
        return None;
    }
    let effects = start.effects.iter().cloned().chain([effect.info().id.to_owned()]).collect();
    let after = start.of(with, effects);
    Some(SelectionStep {
        added: Some(ScoredCandidate::alone(term, share, p_value, AdditionReason::KnownSize)),
        removed: None,
        ties: Vec::new(),
        after,
    })
}
