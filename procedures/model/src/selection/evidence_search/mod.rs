//! Adds effects by one decision rule. An effect is added if it reduces the validation error by a minimum share, is
//! significant, and exceeds its own standard error.
//!
//! The error reduction ranks the candidates; significance is only a condition. A candidate that form error imitates has to
//! explain most of the residual.

mod candidates;
mod detection_limits;
mod insignificant;
mod power_balance;
pub(crate) mod rules;

use crate::preprocess::Prepared;
use crate::regression::candidates::CandidateSets;
use crate::regression::cross_validation::{is_tie, validation_rms};
use crate::regression::evidence::Evidence;
use crate::regression::linear_model::LinearModel;
use crate::regression::solution::Solution;
use crate::regression::two_stage_model::TwoStageModel;
use crate::report::reasons::{AdditionReason, RejectionReason, RemovalReason};
use crate::residual_analysis::maps::Maps;
use crate::residual_analysis::structure::{self, Unexplained};
use crate::selection::evidence_search::candidates::{candidates, in_turn, is_tied};
use crate::selection::evidence_search::insignificant::insignificant;
use crate::selection::evidence_search::power_balance::power_balance;
use crate::selection::evidence_search::rules::error_reduction::least_gain;
use crate::selection::evidence_search::rules::{Figures, Refit};
use crate::selection::forward_step::ScoredCandidate;
use crate::selection::model_selection::ModelSelection;
use crate::selection::path::{Path, SelectionStep};
use crate::selection::refused::{EvidenceResult, Refused};
use crate::thresholds::{LEFT_SHARE, SIMPLER_GAIN};
use crate::{ModelError, ModelSpec, Options};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Data and state of the search.
struct Search<'a, 'p> {
    spec: &'p ModelSpec,
    options: &'a Options,
    path: Path<'p>,
    sets: CandidateSets<'p>,
}

pub fn search<'p>(
    prepared: &'p Prepared,
    spec: &'p ModelSpec,
    options: &Options,
    most: usize,
) -> Result<ModelSelection<'p>, ModelError> {
    let start = TwoStageModel::new(prepared, spec, options)?;
    let sets = CandidateSets::new(prepared, spec);
    let mut search = Search { spec, options, path: Path::new(start), sets };
    // Contradicting columns make every effect spurious: none is tested.
    let mut refused = Vec::new();
    if prepared.data_errors.fatal.is_empty() {
        if most > 0
            && let Some(step) = power_balance(&search.path.start, &search.sets, options)
        {
            search.path.push(step);
        }
        refused = search.grow(most)?;
        search.replace()?;
    }
    while let Some(id) = insignificant(search.path.end(), spec) {
        search.remove(id, RemovalReason::Insignificant)?;
    }
    let left = search.left()?;
    search.finish(left, refused)
}

