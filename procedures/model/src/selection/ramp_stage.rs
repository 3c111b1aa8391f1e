//! A torque delay in a run in steps: judged on the ramps, because steady-state means contain no delay.
//!
//! The instruments are not aligned there. A drive reports a filtered velocity, so that the torque looks early without
//! any hidden effect: by 0 to 30 ms on simulated joints. Only a torque that follows the motion counts as delay.

use crate::Options;
use crate::effect::Effect;
use crate::inference::intervals::intervals;
use crate::linear::basis::dot;
use crate::regression::linear_model::LinearModel;
use crate::regression::partial_regression::PartialRegression;
use crate::regression::significance::alone;
use crate::regression::two_stage_model::TwoStageModel;
use crate::report::reasons::AdditionReason;
use crate::selection::detection_limit::DetectionLimit;
use crate::selection::forward_step::ScoredCandidate;
use crate::thresholds::{DELAY_ROWS, NOISE_ERRORS};

/// Half a 95 % interval of the normal distribution, in standard errors.
const Z_975: f64 = 1.960;

/// Standard errors that 80 % power adds to a critical size.
const Z_800: f64 = 0.842;

/// The delay that this run supports, with the model that includes it. Its coefficient divided by the inertia is the
/// delay time.
pub fn delay<'p>(now: &TwoStageModel<'p>, options: &Options) -> Option<(ScoredCandidate<'p>, TwoStageModel<'p>)> {
    let Delayed { effect, after, coefficient, least, .. } = with_delay(now)?;
    let moving = after.moving.as_ref()?;
    let term = moving.terms.iter().find(|term| term.id() == effect)?.clone();
    let without = moving.without(effect);
    // A delayed friction torque jumps after the direction changes. The jerk column does not represent that jump.
    let asked = |residual: Vec<f64>| -> f64 {
        let column = &term.columns[0];
        residual.iter().zip(column).filter(|(_, jerk)| **jerk != 0.0).map(|(r, _)| r * r).sum()
    };
    let share = 1.0 - asked(moving.linear().residual) / asked(without.linear().residual);
    let p_value = alone(&term, &PartialRegression::of(&without), options);
    let is_delayed = -coefficient > least && share >= options.practical_share && p_value <= options.alpha;
    is_delayed.then(|| (ScoredCandidate::alone(term, share, p_value, AdditionReason::Ramps), after))
}

/// The detection limit of the delay, if none was found and one could have been.
pub fn detection_limit<'p>(now: &TwoStageModel<'p>) -> Option<DetectionLimit<'p>> {
    let Delayed { effect, after, error, least, .. } = with_delay(now)?;
    let column = after.moving.as_ref()?.terms.iter().find(|term| term.id() == effect)?.columns.first()?.clone();
    let rms = (dot(&column, &column) / column.len() as f64).sqrt();
    Some(DetectionLimit { effect, detectable_rms: (least + Z_800 * error) * rms })
}

/// A model with a delay on its ramps: the delay, its coefficient with the standard error, and the least
/// coefficient that is named.
struct Delayed<'p> {
    effect: &'p str,
    after: TwoStageModel<'p>,
    coefficient: f64,
    error: f64,
    least: f64,
}

fn with_delay<'p>(now: &TwoStageModel<'p>) -> Option<Delayed<'p>> {
    let (delay, delayed) = now.spec.known().find_map(|effect| Some((effect, effect.traits().delay_of?)))?;
    let effect = delay.info().id;
    if !is_testable(delay, delayed, now) {
        return None;
    }
    let effects = now.effects.iter().cloned().chain([effect.to_owned()]).collect();
    let after = now.of(now.main.clone(), effects);
    let moving: &LinearModel = after.moving.as_ref()?;
    let parameters = intervals(moving, now.prepared.motion).parameters;
    let of = |id: &str| parameters.iter().find(|p| p.effect == id);
    let (delayed, delay) = (of(delayed)?, of(effect)?);
    let (coefficient, error) = (delay.value, (delay.ci95[1] - delay.ci95[0]) / (2.0 * Z_975));
    let least = (NOISE_ERRORS * error).max(DELAY_ROWS * moving.problem.view.sample_s * delayed.value);
    (delayed.value > 0.0 && error.is_finite()).then_some(Delayed { effect, after, coefficient, error, least })
}

/// Whether only ramps can show the delay and the model has the delayed effect, which scales the delay to a time.
fn is_testable(delay: &dyn Effect, delayed: &str, now: &TwoStageModel) -> bool {
    let is_in = |id: &str| now.effects.iter().any(|effect| effect == id);
    now.is_apart(delay) && is_in(delayed) && !is_in(delay.info().id)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ModelSpec;
    use crate::effects::friction::signal_delay;
    use crate::preprocess::prepare;
    use crate::selection::tiny::staircase;
    use jointbench_instrument::Kind;

    #[test]
    fn a_torque_that_follows_the_motion_late_is_a_delay() {
        let options = Options::default();
        let spec = ModelSpec::parse(Kind::Friction, "coulomb, viscous, inertia").unwrap();
        let found = |late: usize| {
            let prepared = prepare(&staircase(0.03, late, 0.0), &options).unwrap();
            let model = TwoStageModel::new(&prepared, &spec, &options).unwrap();
            delay(&model, &options).map(|(scored, _)| scored.term.id().to_owned())
        };
        assert_eq!(found(0), None);
        assert_eq!(found(6).as_deref(), Some(signal_delay::ID));
    }
}
