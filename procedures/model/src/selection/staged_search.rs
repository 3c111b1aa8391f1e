//! Selection of effects in stages: steady state first, then ramps, then reversals.

use crate::inference::intervals::intervals;
use crate::preprocess::Prepared;
use crate::regression::candidates::CandidateSet;
use crate::regression::linear_model::{LinearModel, Term};
use crate::regression::two_stage_model::TwoStageModel;
use crate::report::diagnosis::Imitated;
use crate::report::diagnosis::RemovalReason;
use crate::residual_analysis::maps::Maps;
use crate::residual_analysis::{lack_of_fit, undersampled_harmonics};
use crate::selection::advance::{Path, SelectionStep};
use crate::selection::floating_search::{FloatingSearch, Move};
use crate::selection::hysteresis_stage::hysteresis_step;
use crate::selection::model_selection::ModelSelection;
use crate::selection::offset_terms;
use crate::selection::omitted_variable_bias::{Imitated as Found, moved};
use crate::selection::pruning::partial_explanation::{bump, partially_explained};
use crate::selection::pruning::spurious::spurious;
use crate::selection::pruning::unidentified::{Undetermined, is_identified, unidentified};
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

/// `on_advance` gets each step when it is made.
pub fn search<'p>(
    prepared: &'p Prepared,
    spec: &'p ModelSpec,
    options: &Options,
    most: usize,
    on_advance: &mut dyn FnMut(&SelectionStep),
) -> Result<ModelSelection<'p>, ModelError> {
    let start = TwoStageModel::new(prepared, spec, options)?;
    let library = CandidateSet::new(spec, &prepared.main, prepared.regimes());
    // Contradicting columns make every effect spurious.
    let most = if prepared.data_errors.fatal.is_empty() { most } else { 0 };
    let offset = (most > 0).then(|| offset_terms::advance(&start, &library, options)).flatten();
    let mut path = Path::new(start, on_advance);
    if let Some(offset) = offset {
        path.push(offset);
    }
    let left = most.saturating_sub(path.advances.len());
    let mut search = FloatingSearch::new(path.end().main.clone(), &library, &prepared.baseline, left, options);
    let SteadyState { maps, residual, open } = steady_state(&mut search, &mut path, prepared, options);
    if let Some(last) = path.advances.last_mut() {
        last.after = last.after.clone().canonical(options)?;
    }
    let moves = |id: &str, was: &LinearModel<'p>, is: &LinearModel<'p>| imitated(id, was, is, spec, prepared);
    let open = open.and_then(|open| moves(open.scored.term.id(), &search.now, &open.with));
    let retained = search.retained_for_bias.iter().filter(|id| search.now.contains(id));
    let retained = retained.filter_map(|id| moves(id, &search.now.without(id), &search.now)).collect();
    let withdrawn = removal::all(&search);
    let ties = open_ties(&search, &path.advances);
    if !search.unmodelled_structure {
        ramps(&mut path, most, options)?;
        hysteresis(&mut path, most, prepared, options)?;
    }
    let detection_limits = search.detection_limits();
    let Path { start, advances, .. } = path;
    let now = search.now;
    Ok(ModelSelection {
        start,
        advances,
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

/// First stage: effects that show in steady-state motion, or in the whole of a trajectory.
fn steady_state<'p>(
    search: &mut FloatingSearch<'_, 'p>,
    path: &mut Path<'_, 'p>,
    prepared: &'p Prepared,
    options: &Options,
) -> SteadyState<'p> {
    let mut effects = path.end().effects.clone();
    loop {
        let made = search.next().or_else(|| {
            let unidentified = || Some((unidentified(search, prepared)?, RemovalReason::Unidentified));
            let (id, why) =
                search.follows_random_walk().map(|id| (id, RemovalReason::RandomWalk)).or_else(unidentified)?;
            Some(search.withdraw(id, why))
        });
        let made = match made {
            Some(made) => made,
            None => {
                let residual = search.now.tangent().rest(&search.now.response());
                let maps = maps_of(&search.now, residual.clone(), prepared, options);
                let axis = lack_of_fit::structured(&maps);
                if let Some((id, why)) = outside_the_library(search, &maps, axis, prepared, options) {
                    search.unmodelled_structure = true;
                    search.withdraw(id, why)
                } else {
                    let is_identified = |with: &LinearModel<'p>, term: &Term<'p>| is_identified(with, term, prepared);
                    let nothing_shows = axis.is_none();
                    let is_all = |with: &LinearModel| nothing_shows || leaves_nothing(with, prepared, options);
                    match search.imitated(is_identified) {
                        Some(found) if found.is_clear && is_all(&found.with) => search.retain(found.scored),
                        open => {
                            let open = open.filter(|_| nothing_shows);
                            return SteadyState { maps, residual, open };
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

/// An added effect that only imitates structure from outside the library.
fn outside_the_library<'p>(
    search: &FloatingSearch<'_, 'p>,
    maps: &Maps,
    axis: Option<&str>,
    prepared: &Prepared,
    options: &Options,
) -> Option<(&'p str, RemovalReason)> {
    let whole = axis.and_then(|axis| rejected_by_structure(search, maps, axis, prepared, options));
    let bump = || Some((bump(search, prepared, options)?, RemovalReason::PartialExplanation));
    whole.or_else(bump)
}

/// Whether fewer than `most` effects were added.
fn may_grow(path: &Path, most: usize) -> bool {
    path.end().effects.len() < path.start.effects.len() + most
}

/// Second stage: a torque delay, on the ramps of a run in steps.
fn ramps<'p>(path: &mut Path<'_, 'p>, most: usize, options: &Options) -> Result<(), ModelError> {
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
    path: &mut Path<'_, 'p>,
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

/// An added effect to remove because structure remains over an axis.
fn rejected_by_structure<'p>(
    search: &FloatingSearch<'_, 'p>,
    maps: &Maps,
    axis: &str,
    prepared: &Prepared,
    options: &Options,
) -> Option<(&'p str, RemovalReason)> {
    let half = partially_explained(search, axis, prepared, options).map(|id| (id, RemovalReason::PartialExplanation));
    half.or_else(|| Some((spurious(search, maps, axis, options)?, RemovalReason::Spurious)))
}

/// Confounded pairs of the final model: ties from the time of addition that still hold, and new ones.
fn open_ties<'p>(search: &FloatingSearch<'_, 'p>, advances: &[SelectionStep<'p>]) -> Vec<(&'p str, &'p str)> {
    let mut open = Vec::new();
    for advance in advances {
        let Some(effect) = advance.added.as_ref().map(|scored| scored.term.id()) else { continue };
        let is_new = |scored: &&&'p str| !search.now.contains(scored) && !open.contains(&(effect, **scored));
        if search.now.contains(effect) {
            let confounded: Vec<&'p str> = advance.ties.iter().filter(is_new).copied().collect();
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

/// Residual maps of a model.
fn maps_of(terms: &LinearModel, residual: Vec<f64>, prepared: &Prepared, options: &Options) -> Maps {
    Maps::new(prepared, undersampled_harmonics::without_undersampled_harmonics(terms, residual), options)
}

/// Whether no structure remains over any axis.
fn leaves_nothing(terms: &LinearModel, prepared: &Prepared, options: &Options) -> bool {
    let residual = terms.tangent().rest(&terms.response());
    lack_of_fit::structured(&maps_of(terms, residual, prepared, options)).is_none()
}

/// The effect that another one imitates, with the biased coefficient of the given model.
fn imitated(
    id: &str,
    without: &LinearModel,
    with: &LinearModel,
    spec: &ModelSpec,
    prepared: &Prepared,
) -> Option<Imitated> {
    let found = moved(without, with, &spec.effects)?;
    let info = found.term.effect.info();
    Some(Imitated {
        effect: id.into(),
        parameter: format!("{}.{}", info.id, found.coefficient),
        unit: prepared.motion.label(info.unit(found.coefficient)),
        without: found.was,
        with: found.is,
    })
}