impl<'p> Search<'_, 'p> {
    /// Evidence for the candidates of a model, with its solution. `None` for a run that is not judged sample by sample.
    fn evidence(&self, now: &TwoStageModel<'p>) -> Option<(Arc<Solution>, Vec<Evidence<'_, 'p>>)> {
        let library = self.sets.of(now.main.problem);
        let forms = library.candidates.iter().filter(|c| !self.spec.contains(c.id())).count();
        let solution = Solution::of(&now.main)?;
        let all = candidates(now, &solution, library, forms);
        Some((solution, all))
    }

    /// Adds the effect with the largest error reduction as long as one passes. Returns the rejected effects with a
    /// large error reduction.
    fn grow(&mut self, most: usize) -> Result<Vec<Refused<'p>>, ModelError> {
        loop {
            let now = self.path.end();
            let Some((solution, all)) = self.evidence(now) else { return Ok(Vec::new()) };
            let added = self.path.steps.iter().filter(|a| a.added.is_some()).count();
            let figures = |e: &Evidence| Figures::of(e, self.options.alpha, added >= most);
            let passing: Vec<&Evidence> = all.iter().filter(|e| rules::rejection(&figures(e)).is_none()).collect();
            let (mut named, mut rejected) = (None, BTreeMap::new());
            for e in in_turn(&passing) {
                let effects = now.effects.iter().cloned().chain([e.id().to_owned()]).collect();
                let after = TwoStageModel::from_candidates(&self.sets, effects)?;
                match rules::model_rejection(&Refit { now, solution: &solution, id: e.id(), after: &after }) {
                    Some(reason) => rejected.insert(e.id(), reason),
                    None => {
                        named = Some((e, after));
                        break;
                    }
                };
            }
            let Some((best, after)) = named else {
                let reason = |e: &Evidence| rules::rejection(&figures(e)).or_else(|| rejected.get(e.id()).copied());
                return Ok(large_refused(&all, reason));
            };
            let id = best.best.id();
            let mut ties = Vec::new();
            for tied in all.iter().filter(|e| e.id() != id && is_tied(best, e)) {
                let rival = tied.best.id();
                let with_rival = now.effects.iter().cloned().chain([rival.to_owned()]).collect();
                if !ties.contains(&rival) && self.fits_alike(&after, with_rival)? {
                    ties.push(rival);
                }
            }
            let scored = scored(best, now, AdditionReason::ErrorReduction);
            self.path.push(SelectionStep { added: Some(scored), removed: None, ties, after });
        }
    }

    /// Whether a model of these effects predicts left-out blocks as well as the given one.
    fn fits_alike(&self, model: &TwoStageModel<'p>, effects: Vec<String>) -> Result<bool, ModelError> {
        let other = TwoStageModel::from_candidates(&self.sets, effects)?;
        let losses = |model: &LinearModel| Solution::of(model).map(|solution| solution.validation_losses(model));
        Ok(match (losses(&model.main), losses(&other.main)) {
            (Some(best), Some(losses)) => is_tie(&best, &losses),
            _ => true,
        })
    }

    /// Replaces several added effects by one that ties with each of them, if the model with that one passes the rules and
    /// its validation error is not larger: of two models the simpler one.
    fn replace(&mut self) -> Result<(), ModelError> {
        let Some((set, rival)) = shared_tie(&self.path) else { return Ok(()) };
        let end = self.path.end();
        let others: Vec<String> = end.effects.iter().filter(|e| !set.contains(&e.as_str())).cloned().collect();
        let base = TwoStageModel::from_candidates(&self.sets, others.clone())?;
        let with = others.into_iter().chain([rival.to_owned()]).collect();
        let after = TwoStageModel::from_candidates(&self.sets, with)?;
        let Some((solution, all)) = self.evidence(&base) else { return Ok(()) };
        let refit = Refit { now: &base, solution: &solution, id: rival, after: &after };
        let passes = |e: &&Evidence| {
            let figures = Figures::of(e, self.options.alpha, false);
            e.id() == rival && rules::rejection(&figures).is_none() && rules::model_rejection(&refit).is_none()
        };
        let Some(found) = all.iter().find(passes) else { return Ok(()) };
        if validation_rms(&after.main) > validation_rms(&end.main) {
            return Ok(());
        }
        let scored = scored(found, &base, AdditionReason::Exchange);
        for id in set {
            self.remove(id, RemovalReason::Swapped)?;
        }
        self.path.push(SelectionStep { added: Some(scored), removed: None, ties: Vec::new(), after });
        Ok(())
    }

    fn remove(&mut self, id: &'p str, why: RemovalReason) -> Result<(), ModelError> {
        let effects = self.path.end().effects.iter().filter(|e| *e != id).cloned().collect();
        let after = TwoStageModel::from_candidates(&self.sets, effects)?;
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

    /// Ties from the time of addition that the final model does not resolve: added effect and rival.
    fn open_ties(&self) -> Result<Vec<(&'p str, &'p str)>, ModelError> {
        let end = self.path.end();
        let is_in = |id: &str| end.effects.iter().any(|e| e == id);
        let named = self.path.steps.iter().filter_map(|a| Some((a.added.as_ref()?.term.id(), &a.ties)));
        let mut open = Vec::new();
        for (id, rival) in named.flat_map(|(id, rivals)| rivals.iter().map(move |rival| (id, *rival))) {
            let in_place = || end.effects.iter().map(|e| if e == id { rival.to_owned() } else { e.clone() }).collect();
            if is_in(id) && !is_in(rival) && self.is_interchangeable(id, in_place())? {
                open.push((id, rival));
            }
        }
        Ok(open)
    }

    /// Whether a model of these `effects`, with a rival in the place of an effect of the last model, is as good as the
    /// last model: it has most of the error reduction, and neither predicts left-out blocks significantly better.
    fn is_interchangeable(&self, id: &str, effects: Vec<String>) -> Result<bool, ModelError> {
        let end = self.path.end();
        let others = end.effects.iter().filter(|effect| *effect != id).cloned().collect();
        let without = TwoStageModel::from_candidates(&self.sets, others)?;
        let instead = TwoStageModel::from_candidates(&self.sets, effects)?;
        let losses = |model: &TwoStageModel| {
            Solution::of(&model.main).map_or_else(Vec::new, |solution| solution.validation_losses(&model.main))
        };
        let [without, named, rival] = [&without, end, &instead].map(losses);
        let gain = |of: &[f64]| without.iter().sum::<f64>() - of.iter().sum::<f64>();
        Ok(gain(&rival) >= SIMPLER_GAIN * gain(&named) && is_tie(&named, &rival) && is_tie(&rival, &named))
    }

    fn finish(self, left: Option<Unexplained>, refused: Vec<Refused<'p>>) -> Result<ModelSelection<'p>, ModelError> {
        let ties = self.open_ties()?;
        let end = self.path.end();
        let now = end.main.clone();
        let detection_limits = Solution::of(&now).map_or_else(Vec::new, |solution| {
            detection_limits::detection_limits(end, &solution, self.sets.of(now.problem), self.options)
        });
        let residual = now.linear().residual;
        let maps = Maps::new(self.sets.prepared, residual.clone(), self.options);
        Ok(ModelSelection {
            start: self.path.start,
            steps: self.path.steps,
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

/// The rejected candidates with a large error reduction, each effect once.
fn large_refused<'p>(
    all: &[Evidence<'_, 'p>],
    reason: impl Fn(&Evidence) -> Option<RejectionReason>,
) -> Vec<Refused<'p>> {
    let mut large: Vec<Refused> = Vec::new();
    for found in all.iter().filter(|e| e.gain > LEFT_SHARE) {
        let effect = found.best.id();
        if let Some(reason) = reason(found)
            && !large.iter().any(|other| other.effect == effect)
        {
            let least = least_gain(found.form_error_imitates);
            let Evidence { gain, p_value, is_without_form_error, .. } = *found;
            large.push(Refused { effect, gain, p_value, least, is_without_form_error, reason });
        }
    }
    large
}

/// The candidate of a search step.
fn scored<'p>(found: &Evidence<'_, 'p>, now: &TwoStageModel<'p>, reason: AdditionReason) -> ScoredCandidate<'p> {
    ScoredCandidate {
        term: found.best.term(now.main.problem),
        share: found.gain,
        validation_losses: found.losses.iter().sum(),
        p_value: found.p_value,
        reason,
        is_without_form_error: found.is_without_form_error,
        losses: found.losses.clone(),
    }
}

/// Several added effects, and the first effect that ties with each of them.
fn shared_tie<'p>(path: &Path<'p>) -> Option<(Vec<&'p str>, &'p str)> {
    let named: Vec<(&'p str, &[&'p str])> =
        path.steps.iter().filter_map(|step| Some((step.added.as_ref()?.term.id(), &step.ties[..]))).collect();
    let is_in = |id: &str| path.end().effects.iter().any(|e| e == id);
    let rivals = named.iter().flat_map(|(_, ties)| ties.iter().copied()).filter(|rival| !is_in(rival));
    let of = |rival: &'p str| {
        let set: Vec<&str> = named.iter().filter(|(_, ties)| ties.contains(&rival)).map(|(id, _)| *id).collect();
        (set.len() > 1).then_some((set, rival))
    };
    rivals.into_iter().find_map(of)
}
