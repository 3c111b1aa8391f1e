//! A pause: ramp to rest, hold, return to the start of the interrupted step; after a long pause, warm up again.

use super::ending::Ending;
use super::session::{PendingRequest, Session};
use crate::plan::{InitialState, Step};
use crate::profile::Profile;
use crate::state::Transition;

/// Gain of the return: an exponential approach with a time constant of a quarter of a second.
const RETURN_PER_S: f64 = 4.0;
/// Tolerance at the start of the step, motor side.
const RETURNED_RAD: f64 = 0.2;
/// Additional time of the return, after twice the expected time, before it is given up.
const RETURN_GRACE_S: f64 = 5.0;

impl Session<'_> {
    /// Returns when the step may begin again, with the brake current at the start of the pause (A).
    pub(super) fn pause(&mut self, step: &Step, start_rad: Option<f64>) -> Result<f64, Ending> {
        // A constant current through standstill and restart causes no cogging.
        let mut brake_a = self.commanded.brake_a;
        let mut rested_s = 0.0;
        loop {
            self.enter(Transition::Pause)?;
            let since_s = self.bench.clock.now_s();
            self.drive(&self.ramp_to(0.0), &Profile::constant(brake_a))?;
            while self.pending_request.take() != Some(PendingRequest::Resume) {
                let now_s = self.wait();
                self.tick(now_s, 0.0, brake_a)?;
            }
            self.enter(Transition::Resume)?;
            rested_s += self.bench.clock.now_s() - since_s;
            if self.rewarm_after(rested_s, step)? {
                brake_a = self.commanded.brake_a;
            } else if step.before == InitialState::Demagnetised {
                self.unload()?;
                brake_a = self.commanded.brake_a;
            }
            let speed_rad_s = step.velocity.largest().max(0.25 * self.plan.top_speed_rad_s());
            self.go_back(speed_rad_s, start_rad, brake_a)?;
            if self.pending_request.take() != Some(PendingRequest::Pause) {
                return Ok(brake_a);
            }
        }
    }

    /// Follows set-points over time; the rows are shown, but not kept.
    pub(super) fn drive(&mut self, velocity: &Profile, brake: &Profile) -> Result<(), Ending> {
        let start_s = self.period.next_s.max(self.bench.clock.now_s());
        let duration_s = velocity.duration_s().max(brake.duration_s());
        loop {
            let now_s = self.wait();
            let t_s = now_s - start_s;
            self.tick(now_s, velocity.at(t_s), brake.at(t_s))?;
            if t_s >= duration_s {
                return Ok(());
            }
        }
    }

    /// From the commanded velocity to another one, with the acceleration of the plan.
    pub(super) fn ramp_to(&self, velocity_rad_s: f64) -> Profile {
        let from_rad_s = self.commanded.velocity_rad_s;
        let seconds = (velocity_rad_s - from_rad_s).abs() / self.plan.acceleration_rad_s2;
        Profile::from(from_rad_s).to(velocity_rad_s, seconds)
    }

    /// The travel and range of a step were planned from its start.
    pub(super) fn go_back(&mut self, speed_rad_s: f64, start_rad: Option<f64>, brake_a: f64) -> Result<(), Ending> {
        let Some(start_rad) = start_rad else { return Ok(()) };
        let away_rad = |session: &Self| session.joint.map_or(0.0, |reading| start_rad - reading.motor_position.0);
        let give_up_s = self.bench.clock.now_s() + 2.0 * away_rad(self).abs() / speed_rad_s + RETURN_GRACE_S;
        let change_rad_s = self.plan.acceleration_rad_s2 * self.period.duration_s;
        while away_rad(self).abs() > RETURNED_RAD && self.pending_request != Some(PendingRequest::Pause) {
            let now_s = self.wait();
            if now_s > give_up_s {
                let left_rad = away_rad(self);
                self.note(format!(
                    "The return after the pause ended {left_rad:.2} rad (motor) from the start of the step."
                ));
                break;
            }
            let wanted_rad_s = (RETURN_PER_S * away_rad(self)).clamp(-speed_rad_s, speed_rad_s);
            let before_rad_s = self.commanded.velocity_rad_s;
            let velocity_rad_s = wanted_rad_s.clamp(before_rad_s - change_rad_s, before_rad_s + change_rad_s);
            self.tick(now_s, velocity_rad_s, brake_a)?;
        }
        self.drive(&self.ramp_to(0.0), &Profile::constant(brake_a))
    }
}
