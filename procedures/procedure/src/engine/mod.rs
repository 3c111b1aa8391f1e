//! Runs a plan on a bench: arm, run, secure. One thread, one loop, and every exit leads to the safe state.

mod arm;
mod ask;
mod deferred_steps;
mod drive;
mod encoders;
mod ending;
mod journal;
mod pause;
mod plan_deferred;
mod pose_deviation;
mod power;
mod remaining_time;
mod rewarm;
mod safe_state;
mod securing;
mod session;
mod shaft;
mod skew;
mod steps;
mod tick;
mod torque;

use crate::event::{Demand, EventKind, Safe};
use crate::plan::Plan;
use crate::recorder::{Recorder, RunId};
use crate::state::{RunState, Transition};
use ending::Ending;
use jointbench_instrument::Bench;
use pose_deviation::PoseDeviation;
pub use safe_state::{Secured, secure};
use serde::{Deserialize, Serialize};
use session::Session;
use skew::SkewRange;
use std::sync::mpsc::Receiver;
pub use tick::SLOW_EVERY_S;

/// How a run ended.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RunEnd {
    /// Final state.
    pub state: RunState,
    /// Result of securing the bench.
    pub safe: Safe,
    /// Why the run was not completed.
    pub reason: Option<String>,
    /// Rows that the recorder has accepted.
    pub rows: u64,
    /// Duration on the bench clock, including pauses and securing.
    pub duration_s: f64,
}

/// Runs a plan to its end. Never panics, and never returns before securing was attempted.
///
/// The caller owns the bench on this thread. A dropped sender of `controls` is an orderly stop, because the run could
/// not be stopped otherwise. The recorder receives every state from `arming` to the final one; if it fails, the run
/// fails.
pub fn run(
    bench: &mut Bench,
    plan: &Plan,
    run: RunId,
    controls: &Receiver<Demand>,
    recorder: &mut dyn Recorder,
) -> RunEnd {
    let mut session = Session::new(bench, plan, run, controls, recorder);
    let ending = match session.caught(Session::execute) {
        Ok(()) => Ending::Completed,
        Err(ending) => ending,
    };
    session.finish(ending)
}

impl Session<'_> {
    fn execute(&mut self) -> Result<(), Ending> {
        self.enter(Transition::Arm)?;
        self.arm()?;
        self.enter(Transition::Start)?;
        self.run_steps()
    }

    fn finish(&mut self, mut ending: Ending) -> RunEnd {
        let now_s = self.bench.clock.now_s();
        self.journal.log(now_s, ending.event());
        // Rows that this commit cannot store are lost, so that the run is not complete.
        if let Err(unkept) = self.enter(Transition::Secure)
            && matches!(ending, Ending::Completed)
        {
            ending = unkept;
        }
        let notes = [self.skews.and_then(SkewRange::note), self.pose_deviation.map(PoseDeviation::note)];
        notes.into_iter().flatten().for_each(|note| self.note(note));
        if self.magnetised && !matches!(ending, Ending::Completed) {
            self.warn("the run magnetised the brake and ended early: demagnetise the brake before the next run");
        }
        let safe = self.make_safe(&ending);
        std::mem::take(&mut self.shaft).notes().into_iter().for_each(|note| self.note(note));
        let _stopped = self.caught(Session::stop_torque_stream);
        self.check_for_exchange(&mut ending);
        self.identify_again(&mut ending);
        let now_s = self.bench.clock.now_s();
        self.journal.log(now_s, Some(EventKind::Safe { safe }));
        if let Err(unkept) = self.end(&ending) {
            tracing::error!(run.id = self.journal.run, "the end of the run was not kept: {unkept}");
            if matches!(ending, Ending::Completed) {
                ending = unkept;
            }
        }
        let reason = ending.reason();
        let duration_s = self.bench.clock.now_s() - self.journal.started_s;
        let state = ending.outcome().state();
        tracing::info!(run.id = self.journal.run, %state, %safe, duration_s, reason, "run ended");
        RunEnd { state, safe, reason, rows: self.journal.kept_rows, duration_s }
    }
}
