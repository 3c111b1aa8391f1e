//! A torque delay in a run in steps: judged on the ramps, because steady-state means contain no delay.
//!
//! The instruments are not aligned there. A drive reports a filtered velocity, so that the torque looks early without
//! any hidden effect: by 0 to 30 ms on simulated joints. Only a torque that follows the motion counts as delay.

use crate::Options;
use crate::effect::Effect;
use crate::effects::friction::inertia;
use crate::inference::intervals::intervals;
use crate::linear::basis::dot;
use crate::regression::linear_model::LinearModel;
use crate::regression::partial_regression::PartialRegression;
use crate::regression::significance::alone;
use crate::regression::solution::DELAY;
use crate::regression::two_stage_model::TwoStageModel;
use crate::report::reasons::AdditionReason;
use crate::selection::detection_limit::DetectionLimit;
use crate::selection::forward_step::ScoredCandidate;
use crate::thresholds::{DELAY_HALF_WIDTHS, DELAY_POWER, DELAY_ROWS};

/// The delay that this run supports, with the model that includes it. Its coefficient divided by the inertia is the
/// delay time.
pub fn delay<'p>(now: &TwoStageModel<'p>, options: &Options) -> Option<(ScoredCandidate<'p>, TwoStageModel<'p>)> {
    let Delayed { after, coefficient, half, by_s } = with_delay(now)?;
    let moving = after.moving.as_ref()?;
    let term = moving.terms.iter().find(|term| term.id() == DELAY)?.clone();
    let without = moving.without(DELAY);
    // A delayed friction torque jumps after the direction changes. The jerk column does not represent that jump.
    let asked = |residual: Vec<f64>| -> f64 {
        let column = &term.columns[0];
        residual.iter().zip(column).filter(|(_, jerk)| **jerk != 0.0).map(|(r, _)| r * r).sum()
    };
    let share = 1.0 - asked(moving.linear().residual) / asked(without.linear().residual);
    let p_value = alone(&term, &PartialRegression::of(&without), options);
    let is_delayed = coefficient < -DELAY_HALF_WIDTHS * half
        && by_s > DELAY_ROWS * moving.problem.view.sample_s
        && share >= options.practical_share
        && p_value <= options.alpha;
    is_delayed.then(|| (ScoredCandidate::alone(term, share, p_value, AdditionReason::Ramps), after))
}

/// The detection limit of the delay, if none was found and one could have been.
pub fn detection_limit<'p>(now: &TwoStageModel<'p>) -> Option<DetectionLimit<'p>> {
    let Delayed { after, half, .. } = with_delay(now)?;
    let column = after.moving.as_ref()?.terms.iter().find(|term| term.id() == DELAY)?.columns.first()?.clone();
    let rms = (dot(&column, &column) / column.len() as f64).sqrt();
    Some(DetectionLimit { effect: DELAY, detectable_rms: (DELAY_HALF_WIDTHS + DELAY_POWER) * half * rms })
}

/// A model with a delay on its ramps, the coefficient of the delay with half its 95 % interval, and the delay time.
struct Delayed<'p> {
    after: TwoStageModel<'p>,
    coefficient: f64,
    half: f64,
    by_s: f64,
}

fn with_delay<'p>(now: &TwoStageModel<'p>) -> Option<Delayed<'p>> {
    let effect = now.spec.find(DELAY).ok().filter(|effect| is_testable(*effect, now))?;
    let effects = now.effects.iter().cloned().chain([effect.info().id.to_owned()]).collect();
    let after = now.of(now.main.clone(), effects);
    let moving: &LinearModel = after.moving.as_ref()?;
    let parameters = intervals(moving, now.prepared.motion).parameters;
    let of = |id: &str| parameters.iter().find(|p| p.effect == id);
    let (inertia, delay_parameter) = (of(inertia::ID)?, of(DELAY)?);
    let (coefficient, half) = (delay_parameter.value, (delay_parameter.ci95[1] - delay_parameter.ci95[0]) / 2.0);
    let by_s = -coefficient / inertia.value;
    (inertia.value > 0.0 && half.is_finite()).then_some(Delayed { after, coefficient, half, by_s })
}

/// Whether only ramps can show the delay and the model has an inertia, which scales the delay to a time.
fn is_testable(effect: &dyn Effect, now: &TwoStageModel) -> bool {
    let is_in = |id: &str| now.effects.iter().any(|effect| effect == id);
    now.is_apart(effect) && is_in(inertia::ID) && !is_in(DELAY)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ModelSpec;
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
        assert_eq!(found(6).as_deref(), Some(DELAY));
    }
}
