//! Candidates of one step of the evidence search, and the order in which they are tried.

use crate::effect::{Regime, Traits};
use crate::preprocess::form_error::FormErrorKind;
use crate::regression::candidates::{CandidateSet, Regressor};
use crate::regression::cross_validation::is_tie;
use crate::regression::evidence::{Evidence, evidence};
use crate::regression::solution::{Solution, effect_coefficient, without};
use crate::regression::two_stage_model::TwoStageModel;
use crate::thresholds::{DELAY_ROWS, SIMPLER_GAIN};

/// Evidence for every effect that is not in the model, sorted by decreasing error reduction.
pub fn candidates<'l, 'p>(
    now: &TwoStageModel<'p>,
    solution: &Solution,
    library: &'l CandidateSet<'p>,
    forms: usize,
) -> Vec<Evidence<'l, 'p>> {
    let is_out = |id: &str| !now.effects.iter().any(|e| e == id);
    let is_sought = |id: &str| is_out(id) && library.candidates.iter().any(|c| c.id() == id);
    let of = |wanted: &dyn Fn(&Regressor) -> bool| -> Vec<&'l Regressor<'p>> {
        let is_wanted =
            |c: &&Regressor<'p>| is_out(c.id()) && wanted(c) && !c.effect.traits().corrects.is_some_and(is_sought);
        library.candidates.iter().filter(is_wanted).collect()
    };
    let near: Vec<bool> = match now.main.problem.form_error.as_deref() {
        Some(form_error) => form_error.turn_s.iter().map(|turn_s| *turn_s < form_error.near_s).collect(),
        None => Vec::new(),
    };
    let keeps_form_error = |c: &Regressor| match c.effect.traits().regime {
        Regime::SteadyState => true,
        Regime::Transient => c.effect.traits().delay_of.is_none(),
        Regime::Hysteresis => false,
    };
    let (mut all, hidden) = evidence(&solution.ridge, &of(&keeps_form_error), &near, forms);
    // Other candidates are judged without the form error that represents the same effect, and explain that error too.
    let mut judge_without = |kind: FormErrorKind, of: &[&'l Regressor<'p>]| {
        if !of.is_empty() {
            let (found, _) = evidence(&without(&now.main, solution, kind), of, &near, forms);
            let imitated = |found| Evidence { form_error_imitates: true, is_without_form_error: true, ..found };
            all.extend(found.into_iter().map(imitated));
        }
    };
    let delays = of(&|c| c.effect.traits().delay_of.is_some_and(|delayed| is_delayed(delayed, now, solution)));
    judge_without(FormErrorKind::Jerk, &delays);
    // In motion at nearly one frequency, operators of a large displacement represent the acceleration.
    let is_imitated = |traits: Traits| traits.regime != Regime::SteadyState && traits.delay_of.is_none();
    judge_without(FormErrorKind::Bristle, &of(&|c| is_imitated(c.effect.traits())));
    // On one sine the snap is the acceleration with the opposite sign, and the jerk is the velocity.
    for kind in unpenalised_form_error(now, solution) {
        judge_without(kind, &hidden);
    }
    all.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    all
}

/// Form-error columns of a model that the ridge penalty does not shrink.
fn unpenalised_form_error(now: &TwoStageModel, solution: &Solution) -> impl Iterator<Item = FormErrorKind> {
    let columns = now.main.problem.form_error.as_deref().map_or(&[][..], |form_error| &form_error.columns);
    solution.error.iter().filter_map(|(at, _)| Some(columns.get(*at)?.kind)).filter(|kind| !kind.is_penalised())
}

/// Whether torque and motion are shifted by more than a sample, by the jerk divided by the `delayed` effect. Below that,
/// the moment of a reading within its sample is unknown.
fn is_delayed(delayed: &str, now: &TwoStageModel, solution: &Solution) -> bool {
    let model = &now.main;
    let Some(form_error) = model.problem.form_error.as_deref() else { return false };
    let delayed = effect_coefficient(model, solution, delayed);
    let jerk =
        solution.error.iter().find(|(at, _)| form_error.columns[*at].kind == FormErrorKind::Jerk).map(|(_, f)| *f);
    let (Some(delayed), Some(jerk)) = (delayed, jerk) else { return false };
    (jerk / delayed).abs() > DELAY_ROWS * form_error.sample_s
}

/// Candidates by decreasing error reduction; those that tie with the first one by increasing p-value. A formula of a
/// user comes after the effects of the library that tie with it.
pub fn in_turn<'e, 'l, 'p>(passing: &[&'e Evidence<'l, 'p>]) -> Vec<&'e Evidence<'l, 'p>> {
    let mut in_turn = passing.to_vec();
    if let Some(first) = passing.first() {
        let ties = passing.iter().take_while(|e| is_tied(first, e)).count();
        in_turn[..ties].sort_by(|a, b| a.p_value.total_cmp(&b.p_value));
        let is_own = |e: &Evidence| e.best.effect.traits().is_user_defined;
        if in_turn[..ties].iter().any(|e| is_own(e)) {
            in_turn.sort_by_key(|e| is_own(e) || !is_tied(first, e));
        }
    }
    in_turn
}

/// Whether two candidates reduce the error about equally, compared over the blocks.
pub fn is_tied(best: &Evidence, other: &Evidence) -> bool {
    other.gain > SIMPLER_GAIN * best.gain && is_tie(&best.losses, &other.losses)
}
