//! Adds effects by one decision rule. An effect is added if it reduces the validation error by a minimum share, is
//! significant, and exceeds its own standard error.
//!
//! The error reduction ranks the candidates; significance is only a condition. A candidate that form error imitates has to
//! explain most of the residual.

use crate::effect::Regime;
use crate::effects::friction::inertia;
use crate::linear::blocked_ridge::BlockedRidge;
use crate::preprocess::Prepared;
use crate::preprocess::form_error::FormErrorKind;
use crate::regression::candidates::{CandidateSet, Regressor};
use crate::regression::evidence::{Evidence, chance, errors, evidence};
use crate::regression::linear_model::{LinearModel, Term};
use crate::regression::solution::{DELAY, PRESLIDING, Solution, effect_coefficient, effect_columns, nuisance, without};
use crate::regression::two_stage_model::TwoStageModel;
use crate::report::reasons::{AdditionReason, RemovalReason};
use crate::residual_analysis::maps::Maps;
use crate::residual_analysis::structure::{self, Unexplained};
use crate::selection::advance::{Path, SelectionStep};
use crate::selection::block_limits;
use crate::selection::equivalence::is_tie;
use crate::selection::forward_step::ScoredCandidate;
use crate::selection::model_selection::ModelSelection;
use crate::selection::refused::{EvidenceResult, Refused};
use crate::thresholds::{DECISION_SHARE, DELAY_ROWS, FLOOR_RATIO, LEFT_SHARE, MOST_NAMED, SIMPLER_GAIN};
use crate::{Effect, ModelError, ModelSpec, Options};
use std::cell::OnceCell;

/// Candidate sets of a run: for a friction direction that switches at once, and for one with presliding.
struct Libraries<'p> {
    plain: OnceCell<CandidateSet<'p>>,
    bristled: OnceCell<CandidateSet<'p>>,
}

impl<'p> Libraries<'p> {
    /// The candidate set that matches the friction direction of a model.
    fn of(&self, model: &LinearModel<'p>, prepared: &'p Prepared, spec: &'p ModelSpec) -> &CandidateSet<'p> {
        let is_plain = std::ptr::eq(model.problem, &prepared.main);
        let known = if is_plain { &self.plain } else { &self.bristled };
        known.get_or_init(|| CandidateSet::new(spec, model.problem, prepared.regimes()))
    }
}

/// Data and state of the search.
struct Search<'a, 'p> {
    prepared: &'p Prepared,
    spec: &'p ModelSpec,
    options: &'a Options,
    path: Path<'a, 'p>,
    libraries: Libraries<'p>,
}

/// `on_advance` gets each step when it is made.
pub fn search<'p>(
    prepared: &'p Prepared,
    spec: &'p ModelSpec,
    options: &Options,
    most: usize,
    on_advance: &mut dyn FnMut(&SelectionStep),
) -> Result<ModelSelection<'p>, ModelError> {
    let start = TwoStageModel::new(prepared, spec, options)?;
    let libraries = Libraries { plain: OnceCell::new(), bristled: OnceCell::new() };
    let mut search = Search { prepared, spec, options, path: Path::new(start, on_advance), libraries };
    // Contradicting columns make every effect spurious: none is tested.
    let mut refused = Vec::new();
    if prepared.data_errors.fatal.is_empty() {
        if most > 0
            && let Some(step) = offset(&search.path.start, options)
        {
            search.path.push(step);
        }
        refused = search.grow(most.min(MOST_NAMED as usize))?;
    }
    while let Some(id) = insignificant(search.path.end(), spec) {
        search.remove(id, RemovalReason::Insignificant)?;
    }
    let left = search.left()?;
    search.finish(left, refused)
}

