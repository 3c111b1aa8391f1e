//! Runs the steps of a plan in order. The end of a step is a checkpoint.

use super::drive::{BreakawayDetector, MeasuredFriction};
use super::ending::Ending;
use super::session::{BrakeCommand, DriveCommand, PendingRequest, Session};
use crate::event::EventKind;
use crate::plan::{BrakeControl, Drive, InitialState, Phase, Step};
use crate::stage_pose::StagePose;

/// How a step ended.
pub(super) enum StepEnd {
    Done,
    Paused,
}

impl Session<'_> {
    pub(super) fn run_steps(&mut self) -> Result<(), Ending> {
        let plan = self.plan;
        for (index, step) in plan.steps.iter().enumerate() {
            if step.phase == Phase::WarmUp && self.warm.as_ref().is_some_and(|watch| watch.is_steady()) {
                self.remaining_time.step_skipped();
                continue;
            }
            let Some(step) = self.planned_step(index, step)? else {
                self.remaining_time.step_skipped();
                continue;
            };
            self.run_step(index, &step)?;
            if step.phase == Phase::WarmUp {
                self.note_warm_up(index);
            }
        }
        Ok(())
    }

    /// Runs a step, and repeats it from its beginning after every pause.
    fn run_step(&mut self, index: usize, step: &Step) -> Result<(), Ending> {
        let start_rad = self.joint.map(|reading| reading.motor_position.0);
        if step.phase == Phase::WarmUp {
            self.warm_from_rad = self.warm_from_rad.or(start_rad);
        }
        let mut segment = step.segment;
        // The brake keeps its current from the pause until the repeated step needs more, because a current is
        // approached from below.
        let mut least_brake_a = 0.0;
        while let StepEnd::Paused = self.attempt(index, step, segment, least_brake_a)? {
            least_brake_a = self.pause(step, start_rad)?;
            // A segment is one uninterrupted section of the run table.
            segment = self.next_segment;
            self.next_segment += 1;
        }
        Ok(())
    }

    fn attempt(&mut self, index: usize, step: &Step, segment: u32, mut least_brake_a: f64) -> Result<StepEnd, Ending> {
        if step.before == InitialState::PoweredAnew {
            self.power_cycle()?;
        }
        if let StagePose::At(pose) = step.place {
            self.move_stage(pose)?;
        }
        let start_s = self.period.next_s.max(self.bench.clock.now_s());
        (self.period.late_ticks, self.recoveries) = (0, 0);
        let rows_before = self.journal.rows();
        self.remaining_time.step_started(index, &step.label, start_s);
        let label = step.label.clone();
        self.journal.log(start_s, EventKind::StepStarted { step: index, segment, repeat: step.repeat, label });
        if let StagePose::Edge(edge) = &step.place {
            return match self.search_edge(step, segment, edge)? {
                StepEnd::Done => self.checkpoint(index, segment, rows_before),
                paused => Ok(paused),
            };
        }
        let magnetises = step.brake_control == BrakeControl::Magnetise;
        self.magnetised |= magnetises;
        let (duration_s, plateau_rad_s) = (step.duration_s(), step.velocity.largest());
        let (mut friction, mut breakaway) = (MeasuredFriction::default(), BreakawayDetector::default());
        loop {
            let now_s = self.wait();
            let t_s = now_s - start_s;
            if t_s >= duration_s - 0.5 * self.period.duration_s {
                break;
            }
            let planned_a = step.brake.at(t_s);
            least_brake_a = if planned_a >= least_brake_a { 0.0 } else { least_brake_a };
            let velocity_rad_s = step.velocity.at(t_s);
            let command = self.drive_command(step, t_s, &mut friction);
            let brake = BrakeCommand { a: planned_a.max(least_brake_a), magnetises };
            self.tick_with(now_s, command, brake, Some((segment, step.repeat)))?;
            if let (Drive::Current { until, .. }, DriveCommand::Current { a }) = (&step.drive, command)
                && breakaway.is_detected(*until, a, self.joint)
            {
                break;
            }
            if let (Some(watch), Some(joint)) = (&mut self.warm, self.joint)
                && step.phase == Phase::WarmUp
                && velocity_rad_s.abs() >= plateau_rad_s
            {
                watch.sample(now_s, joint.motor_current.0, self.held.temperature_c);
            }
            if self.pending_request.take() == Some(PendingRequest::Pause) {
                return Ok(StepEnd::Paused);
            }
        }
        // The last tick belongs to the next step.
        self.period.next_s -= self.period.duration_s;
        self.checkpoint(index, segment, rows_before)
    }

    fn checkpoint(&mut self, index: usize, segment: u32, rows_before: u64) -> Result<StepEnd, Ending> {
        let now_s = self.bench.clock.now_s();
        self.remaining_time.step_done(now_s);
        let (rows, late_ticks) = (self.journal.rows() - rows_before, self.period.late_ticks);
        self.journal.log(now_s, EventKind::StepFinished { step: index, segment, rows, late_ticks });
        self.journal.commit(now_s)?;
        Ok(StepEnd::Done)
    }

    fn note_warm_up(&mut self, index: usize) {
        let Some(watch) = &mut self.warm else { return };
        watch.step_done();
        let last = self.plan.steps.get(index + 1).is_none_or(|next| next.phase != Phase::WarmUp);
        let Some(drift) = watch.drift() else {
            if last {
                self.note("The warm-up is too short to show whether the joint is warm: it needs three strokes in each direction");
            }
            return;
        };
        let drift = format!(
            "temperature drift {:.2} K/min, current drift {:.1} %/min",
            drift.temperature_c_per_min,
            100.0 * drift.current_share_per_min
        );
        match (watch.is_steady(), last) {
            (true, _) => self.note(format!("Steady state reached: {drift}")),
            (false, true) => self.warn(format!("not warmed up: {drift} at the end of the warm-up")),
            (false, false) => {}
        }
    }
}
