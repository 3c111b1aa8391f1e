//! Repeats the warm-up for a joint that cooled down during a long pause.

use super::ending::Ending;
use super::session::{PendingRequest, Session};
use crate::brake_timing::{LAG_S, RAISE_S};
use crate::plan::{Phase, Step};
use crate::profile::Profile;
use crate::steady::{COOLING_S, SteadyDetector};

impl Session<'_> {
    /// After a pause of this duration in the middle of `step`. Returns whether the brake has a new history, which
    /// ends at the step's initial current, approached from below.
    pub(super) fn rewarm_after(&mut self, rested_s: f64, step: &Step) -> Result<bool, Ending> {
        if rested_s < COOLING_S {
            return Ok(false);
        }
        if step.phase == Phase::WarmUp {
            // Cycles before and after the pause do not belong to one warm-up.
            self.warm = self.plan.steady.map(SteadyDetector::new);
            return Ok(false);
        }
        let plan = self.plan;
        if plan.steps.iter().all(|step| step.phase != Phase::WarmUp) {
            return Ok(false);
        }
        self.note(format!("The joint rested for {rested_s:.0} s. Warm-up is repeated."));
        self.unload()?;
        // Its travel was planned from there.
        self.go_back(plan.top_speed_rad_s(), self.warm_from_rad, 0.0)?;
        let mut watch = plan.steady.map(SteadyDetector::new);
        for step in plan.steps.iter().filter(|step| step.phase == Phase::WarmUp) {
            if self.pending_request == Some(PendingRequest::Pause)
                || watch.as_ref().is_some_and(SteadyDetector::is_steady)
            {
                break;
            }
            self.run_unrecorded(step, watch.as_mut())?;
        }
        self.load(step.brake.at(0.0))?;
        Ok(true)
    }

    /// A step of the warm-up whose rows are shown, but not kept.
    fn run_unrecorded(&mut self, step: &Step, mut watch: Option<&mut SteadyDetector>) -> Result<(), Ending> {
        let plateau_rad_s = step.velocity.largest();
        let start_s = self.period.next_s.max(self.bench.clock.now_s());
        loop {
            let now_s = self.wait();
            let velocity_rad_s = step.velocity.at(now_s - start_s);
            self.tick(now_s, velocity_rad_s, 0.0)?;
            if let (Some(watch), Some(joint)) = (&mut watch, self.joint)
                && velocity_rad_s.abs() >= plateau_rad_s
            {
                watch.sample(now_s, joint.motor_current.0, self.held.temperature_c);
            }
            if now_s - start_s >= step.duration_s() {
                break;
            }
        }
        if let Some(watch) = watch {
            watch.step_done();
        }
        Ok(())
    }

    /// Raises the brake current during rotation, out and back.
    fn load(&mut self, brake_a: f64) -> Result<(), Ending> {
        if brake_a == 0.0 {
            return Ok(());
        }
        let speed_rad_s = self.unload_speed_rad_s();
        let up = self.ramp_to(speed_rad_s);
        let brake = Profile::from(0.0).hold(up.duration_s()).to(brake_a, RAISE_S);
        self.drive(&up.hold(RAISE_S + LAG_S), &brake)?;
        self.drive(&self.ramp_to(0.0), &Profile::constant(brake_a))
    }
}
