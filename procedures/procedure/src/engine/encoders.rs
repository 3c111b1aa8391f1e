//! Additional instruments of an encoder bench: two counters and a stage.

use super::ask::ask;
use super::ending::Ending;
use super::pose_deviation::PoseDeviation;
use super::session::{DriveCommand, PendingRequest, Session, log, reported};
use super::steps::StepEnd;
use crate::encoder_columns::Encoders;
use crate::event::EventKind;
use crate::plan::Step;
use crate::profile::Profile;
use crate::stage_pose::{Edge, EdgeSearch, StagePose};
use jointbench_instrument::clock::timed;
use jointbench_instrument::roles::{AlignmentStage, Pose, PositionCounter};
use jointbench_instrument::{Fault, FaultKind, Kind};
use std::sync::Arc;

/// Time until an accepted move starts (gcs2-hexapod, timing).
const SET_OFF_S: f64 = 0.2;
/// Polling period of the stage during a move.
const ARRIVED_EVERY_S: f64 = 0.05;
/// Longest move, and longest search for the zeros of the axes.
const LONGEST_MOVE_S: f64 = 60.0;

impl Session<'_> {
    /// Reads both encoders in a run of encoders.
    pub(super) fn read_encoders(&mut self) -> Result<Option<Encoders>, Ending> {
        if self.plan.kind != Kind::Encoder || self.failed.sensor {
            return Ok(None);
        }
        let reference = self.ask_encoder(false, |encoder| encoder.read())?;
        let test = self.ask_encoder(true, |encoder| encoder.read())?;
        let consistent = self
            .ask_encoder(true, |encoder| encoder.status().map(|status| status.periods_are_consistent()).transpose())?;
        self.consistent &= consistent != Some(false);
        Ok(Some(Encoders { reference, test, consistent }))
    }

    pub(super) fn ask_encoder<T>(
        &mut self,
        under_test: bool,
        request: impl FnMut(&mut (dyn PositionCounter + 'static)) -> Result<T, Fault>,
    ) -> Result<T, Ending> {
        let now_s = self.bench.clock.now_s();
        let Self { bench, journal, recoveries, failed, .. } = self;
        let encoder = if under_test { &mut bench.test_encoder } else { &mut bench.reference_encoder };
        let Some(encoder) = encoder else {
            return Err(Ending::NotReady("the bench needs a reference encoder and a test encoder".into()));
        };
        ask(encoder.as_mut(), request, |fault| log(journal, recoveries, now_s, fault)).map_err(|fault| {
            failed.sensor = true;
            Ending::OtherFault(fault)
        })
    }

    fn ask_stage<T>(
        &mut self,
        request: impl FnMut(&mut (dyn AlignmentStage + 'static)) -> Result<T, Fault>,
    ) -> Result<T, Ending> {
        let now_s = self.bench.clock.now_s();
        let Self { bench, journal, recoveries, .. } = self;
        let Some(stage) = &mut bench.stage else { return Err(Ending::NotReady("the bench has no stage".into())) };
        ask(stage.as_mut(), request, |fault| log(journal, recoveries, now_s, fault)).map_err(Ending::OtherFault)
    }

    /// Before arming: identity of the encoders, and a stage that knows its zeros if the plan needs it.
    pub(super) fn identify_encoders(&mut self) -> Result<(), Ending> {
        if self.plan.kind == Kind::Encoder {
            for under_test in [false, true] {
                let identity = self.ask_encoder(under_test, |encoder| encoder.identify())?;
                let encoder = if under_test { &self.bench.test_encoder } else { &self.bench.reference_encoder };
                if let Some(encoder) = encoder {
                    let (instrument, port) = (encoder.name().to_owned(), encoder.port().to_owned());
                    let now_s = self.bench.clock.now_s();
                    self.journal.log(now_s, EventKind::Identified { instrument, port, identity });
                }
            }
        }
        if self.plan.steps.iter().all(|step| step.place == StagePose::AsLeft) {
            return Ok(());
        }
        self.ask_stage(|stage| stage.identify())?;
        if !self.ask_stage(|stage| stage.is_referenced())? {
            self.note("Stage referencing started.");
            self.ask_stage(|stage| stage.reference())?;
            self.until_stage(
                "complete its referencing",
                |stage| stage.is_referenced(),
                |session| {
                    session.bench.clock.sleep_until_s(session.bench.clock.now_s() + ARRIVED_EVERY_S);
                    session.poll_controls(session.bench.clock.now_s())
                },
            )?;
        }
        self.pose = Some(self.ask_stage(|stage| stage.pose())?);
        Ok(())
    }

    /// Moves to a pose while the shaft follows its set-points, and waits until the stage is settled.
    pub(super) fn move_stage(&mut self, pose: Pose) -> Result<(), Ending> {
        if self.pose == Some(pose) {
            return Ok(());
        }
        self.ask_stage(|stage| stage.move_to(pose))?;
        // No row is kept before the stage has arrived.
        self.pose = Some(pose);
        let here = Profile::from(self.commanded.velocity_rad_s);
        let brake = Profile::constant(self.commanded.brake_a);
        self.drive(&here.clone().hold(SET_OFF_S), &brake)?;
        self.until_stage(
            "reach its target",
            |stage| stage.is_settled(),
            |session| session.drive(&here.clone().hold(ARRIVED_EVERY_S), &brake),
        )?;
        let clock = Arc::clone(&self.bench.clock);
        let reached = self.ask_stage(|stage| timed(&*clock, || stage.pose()))?;
        self.pose_deviation = Some(PoseDeviation::add(self.pose_deviation, pose, &reached));
        Ok(())
    }

    fn until_stage(
        &mut self,
        what: &str,
        done: impl Fn(&mut (dyn AlignmentStage + 'static)) -> Result<bool, Fault>,
        mut wait: impl FnMut(&mut Self) -> Result<(), Ending>,
    ) -> Result<(), Ending> {
        let give_up_s = self.bench.clock.now_s() + LONGEST_MOVE_S;
        while !self.ask_stage(&done)? {
            if self.bench.clock.now_s() > give_up_s {
                let what = format!("the stage did not {what} within {LONGEST_MOVE_S:.0} s");
                return Err(Ending::OtherFault(match &self.bench.stage {
                    Some(stage) => reported(stage.as_ref(), what),
                    None => FaultKind::Reported { what }.at("stage", ""),
                }));
            }
            wait(self)?;
        }
        Ok(())
    }

    /// One edge search: the rows of every try are kept, those of the moves between are not.
    pub(super) fn search_edge(&mut self, step: &Step, segment: u32, edge: &Edge) -> Result<StepEnd, Ending> {
        self.move_stage(edge.from)?;
        let speed_rad_s =
            step.velocity.knots().iter().map(|(_, v)| *v).fold(0.0, |a: f64, b| if b.abs() > a.abs() { b } else { a });
        let brake = Profile::constant(self.commanded.brake_a);
        self.drive(&self.ramp_to(speed_rad_s), &brake)?;
        let mut search_edge = EdgeSearch::new(*edge);
        loop {
            self.consistent = true;
            let start_s = self.period.next_s.max(self.bench.clock.now_s());
            loop {
                let now_s = self.wait();
                if now_s - start_s >= edge.dwell_s {
                    break;
                }
                let command = DriveCommand::Velocity { rad_s: speed_rad_s, feedforward_a: 0.0 };
                self.tick_with(now_s, command, self.commanded.brake_a.into(), Some((segment, step.repeat)))?;
            }
            self.period.next_s -= self.period.duration_s;
            if self.pending_request.take() == Some(PendingRequest::Pause) {
                return Ok(StepEnd::Paused);
            }
            let next = search_edge.next(self.consistent);
            if search_edge.is_beyond() || next.is_none() {
                self.move_stage(edge.pose(search_edge.good))?;
            }
            match next {
                Some(next) => self.move_stage(edge.pose(next))?,
                None => break,
            }
        }
        self.move_stage(edge.from)?;
        self.drive(&self.ramp_to(0.0), &brake)?;
        Ok(StepEnd::Done)
    }
}
