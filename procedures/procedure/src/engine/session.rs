//! The state of one run.

use super::ask::{RequestFault, ask};
use super::deferred_steps::DeferredSteps;
use super::ending::Ending;
use super::journal::Journal;
use super::pose_deviation::PoseDeviation;
use super::remaining_time::RemainingTime;
use super::shaft::Shaft;
use super::skew::SkewRange;
use crate::columns::Columns;
use crate::event::{Demand, EventKind};
use crate::guard::Guard;
use crate::plan::Plan;
use crate::recorder::{Recorder, RunId};
use crate::state::Transition;
use crate::steady::SteadyDetector;
use jointbench_instrument::roles::{
    CurrentSource, Instrument, JointController, JointReading, Pose, Thermometer, TorqueSensor,
};
use jointbench_instrument::units::Seconds;
use jointbench_instrument::{Bench, Fault};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::Receiver;

/// Largest number of link recoveries in one step; more of them end the run.
pub(super) const RECOVERIES_PER_STEP: u32 = 3;

pub(super) struct Session<'a> {
    pub bench: &'a mut Bench,
    pub plan: &'a Plan,
    pub journal: Journal<'a>,
    pub controls: &'a Receiver<Demand>,
    pub guard: Guard,
    pub remaining_time: RemainingTime,
    pub warm: Option<SteadyDetector>,
    /// Set at arming, when the measurable quantities of the bench are known.
    pub columns: Option<Columns>,
    pub commanded: Commanded,
    pub held: HeldReadings,
    /// Latest reading of the thermometer, in the channel order of the bench description; empty without one.
    pub thermometer_c: Vec<f64>,
    pub thermometer_at_s: f64,
    pub thermometer_next_s: f64,
    pub period: Period,
    pub pending_request: Option<PendingRequest>,
    /// Whether the drive may apply torque, so that securing has to ramp it down.
    pub armed: bool,
    /// A step has magnetised the brake at standstill, for a later one to demagnetise it.
    pub magnetised: bool,
    /// Latest reading of the joint.
    pub joint: Option<JointReading>,
    /// Motor position at the start of the warm-up.
    pub warm_from_rad: Option<f64>,
    /// Latest reading of the torque sensor.
    pub link_torque_nm: Option<f64>,
    pub skews: Option<SkewRange>,
    /// Positions of one shaft from several instruments.
    pub shaft: Shaft,
    /// Set while the torque sensor streams.
    pub torque_stream: Option<TorqueStream>,
    /// Time of the latest row, which the next one has to exceed.
    pub row_s: f64,
    pub next_segment: u32,
    pub failed: FailedInstruments,
    /// Commanded pose of the stage, for a plan that moves it.
    pub pose: Option<Pose>,
    pub pose_deviation: Option<PoseDeviation>,
    pub deferred: DeferredSteps,
    /// Whether the encoder under test was consistent since this was last set.
    pub consistent: bool,
    /// Repeated requests in this step.
    pub recoveries: u32,
}

/// The latest commands to the instruments.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Commanded {
    /// Set-point of the velocity loop; without one, the speed from which it would have to start.
    pub velocity_rad_s: f64,
    /// Motor current, alone or as feedforward.
    pub motor_current_a: f64,
    pub brake_a: f64,
    pub brake_at_s: f64,
}

/// Command to the drive in one tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum DriveCommand {
    /// A velocity with a feedforward of motor current.
    Velocity { rad_s: f64, feedforward_a: f64 },
    /// A motor current alone.
    Current { a: f64 },
}

/// Command to the brake in one tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct BrakeCommand {
    pub a: f64,
    /// The current may fall at standstill.
    pub magnetises: bool,
}

impl From<f64> for BrakeCommand {
    /// A current that the guard protects from a fall at standstill.
    fn from(a: f64) -> Self {
        Self { a, magnetises: false }
    }
}

/// The brake current with the time of its measurement.
#[derive(Debug, Clone, Copy)]
pub(super) struct BrakeCurrent {
    pub a: f64,
    pub at_s: f64,
}

/// Slow readings that are held between updates.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct HeldReadings {
    pub temperature_c: Option<f64>,
    pub brake: Option<BrakeCurrent>,
    pub next_s: f64,
    pub brake_next_s: f64,
    /// Time since which every reading found the supply unable to hold the commanded current.
    pub unregulated_since_s: Option<f64>,
}

/// The control period.
#[derive(Debug, Clone, Copy)]
pub(super) struct Period {
    pub duration_s: f64,
    pub next_s: f64,
    pub late_ticks: u64,
}

/// Instruments that failed permanently: they are not read while the joint stops.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct FailedInstruments {
    pub sensor: bool,
    pub brake: bool,
    pub thermometer: bool,
}

/// Statistics of the torque stream.
#[derive(Debug, Clone, Copy)]
pub(super) struct TorqueStream {
    pub period: Seconds,
    pub samples: u64,
    pub missing: u64,
}

/// A request of a person that a step cannot perform by itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum PendingRequest {
    Pause,
    Resume,
}