impl<'p> Search<'_, 'p> {
    /// Adds the effect with the largest error reduction as long as one passes. Returns the rejected effects with a
    /// large error reduction.
    fn grow(&mut self, most: usize) -> Result<Vec<Refused<'p>>, ModelError> {
        loop {
            let now = self.path.end();
            let library = self.libraries.of(&now.main, self.prepared, self.spec);
            let Some(solution) = Solution::of(&now.main) else { return Ok(Vec::new()) };
            let forms = library.candidates.iter().filter(|c| !self.spec.contains(c.id())).count();
            let all = candidates(now, &solution, library, forms);
            let passes = |e: &&Evidence| e.passes(self.options.alpha);
            let added = self.path.advances.iter().filter(|a| a.added.is_some()).count();
            let mut named = None;
            let passing: Vec<&Evidence> = all.iter().filter(passes).filter(|_| added < most).collect();
            for e in in_turn(&passing) {
                let effects = now.effects.iter().cloned().chain([e.id().to_owned()]).collect();
                let after = TwoStageModel::decided(self.prepared, self.spec, effects)?;
                if follows(now, &solution, &after) {
                    named = Some((e, after));
                    break;
                }
            }
            let Some((best, after)) = named else {
                let large = all.iter().filter(|e| e.gain > LEFT_SHARE);
                return Ok(large.map(|e| Refused::of(e, self.options.alpha, added >= most)).collect());
            };
            let id = best.best.id();
            let mut ties = Vec::new();
            for tied in all.iter().filter(|e| e.id() != id && is_tied(best, e)) {
                if self.fits_alike(tied.best.id(), &after)? && !ties.contains(&tied.best.id()) {
                    ties.push(tied.best.id());
                }
            }
            let scored = ScoredCandidate {
                term: best.best.term(now.main.problem),
                share: best.gain,
                validation_losses: best.losses.iter().sum(),
                p_value: best.p_value,
                reason: AdditionReason::ErrorReduction,
                losses: best.losses.clone(),
            };
            self.path.push(SelectionStep { added: Some(scored), removed: None, ties, after });
        }
    }

    /// Whether it predicts left-out blocks as well in the place of the added effect.
    fn fits_alike(&self, rival: &str, after: &TwoStageModel<'p>) -> Result<bool, ModelError> {
        let effects = self.path.end().effects.iter().cloned().chain([rival.to_owned()]).collect();
        let other = TwoStageModel::decided(self.prepared, self.spec, effects)?;
        let losses = |model: &LinearModel| Solution::of(model).map(|solution| solution.validation_losses(model));
        Ok(match (losses(&after.main), losses(&other.main)) {
            (Some(best), Some(losses)) => is_tie(&best, &losses),
            _ => true,
        })
    }

    fn remove(&mut self, id: &'p str, why: RemovalReason) -> Result<(), ModelError> {
        let effects = self.path.end().effects.iter().filter(|e| *e != id).cloned().collect();
        let after = TwoStageModel::decided(self.prepared, self.spec, effects)?;
        self.path.push(SelectionStep { added: None, removed: Some((id, why)), ties: Vec::new(), after });
        Ok(())
    }

    /// Unexplained structure. If a function of one axis explains more than all added effects together, these effects
    /// are removed.
    fn left(&mut self) -> Result<Option<Unexplained>, ModelError> {
        let of = |Self { path, .. }: &Self| {
            Solution::of(&path.end().main).and_then(|solution| structure::left(&path.start, path.end(), &solution))
        };
        let left = of(self);
        if !left.as_ref().is_some_and(|left| left.is_all) {
            return Ok(left);
        }
        let spec = self.spec;
        for id in self.path.end().effects.clone().iter().filter(|e| !spec.contains(e)) {
            self.remove(spec.find(id)?.info().id, RemovalReason::Spurious)?;
        }
        Ok(of(self).or(left))
    }

    fn finish(self, left: Option<Unexplained>, refused: Vec<Refused<'p>>) -> Result<ModelSelection<'p>, ModelError> {
        let end = self.path.end();
        let now = end.main.clone();
        let detection_limits = Solution::of(&now).map_or_else(Vec::new, |solution| {
            block_limits::detection_limits(
                end,
                &solution,
                self.libraries.of(&now, self.prepared, self.spec),
                self.options,
            )
        });
        let residual = now.linear().residual;
        let is_in = |id: &str| end.effects.iter().any(|e| e == id);
        let named = self.path.advances.iter().filter_map(|a| Some((a.added.as_ref()?.term.id(), &a.ties)));
        let ties = named.flat_map(|(id, ids)| ids.iter().map(move |scored| (id, *scored)));
        let ties = ties.filter(|(id, scored)| is_in(id) && !is_in(scored)).collect();
        let maps = Maps::new(self.prepared, residual.clone(), self.options);
        Ok(ModelSelection {
            start: self.path.start,
            advances: self.path.advances,
            withdrawn: Vec::new(),
            now,
            residual,
            maps,
            detection_limits,
            ties,
            retained: Vec::new(),
            open: None,
            decided: Some(EvidenceResult { left, refused }),
        })
    }
}

