//! Hysteresis effects on a run in steps: judged on slow samples and reversals, because steady-state means contain no
//! hysteresis.
//!
//! The instruments are not aligned there and static friction jumps, so that every candidate explains something. An
//! effect is therefore named only if it explains most of the residual. Measured on simulated joints: presliding over
//! more than a few encoder steps explains 83 to 98 % of the squared error there, other effects at most 63 %.

use crate::Options;
use crate::regression::hysteresis_form::Reversals;
use crate::regression::significance::significance;
use crate::regression::two_stage_model::TwoStageModel;
use crate::report::reasons::AdditionReason;
use crate::selection::detection_limit::DetectionLimit;
use crate::selection::forward_step::ScoredCandidate;
use crate::thresholds::MOST_EXPLAINED;

/// The hysteresis effect that this run supports, if there is one.
pub fn hysteresis_step<'p>(now: &TwoStageModel<'p>, options: &Options) -> Option<ScoredCandidate<'p>> {
    let problem = now.prepared.memory.as_ref()?;
    let is_out = |id: &str| !now.effects.iter().any(|e| e == id);
    let reversals = Reversals::new(problem, now.predict(problem), now.spec, is_out);
    let (term, share) = reversals.best()?;
    let p_value = significance(&term, &reversals.library, &reversals.partial, options);
    let reason = AdditionReason::Reversals;
    (share >= MOST_EXPLAINED && p_value <= options.alpha).then(|| ScoredCandidate::alone(term, share, p_value, reason))
}

/// Detection limits of the hysteresis effects that are not in the model, relative to the residual around reversals.
pub fn detection_limits<'p>(now: &TwoStageModel<'p>) -> Vec<DetectionLimit<'p>> {
    let is_meant = |id: &str| now.spec.find(id).is_ok_and(|e| now.is_apart(e)) && !now.effects.iter().any(|e| e == id);
    let Some(problem) = now.prepared.memory.as_ref() else { return Vec::new() };
    let Reversals { partial, library, .. } = Reversals::new(problem, now.predict(problem), now.spec, is_meant);
    let detectable_rms = (MOST_EXPLAINED / (1.0 - MOST_EXPLAINED) * partial.sse / problem.rows() as f64).sqrt();
    let mut seen: Vec<&str> = library.candidates.iter().map(|c| c.id()).collect();
    seen.dedup();
    seen.into_iter().map(|effect| DetectionLimit { effect, detectable_rms }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ModelSpec;
    use crate::effects::friction::presliding;
    use crate::preprocess::prepare;
    use crate::selection::tiny::staircase;
    use jointbench_instrument::Kind;

    #[test]
    fn a_direction_that_follows_over_a_displacement_is_presliding() {
        let options = Options::default();
        let spec = ModelSpec::parse(Kind::Friction, "coulomb, viscous, inertia").unwrap();
        let found = |coulomb_nm: f64| {
            let prepared = prepare(&staircase(coulomb_nm, 0, 0.2), &options).unwrap();
            let model = TwoStageModel::new(&prepared, &spec, &options).unwrap();
            hysteresis_step(&model, &options).map(|scored| scored.term.id().to_owned())
        };
        assert_eq!(found(0.0), None);
        assert_eq!(found(0.03).as_deref(), Some(presliding::ID));
    }
}
