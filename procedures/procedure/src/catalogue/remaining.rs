//! The remaining steps of a plan after an incomplete run, preceded by steps that restore their history.

use super::legs::Legs;
use crate::bench_facts::BenchFacts;
use crate::plan::{Phase, Plan, Step};
use crate::profile::Profile;
use crate::recorder::RunId;
use crate::resume::{Continuation, FinishedSteps};
use crate::stage_pose::StagePose;
use jointbench_instrument::RunTable;
use std::sync::Arc;

/// Link turns over which the brake current is ramped down before measurements continue.
const DEMAGNETISING_TURNS: f64 = 2.0;

impl Plan {
    /// The rest of the plan from a step on. Before it: the warm-up, if the plan has one; demagnetisation of the brake
    /// during rotation, because it was switched off at an unknown position; and the current of the step, approached
    /// from below. `first_segment` is the first unused segment number.
    ///
    /// `None` if nothing remains, or if only the warm-up was done.
    pub fn remaining(mut self, run: RunId, from_step: usize, first_segment: u32, bench: &BenchFacts) -> Option<Plan> {
        let (done, left) = self.steps.split_at_checked(from_step)?;
        if left.is_empty() || done.iter().all(|step| step.phase == Phase::WarmUp) {
            return None;
        }
        let top_a = self.top_brake_current_a();
        let speed_rad_s = self.top_speed_rad_s();
        let begins_a = left[0].brake.at(0.0);
        let mut legs = Legs::new(self.acceleration_rad_s2);
        legs.steps.extend(done.iter().filter(|step| step.phase == Phase::WarmUp).cloned());
        // Motions out with their motions back.
        legs.steps.truncate(legs.steps.len() / 2 * 2);
        if top_a > 0.0 && speed_rad_s > 0.0 {
            legs.demagnetise(speed_rad_s, top_a, DEMAGNETISING_TURNS, bench);
            if begins_a > 0.0 {
                legs.change(speed_rad_s, 0.0, begins_a);
            }
        }
        let begins_rad: f64 = done.iter().filter_map(|step| step.velocity.integral().last().copied()).sum();
        // Out and back, towards the middle of the range: in a warm-up the motion back comes first.
        if begins_rad > 0.0 {
            let warm = legs.steps.iter().filter(|step| step.phase == Phase::WarmUp).count();
            legs.steps[..warm].chunks_exact_mut(2).for_each(<[Step]>::reverse);
            for step in &mut legs.steps[warm..] {
                step.velocity = std::mem::replace(&mut step.velocity, Profile::from(0.0)).turned();
            }
        }
        let first_segment = first_segment.max(self.steps.iter().map(|step| step.segment + 1).max().unwrap_or(0));
        for (segment, step) in (first_segment..).zip(&mut legs.steps) {
            step.segment = segment;
        }
        let restored = legs.steps.len();
        let mut left = left.to_vec();
        // The last commanded pose of the stage.
        let place = done.iter().rev().find_map(|step| match step.place {
            StagePose::At(pose) => Some(pose),
            StagePose::AsLeft | StagePose::Edge(_) => None,
        });
        if let (StagePose::AsLeft, Some(pose)) = (&left[0].place, place) {
            left[0].place = StagePose::At(pose);
        }
        self.begins_rad = begins_rad;
        self.steps = legs.steps;
        self.steps.append(&mut left);
        let continuation = Continuation { run, from_step, restored, restored_from: first_segment };
        continuation.write_to(&mut self.meta);
        Some(self)
    }

    /// Adds the earlier measurements and their finished steps, if the remaining steps depend on them.
    pub fn with_earlier_measurement(mut self, measured: RunTable, finished: FinishedSteps) -> Plan {
        if let Some(deferred) = &mut self.deferred {
            deferred.earlier = Some(Arc::new((measured, finished)));
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use super::super::legs::testing::joint_a;
    use super::super::procedure;
    use super::*;
    use serde_json::{Map, json};

    fn plan(parameters: serde_json::Value) -> Plan {
        let chosen: Map<_, _> = parameters.as_object().unwrap().clone();
        procedure("friction").unwrap().plan(&chosen, &joint_a()).unwrap()
    }

    #[test]
    fn the_rest_begins_warm_demagnetised_and_under_the_load_of_its_first_step() {
        let whole = plan(json!({}));
        let from = whole.steps.iter().position(|step| step.brake.at(0.0) > 0.1).unwrap();
        let rest = whole.clone().remaining(7, from, 3, &joint_a()).unwrap();
        let continuation = Continuation::of(&rest.meta).unwrap();
        assert_eq!((continuation.run, continuation.from_step), (7, from));
        let (restoring, left) = rest.steps.split_at(continuation.restored);
        assert_eq!(left, &whole.steps[from..]);
        assert!(restoring.iter().all(|step| step.segment >= whole.steps.len() as u32), "numbers of their own");
        assert!(restoring[0].phase == Phase::WarmUp);
        let tops: Vec<f64> = restoring.iter().map(|step| step.brake.largest()).collect();
        let top_a = whole.top_brake_current_a();
        let demagnetised = tops.iter().position(|a| *a == top_a).unwrap();
        assert_eq!(restoring[demagnetised].brake.at(1e9), 0.0, "ramped down while it turns");
        assert_eq!(tops[tops.len() - 1], left[0].brake.at(0.0), "from below");
        assert!(rest.preview(&joint_a()).checks.iter().all(|check| check.ok), "within the limits");
    }

    #[test]
    fn what_is_left_of_a_campaign_fits_into_the_range_wherever_it_ended() {
        let whole = procedure("identify_joint").unwrap().plan(&Map::new(), &joint_a()).unwrap();
        let rests = (0..whole.steps.len()).filter_map(|from| whole.clone().remaining(1, from, 0, &joint_a()));
        let refused: Vec<_> = rests
            .flat_map(|rest| {
                let from = Continuation::of(&rest.meta).unwrap().from_step;
                let broken = rest.preview(&joint_a()).checks.into_iter().filter(|check| !check.ok);
                broken.map(move |check| (from, check.detail)).collect::<Vec<_>>()
            })
            .collect();
        assert_eq!(refused, []);
    }

    #[test]
    fn nothing_but_a_warm_up_is_nothing_to_go_on_from() {
        let whole = plan(json!({}));
        let measured = whole.steps.iter().position(|step| step.phase == Phase::Measure).unwrap();
        let count = whole.steps.len();
        assert!(whole.clone().remaining(1, measured, 0, &joint_a()).is_none());
        assert!(whole.clone().remaining(1, measured + 1, 0, &joint_a()).is_some());
        assert!(whole.clone().remaining(1, count, 0, &joint_a()).is_none(), "all done");
    }
}