/// Evidence for every effect that is not in the model, sorted by decreasing error reduction.
fn candidates<'l, 'p>(
    now: &TwoStageModel<'p>,
    solution: &Solution,
    library: &'l CandidateSet<'p>,
    forms: usize,
) -> Vec<Evidence<'l, 'p>> {
    let is_out = |id: &str| !now.effects.iter().any(|e| e == id);
    let is_sought = |id: &str| is_out(id) && library.candidates.iter().any(|c| c.id() == id);
    let of = |wanted: &dyn Fn(&Regressor) -> bool| -> Vec<&'l Regressor<'p>> {
        let is_wanted = |c: &&Regressor<'p>| is_out(c.id()) && wanted(c) && !c.effect.corrects().is_some_and(is_sought);
        library.candidates.iter().filter(is_wanted).collect()
    };
    let near: Vec<bool> = match now.main.problem.form_error.as_deref() {
        Some(form_error) => form_error.turn_s.iter().map(|turn_s| *turn_s < form_error.near_s).collect(),
        None => Vec::new(),
    };
    let keeps_form_error = |c: &Regressor| match c.effect.regime() {
        Regime::SteadyState => true,
        Regime::Transient => c.id() != DELAY,
        Regime::Hysteresis => false,
    };
    let (mut all, hidden) = evidence(&solution.ridge, &of(&keeps_form_error), &near, forms);
    // Other candidates are judged without the form error that represents the same effect, and explain that error too.
    let mut judge_without = |kind: FormErrorKind, of: &[&'l Regressor<'p>]| {
        if !of.is_empty() {
            let (found, _) = evidence(&without(&now.main, solution, kind), of, &near, forms);
            all.extend(found.into_iter().map(|found| Evidence { form_error_imitates: true, ..found }));
        }
    };
    if is_delayed(now, solution) {
        judge_without(FormErrorKind::Jerk, &of(&|c| c.id() == DELAY));
    }
    judge_without(FormErrorKind::Bristle, &of(&|c| c.effect.regime() == Regime::Hysteresis));
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

/// A candidate that changes the direction of all friction terms has to explain as much as free form-error columns in
/// its place. A delayed torque also bends around reversals, but friction directions do not follow it.
fn follows(now: &TwoStageModel, solution: &Solution, after: &TwoStageModel) -> bool {
    let Some(form_error) = after.main.problem.form_error.as_deref() else { return true };
    std::ptr::eq(now.main.problem, after.main.problem)
        || Solution::weighted(&after.main, form_error, solution.weight.clone(), None).ridge.loss()
            < FLOOR_RATIO.powi(2) * solution.ridge.loss()
}

/// Candidates by decreasing error reduction; those that tie with the first one by increasing p-value. A formula of a
/// user comes after the effects of the library that tie with it.
fn in_turn<'e, 'l, 'p>(passing: &[&'e Evidence<'l, 'p>]) -> Vec<&'e Evidence<'l, 'p>> {
    let mut in_turn = passing.to_vec();
    if let Some(first) = passing.first() {
        let ties = passing.iter().take_while(|e| is_tied(first, e)).count();
        in_turn[..ties].sort_by(|a, b| a.p_value.total_cmp(&b.p_value));
        let is_own = |e: &Evidence| e.best.effect.is_user_defined();
        if in_turn[..ties].iter().any(|e| is_own(e)) {
            in_turn.sort_by_key(|e| is_own(e) || !is_tied(first, e));
        }
    }
    in_turn
}

/// Whether two candidates reduce the error about equally, compared over the blocks.
fn is_tied(best: &Evidence, other: &Evidence) -> bool {
    other.gain > SIMPLER_GAIN * best.gain && is_tie(&best.losses, &other.losses)
}

/// Whether torque and motion are shifted by more than a sample. Below that, the moment of a reading within its sample
/// is unknown.
fn is_delayed(now: &TwoStageModel, solution: &Solution) -> bool {
    let model = &now.main;
    let Some(form_error) = model.problem.form_error.as_deref() else { return false };
    let inertia = effect_coefficient(model, solution, inertia::ID);
    let jerk =
        solution.error.iter().find(|(at, _)| form_error.columns[*at].kind == FormErrorKind::Jerk).map(|(_, f)| *f);
    let (Some(inertia), Some(jerk)) = (inertia, jerk) else { return false };
    (jerk / inertia).abs() > DELAY_ROWS * form_error.sample_s
}

/// The added effect without which the validation error does not increase, if other effects were added too.
fn insignificant<'p>(end: &TwoStageModel<'p>, spec: &'p ModelSpec) -> Option<&'p str> {
    let added: Vec<&'p str> =
        end.effects.iter().filter(|e| !spec.contains(e)).filter_map(|e| Some(spec.find(e).ok()?.info().id)).collect();
    let form_error = end.main.problem.form_error.as_deref()?;
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
        (id, loss(&less, id == DELAY) / whole - 1.0)
    };
    let judged = added.into_iter().filter(|id| *id != PRESLIDING && plain.contains(id)).map(without);
    judged.filter(|(_, loss)| *loss < DECISION_SHARE).min_by(|a, b| a.1.total_cmp(&b.1)).map(|(id, _)| id)
}

/// The power balance, if the model lacks it and the data supports it.
fn offset<'p>(start: &TwoStageModel<'p>, options: &Options) -> Option<SelectionStep<'p>> {
    let problem = start.main.problem;
    let is_out = |id: &str| !start.effects.iter().any(|e| e == id);
    let missing = |e: &&dyn Effect| e.is_offset() && is_out(e.info().id) && e.hidden(&problem.view).is_none();
    let effect = start.spec.known().find(missing)?;
    let form = effect.forms(&problem.view).into_iter().next()?;
    let term = Term::new(effect, form, Vec::new(), problem);
    let effects: Vec<String> = start.effects.iter().cloned().chain([effect.info().id.to_owned()]).collect();
    let after = TwoStageModel::decided(start.prepared, start.spec, effects).ok()?;
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
    let scored = ScoredCandidate { term, share: gain, validation_losses, p_value, reason, losses: is };
    Some(SelectionStep { added: Some(scored), removed: None, ties: Vec::new(), after })
}
