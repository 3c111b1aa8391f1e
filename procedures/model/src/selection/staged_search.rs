//! Selection of effects in stages: steady state first, then ramps, then reversals.

use crate::inference::intervals::intervals;
use crate::preprocess::Prepared;
use crate::regression::candidates::CandidateSet;
use crate::regression::linear_model::LinearModel;
use crate::regression::two_stage_model::TwoStageModel;
use crate::report::diagnosis::Imitated;
use crate::residual_analysis::lack_of_fit;
use crate::residual_analysis::maps::Maps;
use crate::selection::floating_search::{FloatingSearch, Move};
use crate::selection::hysteresis_stage::hysteresis_step;
use crate::selection::model_selection::ModelSelection;
use crate::selection::offset_terms;
use crate::selection::omitted_variable_bias::{Imitated as Found, biased_coefficient};
use crate::selection::path::{Path, SelectionStep};
use crate::selection::pruning::unidentified::{Undetermined, is_identified};
use crate::selection::pruning::{Point, Rejected, Trial};
use crate::selection::ramp_stage::delay;
use crate::selection::removal;
use crate::{ModelError, ModelSpec, Options};

/// Result of the search on the steady-state part.
struct SteadyState<'p> {
    maps: Maps,
    residual: Vec<f64>,
    /// An effect that may be present as well, with the model that includes it.
    open: Option<Found<'p>>,
}

pub fn search<'p>(
    prepared: &'p Prepared,
    spec: &'p ModelSpec,
    options: &Options,
    most: usize,
) -> Result<ModelSelection<'p>, ModelError> {
    let start = TwoStageModel::new(prepared, spec, options)?;
    let library = CandidateSet::new(spec, &prepared.main, prepared.regimes());
    // Contradicting columns make every effect spurious.
    let most = if prepared.data_errors.fatal.is_empty() { most } else { 0 };
    let offset = (most > 0).then(|| offset_terms::step(&start, &library, options)).flatten();
    let mut path = Path::new(start);
    if let Some(offset) = offset {
        path.push(offset);
    }
    let left = most.saturating_sub(path.steps.len());
    let mut search = FloatingSearch::new(path.end().main.clone(), &library, prepared, left, options);
    let SteadyState { maps, residual, open } = steady_state(&mut search, &mut path);
    if let Some(last) = path.steps.last_mut() {
        last.after = last.after.clone().canonical(options)?;
    }
    let moves = |id: &str, was: &LinearModel<'p>, is: &LinearModel<'p>| imitated(id, was, is, spec, prepared);
    let open = open.and_then(|open| moves(open.scored.term.id(), &search.now, &open.with));
    let retained = search.retained_for_bias.iter().filter(|id| search.now.contains(id));
    let retained = retained.filter_map(|id| moves(id, &search.now.without(id), &search.now)).collect();
    let withdrawn = removal::all(&search);
    let ties = open_ties(&search, &path.steps);
    if !search.unmodelled_structure {
        ramps(&mut path, most, options)?;
        hysteresis(&mut path, most, prepared, options)?;
    }
    let detection_limits = search.detection_limits();
    let Path { start, steps, .. } = path;
    let now = search.now;
    Ok(ModelSelection {
        start,
        steps,
        withdrawn,
        now,
        residual,
        maps,
        detection_limits,
        ties,
        retained,
        open,
        decided: None,
    })
}

/// First stage: effects that show in steady-state motion, or in the whole of a trajectory. Each move adds or removes one
/// effect.
fn steady_state<'p>(search: &mut FloatingSearch<'_, 'p>, path: &mut Path<'p>) -> SteadyState<'p> {
    let mut effects = path.end().effects.clone();
    loop {
        let made = match next_move(search) {
            Some(made) => made,
            None => {
                let trial = Trial::new(search);
                if let Some((rejected, why)) = trial.rejected(Point::Structure) {
                    search.unmodelled_structure = true;
                    search.withdraw(rejected.id, why)
                } else {
                    let nothing_shows = trial.axis().is_none();
                    let is_all =
                        |with: &LinearModel| nothing_shows || lack_of_fit::structured(&search.maps_of(with)).is_none();
                    match search.imitated(|with, term| is_identified(with, term, search.prepared)) {
                        Some(found) if found.is_clear && is_all(&found.with) => search.retain(found.scored),
                        open => {
                            let residual = search.now.tangent().rest(&search.now.response());
                            let open = open.filter(|_| nothing_shows);
                            return SteadyState { maps: trial.into_maps(), residual, open };
                        }
                    }
                }
            }
        };
        let (added, removed, ties) = match made {
            Move::Added { scored, ties } => {
                effects.push(scored.term.id().into());
                (Some(*scored), None, ties)
            }
            Move::Removed { id, why } => {
                effects.retain(|e| e != id);
                (None, Some((id, why)), Vec::new())
            }
        };
        let after = path.start.of(search.now.clone(), effects.clone());
        path.push(SelectionStep { added, removed, ties, after });
    }
}