impl<'a> Session<'a> {
    pub fn new(
        bench: &'a mut Bench,
        plan: &'a Plan,
        run: RunId,
        controls: &'a Receiver<Demand>,
        recorder: &'a mut dyn Recorder,
    ) -> Self {
        let now_s = bench.clock.now_s();
        Self {
            plan,
            journal: Journal::new(run, now_s, recorder),
            controls,
            guard: Guard::new(bench.limits, bench.torsion, bench.constants),
            remaining_time: RemainingTime::new(plan),
            warm: plan.steady.map(SteadyDetector::new),
            columns: None,
            commanded: Commanded::default(),
            held: HeldReadings::default(),
            thermometer_c: Vec::new(),
            thermometer_at_s: now_s,
            thermometer_next_s: now_s,
            period: Period { duration_s: 1.0 / plan.rate_hz, next_s: now_s, late_ticks: 0 },
            pending_request: None,
            armed: false,
            magnetised: false,
            joint: None,
            warm_from_rad: None,
            link_torque_nm: None,
            skews: None,
            shaft: Shaft::default(),
            torque_stream: None,
            row_s: f64::NEG_INFINITY,
            next_segment: plan.steps.iter().map(|step| step.segment + 1).max().unwrap_or(0),
            failed: FailedInstruments::default(),
            pose: None,
            pose_deviation: None,
            deferred: DeferredSteps::default(),
            consistent: true,
            recoveries: 0,
            bench,
        }
    }

    pub fn enter(&mut self, transition: Transition) -> Result<(), Ending> {
        self.journal.enter(self.bench.clock.now_s(), transition, None)
    }

    /// The final state with its reason.
    pub fn end(&mut self, ending: &Ending) -> Result<(), Ending> {
        self.journal.enter(self.bench.clock.now_s(), Transition::End(ending.outcome()), ending.reason())
    }

    pub fn note(&mut self, text: impl Into<String>) {
        let now_s = self.bench.clock.now_s();
        self.journal.log(now_s, EventKind::Note { text: text.into() });
    }

    /// Reports that a precondition of the result is violated.
    pub fn warn(&mut self, text: impl Into<String>) {
        let now_s = self.bench.clock.now_s();
        self.journal.log(now_s, EventKind::Warning { text: text.into() });
    }

    /// Work that may panic: afterwards only securing uses this state, and it verifies everything.
    pub fn caught(&mut self, work: impl FnOnce(&mut Self) -> Result<(), Ending>) -> Result<(), Ending> {
        catch_unwind(AssertUnwindSafe(|| work(self))).unwrap_or_else(|panic| Err(Ending::Panicked(panic_text(&*panic))))
    }

    pub fn ask_joint<T>(
        &mut self,
        request: impl FnMut(&mut (dyn JointController + 'static)) -> Result<T, Fault>,
    ) -> Result<T, Ending> {
        let now_s = self.bench.clock.now_s();
        let Self { bench, journal, recoveries, .. } = self;
        ask(bench.joint.as_mut(), request, |fault| log(journal, recoveries, now_s, fault)).map_err(Ending::JointFault)
    }

    /// `None` if the bench has no brake.
    pub fn ask_brake<T>(
        &mut self,
        request: impl FnMut(&mut (dyn CurrentSource + 'static)) -> Result<T, Fault>,
    ) -> Result<Option<T>, Ending> {
        let now_s = self.bench.clock.now_s();
        let Self { bench, journal, recoveries, failed, .. } = self;
        let Some(brake) = &mut bench.brake else { return Ok(None) };
        ask(brake.as_mut(), request, |fault| log(journal, recoveries, now_s, fault)).map(Some).map_err(|fault| {
            failed.brake = true;
            Ending::OtherFault(fault)
        })
    }

    /// `None` if the bench has no torque sensor.
    pub fn ask_torque_sensor<T>(
        &mut self,
        request: impl FnMut(&mut (dyn TorqueSensor + 'static)) -> Result<T, Fault>,
    ) -> Result<Option<T>, Ending> {
        let now_s = self.bench.clock.now_s();
        let Self { bench, journal, recoveries, failed, .. } = self;
        let Some(sensor) = &mut bench.torque_sensor else { return Ok(None) };
        ask(sensor.as_mut(), request, |fault| log(journal, recoveries, now_s, fault)).map(Some).map_err(|fault| {
            failed.sensor = true;
            Ending::OtherFault(fault)
        })
    }

    /// `None` if the bench has no thermometer.
    pub fn ask_thermometer<T>(
        &mut self,
        request: impl FnMut(&mut (dyn Thermometer + 'static)) -> Result<T, Fault>,
    ) -> Result<Option<T>, Ending> {
        let now_s = self.bench.clock.now_s();
        let Self { bench, journal, recoveries, failed, .. } = self;
        let Some(thermometer) = &mut bench.thermometer else { return Ok(None) };
        ask(thermometer.as_mut(), request, |fault| log(journal, recoveries, now_s, fault)).map(Some).map_err(|fault| {
            failed.thermometer = true;
            Ending::OtherFault(fault)
        })
    }
}

pub(super) fn log(journal: &mut Journal<'_>, recoveries: &mut u32, now_s: f64, fault: RequestFault) {
    *recoveries += u32::from(fault.recovered);
    journal.log(now_s, EventKind::Fault { fault: fault.fault, recovered: fault.recovered });
}

pub(super) fn panic_text(panic: &(dyn std::any::Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
    text.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_else(|| "a panic without a message".to_owned())
}

/// Name and port of an instrument, for a fault that the engine itself detects.
pub(super) fn reported<I: Instrument + ?Sized>(instrument: &I, what: impl Into<String>) -> Fault {
    jointbench_instrument::FaultKind::Reported { what: what.into() }.at(instrument.name(), instrument.port())
}
