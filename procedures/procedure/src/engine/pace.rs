//! How long a run still takes: the plan's durations, corrected by what the steps so far really took.

use crate::plan::{Phase, Plan};
use crate::recorder::Progress;

#[derive(Debug, Clone)]
pub(super) struct Pace {
    /// Planned time from the start of each step to the end of the plan, and 0 at the end.
    left_s: Vec<f64>,
    /// First step after those that a steady joint needs no more.
    warm: usize,
    steps: usize,
    step: usize,
    label: String,
    step_started_s: f64,
    planned_s: f64,
    taken_s: f64,
}

impl Pace {
    pub fn new(plan: &Plan) -> Self {
        let mut left_s = vec![0.0];
        for step in plan.steps.iter().rev() {
            left_s.push(left_s[left_s.len() - 1] + step.duration_s());
        }
        left_s.reverse();
        let steps = plan.steps.len();
        let last = plan.steps.iter().rposition(|step| step.phase == Phase::WarmUp);
        let warm = last.filter(|_| plan.steady.is_some()).map_or(0, |last| last + 1);
        Self { left_s, warm, steps, step: 0, label: String::new(), step_started_s: 0.0, planned_s: 0.0, taken_s: 0.0 }
    }

    pub fn step_started(&mut self, step: usize, label: &str, now_s: f64) {
        self.step = step;
        label.clone_into(&mut self.label);
        self.step_started_s = now_s;
    }

    pub fn step_done(&mut self, now_s: f64) {
        self.planned_s += self.left_s[self.step] - self.left_s[self.step + 1];
        self.taken_s += now_s - self.step_started_s;
        self.step += 1;
        self.step_started_s = now_s;
    }

    /// A step that was not needed says nothing about the pace.
    pub fn step_skipped(&mut self) {
        self.step += 1;
    }

    /// While a step waits, its own share of the remaining time does not fall.
    pub fn progress(&self, started_s: f64, now_s: f64, moving: bool) -> Progress {
        let correction = if self.planned_s > 0.0 { self.taken_s / self.planned_s } else { 1.0 };
        let this_s = self.left_s[self.step] - self.left_s.get(self.step + 1).unwrap_or(&0.0);
        let done_s = if moving { (now_s - self.step_started_s).min(this_s) } else { 0.0 };
        Progress {
            step: self.step,
            steps: self.steps,
            label: self.label.clone(),
            elapsed_s: now_s - started_s,
            remaining_s: (self.left_s[self.step] - done_s) * correction,
            at_most: self.step < self.warm,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::testing::plan_of;

    #[test]
    fn slow_steps_stretch_what_remains() {
        let plan = plan_of(&[10.0, 10.0, 20.0]);
        let mut pace = Pace::new(&plan);
        pace.step_started(0, "first", 100.0);
        assert_eq!(pace.progress(100.0, 104.0, true).remaining_s, 36.0);
        assert_eq!(pace.progress(100.0, 104.0, false).remaining_s, 40.0);
        pace.step_done(112.0);
        pace.step_started(1, "second", 112.0);
        let progress = pace.progress(100.0, 112.0, true);
        assert!((progress.remaining_s - 36.0).abs() < 1e-9, "{progress:?}");
        assert_eq!((progress.step, progress.steps, progress.elapsed_s), (1, 3, 12.0));
    }
}
