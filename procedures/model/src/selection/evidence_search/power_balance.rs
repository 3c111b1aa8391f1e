//! Adds the power balance before the search: its size is known, so that it has no coefficient to test.

use crate::regression::candidates::CandidateSets;
use crate::regression::evidence::{chance, errors};
use crate::regression::linear_model::Term;
use crate::regression::solution::Solution;
use crate::regression::two_stage_model::TwoStageModel;
use crate::report::reasons::AdditionReason;
use crate::selection::forward_step::ScoredCandidate;
use crate::selection::path::SelectionStep;
use crate::thresholds::DECISION_SHARE;
use crate::{Effect, Options};

/// The power balance, if the model lacks it and the data supports it.
pub fn power_balance<'p>(
    start: &TwoStageModel<'p>,
    sets: &CandidateSets<'p>,
    options: &Options,
) -> Option<SelectionStep<'p>> {
    let problem = start.main.problem;
    let is_out = |id: &str| !start.effects.iter().any(|e| e == id);
    let missing = |e: &&dyn Effect| e.traits().is_offset && is_out(e.info().id) && e.hidden(&problem.view).is_none();
    let effect = start.spec.known().find(missing)?;
    let form = effect.forms(&problem.view).into_iter().next()?;
    let term = Term::new(effect, form, Vec::new(), problem);
    let effects: Vec<String> = start.effects.iter().cloned().chain([effect.info().id.to_owned()]).collect();
    let after = TwoStageModel::from_candidates(sets, effects).ok()?;
    let (was, is) = (Solution::of(&start.main)?, Solution::of(&after.main)?);
    let (was, is) = (was.validation_losses(&start.main), is.validation_losses(&after.main));
    let gains: Vec<f64> = was.iter().zip(&is).map(|(was, is)| was - is).collect();
    let gain = gains.iter().sum::<f64>() / was.iter().sum::<f64>();
    let standard_errors = errors(&gains);
    let p_value = chance(standard_errors.powi(2), 1, gains.len());
    if gain < DECISION_SHARE || p_value > options.alpha {
        return None;
    }
    let validation_losses = is.iter().sum();
    let reason = AdditionReason::KnownSize;
    let scored = ScoredCandidate {
        term,
        share: gain,
        validation_losses,
        p_value,
        reason,
        is_without_form_error: false,
        losses: is,
    };
    Some(SelectionStep { added: Some(scored), removed: None, ties: Vec::new(), after })
}