/// Adds the best candidate that passes. Before and after, the pruning rules may remove an effect. With structure from
/// outside the library nothing is added: it would only imitate that structure.
fn next_move<'p>(search: &mut FloatingSearch<'_, 'p>) -> Option<Move<'p>> {
    if let Some(made) = pruned(search, Point::EachMove) {
        return Some(made);
    }
    if !search.unmodelled_structure {
        if let Some((scored, ties)) = search.candidate() {
            return Some(search.add(scored, ties));
        }
        if let Some(made) = pruned(search, Point::NoCandidate) {
            return Some(made);
        }
        if search.take_exchange()
            && let Some(made) = pruned(search, Point::Exchange)
        {
            return Some(made);
        }
    }
    pruned(search, Point::End)
}

/// Removes the effect that a rule rejects at this point of the search.
fn pruned<'p>(search: &mut FloatingSearch<'_, 'p>, point: Point) -> Option<Move<'p>> {
    let (Rejected { id, replacement }, why) = Trial::new(search).rejected(point)?;
    Some(match point {
        Point::EachMove => search.drop(id, why),
        Point::NoCandidate => search.exclude(id, why),
        Point::Exchange => search.exchange(id, replacement, why),
        Point::End | Point::Structure => search.withdraw(id, why),
    })
}

/// Whether fewer than `most` effects were added.
fn may_grow(path: &Path, most: usize) -> bool {
    path.end().effects.len() < path.start.effects.len() + most
}

/// Second stage: a torque delay, on the ramps of a run in steps.
fn ramps<'p>(path: &mut Path<'p>, most: usize, options: &Options) -> Result<(), ModelError> {
    if may_grow(path, most)
        && let Some((scored, after)) = delay(path.end(), options)
    {
        let after = after.canonical(options)?;
        path.push(SelectionStep { added: Some(scored), removed: None, ties: Vec::new(), after });
    }
    Ok(())
}

/// Third stage: hysteresis effects, around the reversals of a run in steps.
fn hysteresis<'p>(
    path: &mut Path<'p>,
    most: usize,
    prepared: &'p Prepared,
    options: &Options,
) -> Result<(), ModelError> {
    let now = path.end();
    if may_grow(path, most)
        && let Some(scored) = hysteresis_step(now, options)
        && let effects = now.effects.iter().map(String::as_str).chain([scored.term.id()]).map(String::from).collect()
        && let after = now.of(now.main.clone(), effects).canonical(options)?
        && let Some(moving) = &after.moving
        && !Undetermined::of(&scored.term, moving, &intervals(moving, prepared.motion).parameters, prepared).any()
    {
        path.push(SelectionStep { added: Some(scored), removed: None, ties: Vec::new(), after });
    }
    Ok(())
}

/// Confounded pairs of the final model: ties from the time of addition that still hold, and new ones.
fn open_ties<'p>(search: &FloatingSearch<'_, 'p>, steps: &[SelectionStep<'p>]) -> Vec<(&'p str, &'p str)> {
    let mut open = Vec::new();
    for step in steps {
        let Some(effect) = step.added.as_ref().map(|scored| scored.term.id()) else { continue };
        let is_new = |scored: &&&'p str| !search.now.contains(scored) && !open.contains(&(effect, **scored));
        if search.now.contains(effect) {
            let confounded: Vec<&'p str> = step.ties.iter().filter(is_new).copied().collect();
            open.extend(
                confounded.into_iter().filter(|scored| search.ties(effect, scored)).map(|scored| (effect, scored)),
            );
        }
    }
    for term in search.added() {
        let stand_ins = search.stand_ins(term).into_iter().map(|scored| (term.id(), scored));
        let new: Vec<_> = stand_ins.filter(|tie| !open.contains(tie)).collect();
        open.extend(new);
    }
    open
}

/// The effect that another one imitates, with the biased coefficient of the given model.
fn imitated(
    id: &str,
    without: &LinearModel,
    with: &LinearModel,
    spec: &ModelSpec,
    prepared: &Prepared,
) -> Option<Imitated> {
    let found = biased_coefficient(without, with, &spec.effects)?;
    let info = found.term.effect.info();
    Some(Imitated {
        effect: id.into(),
        parameter: format!("{}.{}", info.id, found.coefficient),
        unit: prepared.motion.label(info.unit(found.coefficient)),
        without: found.was,
        with: found.is,
    })
}
