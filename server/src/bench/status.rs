//! State of a bench as known to the server.

use super::health::ChannelInput;
use crate::store::RunCommit;
use crate::view::{BenchState, Blocked, Instrument, InstrumentFault, Progress};
use jiff::Timestamp;
use jointbench_instrument::limits::Limited;
use jointbench_instrument::{Fault, Trace};
use jointbench_procedure::{EventKind, RunId, RunState, Safe};
use std::collections::BTreeMap;

/// Number of the last faults that are shown for an instrument.
pub(super) const FAULTS: usize = 5;

/// A fault during a run.
pub(super) struct RunFault {
    pub at: Timestamp,
    pub fault: Fault,
    pub recovered: bool,
}

/// A fault that is not yet recorded.
pub(super) struct NewFault {
    pub instrument: String,
    pub fault: InstrumentFault,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Status {
    pub state: BenchState,
    pub run: Option<i64>,
    pub progress: Option<Progress>,
    pub instruments: Vec<Instrument>,
    pub blocked: Option<Blocked>,
    /// The newest row of the run, for comparison with the limits.
    pub readings: Vec<(Limited, f64)>,
    pub channels: Vec<ChannelInput>,
    /// Whether the worker has tried to open and secure the bench since its start.
    pub settled: bool,
    /// Whether all instruments answered when they were opened.
    pub open: bool,
    /// Runs that are active or whose end is not stored.
    pub runs: BTreeMap<RunId, ActiveRun>,
    pub unstored: Unstored,
}

/// State of a run as reported by its worker. It may be newer than the state in the store.
#[derive(Debug, Clone, PartialEq)]
pub struct ActiveRun {
    pub state: RunState,
    pub safe: Option<Safe>,
    pub reason: Option<String>,
    /// The worker has finished the run.
    pub ended: bool,
    /// The end is stored.
    pub stored: bool,
}

impl ActiveRun {
    pub(super) fn queued() -> Self {
        Self { state: RunState::Queued, safe: None, reason: None, ended: false, stored: false }
    }

    /// Updates the state from a commit.
    pub(super) fn apply(&mut self, commit: &RunCommit) {
        self.state = commit.state;
        for event in &commit.events {
            match &event.kind {
                EventKind::Safe { safe } => self.safe = Some(*safe),
                EventKind::State { reason: Some(reason), .. } => self.reason = Some(reason.clone()),
                _ => {}
            }
        }
    }
}

/// Data that is measured but not yet durable.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Unstored {
    pub rows: usize,
    /// Start of the time in which none of them was stored.
    pub since: Option<Timestamp>,
    /// Why storing fails or is slow.
    pub fault: Option<String>,
}

impl Status {
    pub fn offline() -> Self {
        Self {
            state: BenchState::Offline,
            run: None,
            progress: None,
            instruments: Vec::new(),
            blocked: None,
            readings: Vec::new(),
            channels: Vec::new(),
            settled: false,
            open: false,
            runs: BTreeMap::new(),
            unstored: Unstored::default(),
        }
    }

    /// The bench belongs to a run from now on, although its worker has not begun it yet.
    pub(super) fn begin(&mut self, run: RunId) {
        self.runs.insert(run, ActiveRun::queued());
        self.run = Some(run);
        self.state = BenchState::Running;
    }

    /// Sets the state of an idle bench from its block and its instruments.
    pub(super) fn set_idle(&mut self) {
        self.state = match &self.blocked {
            Some(blocked) if blocked.stopped => BenchState::Stopped,
            Some(_) => BenchState::Fault,
            None if !self.open => BenchState::Offline,
            None if self.faults().is_some() => BenchState::Fault,
            None => BenchState::Idle,
        };
        self.run = None;
        self.progress = None;
        self.readings.clear();
    }

    /// State of a run whose end is not stored because of a storage fault, and that fault.
    pub fn not_stored(&self, run: RunId) -> Option<(&ActiveRun, &str)> {
        Some((self.runs.get(&run)?, self.unstored.fault.as_deref()?))
    }

    pub fn reading(&self, quantity: Limited) -> Option<f64> {
        self.readings.iter().find(|(limited, _)| *limited == quantity).map(|(_, value)| *value)
    }

    /// Records a fault during a run. An instrument that did not recover is not ready until the next attempt.
    pub(super) fn record_fault(&mut self, RunFault { at, fault, recovered }: &RunFault) -> Option<NewFault> {
        let instrument = self.instruments.iter_mut().find(|one| one.name == fault.instrument)?;
        if !recovered {
            instrument.ready = false;
            instrument.fault = Some(fault.to_string());
            instrument.since.get_or_insert_with(|| at.to_string());
        }
        Some(enter(instrument, *at, fault.to_string()))
    }

    /// Replaces the instruments by their new state. Keeps earlier faults and returns the new ones.
    pub(super) fn found(&mut self, mut instruments: Vec<Instrument>) -> Vec<NewFault> {
        let mut new = Vec::new();
        for instrument in &mut instruments {
            let before = self.instruments.iter().find(|before| before.role == instrument.role);
            if let Some(before) = before {
                instrument.faults = before.faults.clone();
            }
            let Some(fault) = instrument.fault.clone() else { continue };
            if let Some(since) = before.and_then(|before| before.since.clone()) {
                instrument.since = Some(since);
            }
            if before.is_none_or(|before| before.fault.as_ref() != Some(&fault)) {
                new.push(enter(instrument, Timestamp::now(), fault));
            }
        }
        self.instruments = instruments;
        new
    }

    pub fn faults(&self) -> Option<String> {
        let faults: Vec<&str> = self.instruments.iter().filter_map(|i| i.fault.as_deref()).collect();
        (!faults.is_empty()).then(|| faults.join("; "))
    }
}

fn enter(instrument: &mut Instrument, at: Timestamp, text: String) -> NewFault {
    let fault = InstrumentFault { at: format!("{at:.3}"), text };
    instrument.faults.insert(0, fault.clone());
    instrument.faults.truncate(FAULTS);
    NewFault { instrument: instrument.name.clone(), fault }
}

/// Values of the last row for comparison with the limits.
pub(super) fn readings(rows: &Trace, gear_ratio: f64) -> Vec<(Limited, f64)> {
    let last = |name: &str| rows.column(name).and_then(|column| column.last().copied());
    let velocity = last("motor_velocity_rad_s");
    let torque = last("link_torque_nm");
    let power = velocity.zip(torque).map(|(velocity, torque)| (torque * velocity / gear_ratio).abs());
    [
        (Limited::MotorVelocity, velocity.map(f64::abs)),
        (Limited::MotorCurrent, last("motor_current_a").map(f64::abs)),
        (Limited::LinkTorque, torque.map(f64::abs)),
        (Limited::Temperature, last("temperature_c")),
        (Limited::BrakeCurrent, last("brake_current_a").map(f64::abs)),
        (Limited::BrakePower, power),
    ]
    .into_iter()
    .filter_map(|(limited, value)| Some((limited, value.filter(|v| v.is_finite())?)))
    .collect()
}
