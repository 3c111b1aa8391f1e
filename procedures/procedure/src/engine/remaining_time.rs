//! Remaining time of a run: the planned durations, corrected by the actual durations of the finished steps.

use crate::plan::{Phase, Plan, Step};
use crate::recorder::Progress;

/// Durations of steps that end as planned, and the longest durations of steps that may end earlier.
#[derive(Debug, Clone, Copy, Default)]
struct Durations {
    planned: f64,
    open: f64,
}

impl Durations {
    fn add(&mut self, step: &Step, seconds: f64) {
        *self.of(step.may_end_early()) += seconds;
    }

    fn of(&mut self, open: bool) -> &mut f64 {
        if open { &mut self.open } else { &mut self.planned }
    }
}

#[derive(Debug, Clone)]
pub(super) struct RemainingTime {
    /// Longest duration of each step, and whether it may end earlier.
    steps: Vec<(f64, bool)>,
    /// From the start of each step to the end of the plan, and 0 at the end.
    left_s: Vec<Durations>,
    /// First step after those that a steady joint does not need.
    warm: usize,
    step: usize,
    label: String,
    step_started_s: f64,
    planned_s: Durations,
    taken_s: Durations,
}

impl RemainingTime {
    pub fn new(plan: &Plan) -> Self {
        let mut left = Durations::default();
        let mut left_s = vec![left];
        for step in plan.steps.iter().rev() {
            left.add(step, step.duration_s());
            left_s.push(left);
        }
        left_s.reverse();
        let last = plan.steps.iter().rposition(|step| step.phase == Phase::WarmUp);
        Self {
            steps: plan.steps.iter().map(|step| (step.duration_s(), step.may_end_early())).collect(),
            left_s,
            warm: last.filter(|_| plan.steady.is_some()).map_or(0, |last| last + 1),
            step: 0,
            label: String::new(),
            step_started_s: 0.0,
            planned_s: Durations::default(),
            taken_s: Durations::default(),
        }
    }

    pub fn step_started(&mut self, step: usize, label: &str, now_s: f64) {
        self.step = step;
        label.clone_into(&mut self.label);
        self.step_started_s = now_s;
    }

    pub fn step_done(&mut self, now_s: f64) {
        let (longest_s, open) = self.steps[self.step];
        *self.planned_s.of(open) += longest_s;
        *self.taken_s.of(open) += now_s - self.step_started_s;
        self.step += 1;
        self.step_started_s = now_s;
    }

    /// A skipped step does not change the pace.
    pub fn step_skipped(&mut self) {
        self.step += 1;
    }

    /// While a step waits, its share of the remaining time is constant.
    pub fn progress(&self, started_s: f64, now_s: f64, moving: bool) -> Progress {
        let mut left = self.left_s[self.step];
        if let Some((longest_s, open)) = self.steps.get(self.step).filter(|_| moving) {
            *left.of(*open) -= (now_s - self.step_started_s).min(*longest_s);
        }
        let pace = |taken_s: f64, planned_s: f64| if planned_s > 0.0 { taken_s / planned_s } else { 1.0 };
        let remaining_s = left.planned * pace(self.taken_s.planned, self.planned_s.planned)
            + left.open * pace(self.taken_s.open, self.planned_s.open);
        Progress {
            step: self.step,
            steps: self.steps.len(),
            label: self.label.clone(),
            elapsed_s: now_s - started_s,
            remaining_s,
            at_most: self.step < self.warm || (left.open > 0.0 && self.planned_s.open == 0.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::testing::plan_of;
    use crate::plan::{Drive, EndCondition};
    use crate::profile::Profile;
    use crate::stage_pose::{Edge, StagePose};
    use jointbench_instrument::roles::Pose;

    #[test]
    fn slow_steps_stretch_what_remains() {
        let plan = plan_of(&[10.0, 10.0, 20.0]);
        let mut pace = RemainingTime::new(&plan);
        pace.step_started(0, "first", 100.0);
        assert_eq!(pace.progress(100.0, 104.0, true).remaining_s, 36.0);
        assert_eq!(pace.progress(100.0, 104.0, false).remaining_s, 40.0);
        pace.step_done(112.0);
        pace.step_started(1, "second", 112.0);
        let progress = pace.progress(100.0, 112.0, true);
        assert!((progress.remaining_s - 36.0).abs() < 1e-9, "{progress:?}");
        assert_eq!((progress.step, progress.steps, progress.elapsed_s), (1, 3, 12.0));
    }

    #[test]
    fn steps_that_end_at_breakaway_are_at_most_so_long_until_one_has_ended() {
        let mut plan = plan_of(&[10.0, 40.0, 10.0, 40.0]);
        for step in [1, 3] {
            let current_a = Profile::from(0.0).to(1.0, 40.0);
            plan.steps[step].drive =
                Drive::Current { from_s: 0.0, current_a, until: EndCondition { increases: 3, speed_rad_s: 1.0 } };
        }
        let mut pace = RemainingTime::new(&plan);
        pace.step_started(0, "approach", 0.0);
        let progress = pace.progress(0.0, 0.0, true);
        assert_eq!((progress.remaining_s, progress.at_most), (100.0, true));
        pace.step_done(10.0);
        pace.step_done(30.0);
        let progress = pace.progress(0.0, 30.0, true);
        assert_eq!((progress.remaining_s, progress.at_most), (30.0, false), "half of the longest ramp was needed");
    }

    #[test]
    fn a_search_for_an_edge_is_at_most_so_long() {
        let mut plan = plan_of(&[10.0, 40.0]);
        let [from, to] = [Pose::default(), Pose { shift_m: [1e-3, 0.0, 0.0], ..Pose::default() }];
        plan.steps[1].place = StagePose::Edge(Edge { from, to, strides: 8, halvings: 4, dwell_s: 1.0 });
        let progress = RemainingTime::new(&plan).progress(0.0, 0.0, true);
        assert_eq!((progress.remaining_s, progress.at_most), (50.0, true));
    }
}
