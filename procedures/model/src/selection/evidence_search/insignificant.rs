//! Removes an added effect without which the other effects predict equally well.

use crate::ModelSpec;
use crate::linear::blocked_ridge::BlockedRidge;
use crate::preprocess::form_error::FormErrorKind;
use crate::regression::linear_model::LinearModel;
use crate::regression::solution::{Solution, effect_columns, nuisance};
use crate::regression::two_stage_model::TwoStageModel;
use crate::selection::evidence_search::rules::nonzero_size::has_size;
use crate::thresholds::DECISION_SHARE;

/// An added effect without a size, or the one without which the validation error does not increase, if other effects were
/// added too.
pub fn insignificant<'p>(end: &TwoStageModel<'p>, spec: &'p ModelSpec) -> Option<&'p str> {
    let added: Vec<&'p str> =
        end.effects.iter().filter(|e| !spec.contains(e)).filter_map(|e| Some(spec.find(e).ok()?.info().id)).collect();
    let form_error = end.main.problem.form_error.as_deref()?;
    if let Some(id) = added.iter().find(|id| !has_size(id, &end.main)) {
        return Some(id);
    }
    if added.len() < 2 {
        return None;
    }
    // Other forms of the remaining effects would imitate the effect under test.
    let mut plain = end.main.clone();
    plain.relatives = Default::default();
    let weight = Solution::of(&plain)?.weight.clone();
    let loss = |model: &LinearModel, is_delayed: bool| {
        if !is_delayed {
            return Solution::weighted(model, form_error, weight.clone(), None).ridge.loss();
        }
        let mut columns = effect_columns(model);
        let nuisance = nuisance(model, form_error, |kind| kind == FormErrorKind::Jerk);
        columns.extend(nuisance.columns());
        BlockedRidge::new(&columns, &model.response(), &weight, &model.problem.block, None).loss()
    };
    let whole = loss(&plain, false);
    let without = |id: &'p str| {
        let mut less = plain.clone();
        less.terms.retain(|term| term.id() != id);
        (id, loss(&less, plain.has_delay() && !less.has_delay()) / whole - 1.0)
    };
    let judged = added.into_iter().filter(|id| plain.contains(id)).map(without);
    judged.filter(|(_, loss)| *loss < DECISION_SHARE).min_by(|a, b| a.1.total_cmp(&b.1)).map(|(id, _)| id)
}
