//! Effects that the measured run could not show, but another run would.

use crate::effect::{Effect, Regime, ShapeSearch};
use crate::experiment_design::separation::{Noise, Side};
use crate::experiment_design::{Choice, SEPARATED_Z, ScoredRun};
use crate::linear::basis::dot;
use crate::preprocess::Problem;
use crate::regression::linear_model::columns;
use crate::regression::two_stage_model::TwoStageModel;
use crate::report::diagnosis::Experiment;
use crate::thresholds::WORTH_SEEING;
use crate::words::list;
use jointbench_instrument::Kind;

/// Below this an effect is not found reliably: z₀.₉₇₅ + z₀.₈.
const FOUND_Z: f64 = 2.8;

/// The run that makes most undetectable effects detectable, among equals the shortest. `tested` are the effects that the
/// measured run would have shown.
pub fn unseen(
    model: &TwoStageModel,
    noise: &Noise,
    simulated: &[(&Choice, Problem)],
    tested: &[String],
) -> Option<Experiment> {
    let is_friction = model.spec.kind == Kind::Friction;
    let side = Side::new(&model.main, noise);
    let mut best: Option<(ScoredRun, Vec<&str>)> = None;
    for (choice, run) in simulated {
        let worth = match is_friction {
            true => WORTH_SEEING * dot(&run.target, &run.target).sqrt(),
            false => noise.row * (run.rows() as f64).sqrt(),
        };
        let own = side.at(run, noise);
        let mut seen: Vec<(&str, f64)> = Vec::new();
        for effect in model.spec.known().filter(|effect| !tested.iter().any(|id| id == effect.info().id)) {
            let Some((now, then)) = columns_of(effect, model, run, worth) else { continue };
            let (now, then) = (noise.whiten(&now, model.main.problem), noise.whiten(&then, run));
            let (before, after) = side.information(&now, &then, &own);
            if before.sqrt() < FOUND_Z && after.sqrt() >= SEPARATED_Z {
                seen.push((effect.info().id, after.sqrt()));
            }
        }
        let z = seen.iter().map(|s| s.1).fold(f64::INFINITY, f64::min);
        let better = best.as_ref().is_none_or(|(bid, effects)| {
            seen.len() > effects.len() || seen.len() == effects.len() && choice.duration_s < bid.choice.duration_s
        });
        if !seen.is_empty() && better {
            best = Some((ScoredRun { choice, z }, seen.into_iter().map(|s| s.0).collect()));
        }
    }
    best.map(|(bid, effects)| experiment(bid, &effects, is_friction))
}

/// The first column of an effect in the measured run and in another one, both scaled to the norm `worth` in the latter.
/// `None` for an effect of the model, and for one that the other run cannot show either.
fn columns_of(effect: &dyn Effect, model: &TwoStageModel, run: &Problem, worth: f64) -> Option<(Vec<f64>, Vec<f64>)> {
    let is_in_model = model.main.contains(effect.info().id);
    let open = effect.traits().regime == Regime::SteadyState && !effect.traits().is_offset && !is_in_model;
    if !open || effect.hidden(&run.view).is_some() {
        return None;
    }
    let forms = effect.forms(&run.view);
    let form = forms.first()?;
    // A changepoint can only be shown by the run in which it occurs.
    if form.shape.iter().any(|shape| shape.search == ShapeSearch::Jump) {
        return None;
    }
    let shape = &form.grid[form.grid.len() / 2];
    let mut then = columns(effect, form.name, shape, run).swap_remove(0);
    let mut now = match effect.hidden(&model.main.problem.view) {
        Some(_) => vec![0.0; model.main.problem.rows()],
        None => columns(effect, form.name, shape, model.main.problem).swap_remove(0),
    };
    let size = dot(&then, &then).sqrt();
    if size == 0.0 {
        return None;
    }
    let scale = worth / size;
    now.iter_mut().chain(&mut then).for_each(|x| *x *= scale);
    Some((now, then))
}

fn experiment(bid: ScoredRun, effects: &[&str], is_friction: bool) -> Experiment {
    let worth = match is_friction {
        true => format!("{} % of the torque", 100.0 * WORTH_SEEING),
        false => "the size of the scatter of one reading".to_owned(),
    };
    Experiment {
        procedure: bid.choice.procedure.clone(),
        parameters: bid.choice.parameters.clone(),
        why: format!(
            "this run does not reliably show {} as large as {worth}; in the proposed run, that would be {} standard deviations{}",
            list(effects),
            if bid.z > 100.0 { "more than 100".to_owned() } else { format!("at least {:.1}", bid.z) },
            bid.choice.provided(),
        ),
        expected_z: Some(bid.z),
        expected_duration_s: Some(bid.choice.duration_s),
        separates: effects.iter().copied().map(Into::into).collect(),
    }
}
