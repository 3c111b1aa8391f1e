//! What the server knows of a bench.

use super::health::Incoming;
use crate::store::RunCommit;
use crate::view::{BenchState, Blocked, Instrument, InstrumentFault, Progress};
use jiff::Timestamp;
use jointbench_instrument::limits::Limited;
use jointbench_instrument::{Fault, Trace};
use jointbench_procedure::{EventKind, RunId, RunState, Safe};
use std::collections::BTreeMap;

/// So many of the last faults of an instrument are told.
pub(super) const FAULTS: usize = 5;

/// A fault that a run has met.
pub(super) struct Met {
    pub at: Timestamp,
    pub fault: Fault,
    pub recovered: bool,
}

/// A fault that nobody knew of yet.
pub(super) struct New {
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
    /// The newest row of the run, against the limits.
    pub readings: Vec<(Limited, f64)>,
    pub channels: Vec<Incoming>,
    /// The worker has opened and secured the bench since it began, as far as that was possible.
    pub settled: bool,
    /// All instruments answered when they were opened.
    pub open: bool,
    /// Runs that are on, or of whose end the store does not know yet.
    pub runs: BTreeMap<RunId, Underway>,
    pub unstored: Unstored,
}

/// A run as its worker has told of it, which may be more than the store knows.
#[derive(Debug, Clone, PartialEq)]
pub struct Underway {
    pub state: RunState,
    pub safe: Option<Safe>,
    pub reason: Option<String>,
    /// The worker is through with it.
    pub ended: bool,
    /// The store has its end.
    pub stored: bool,
}

impl Underway {
    pub(super) fn queued() -> Self {
        Self { state: RunState::Queued, safe: None, reason: None, ended: false, stored: false }
    }

    /// Takes over what a commit says.
    pub(super) fn take_in(&mut self, commit: &RunCommit) {
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

/// What was measured and is not yet durable.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Unstored {
    pub rows: usize,
    /// Since when none of them was stored.
    pub since: Option<Timestamp>,
    /// Why nothing can be stored, or so slowly.
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

    /// The bench has nothing on: its state comes from its block and its instruments.
    pub(super) fn rest(&mut self) {
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

    /// What is known of a run whose end is not stored, where the store is in trouble; and why it is not stored.
    pub fn not_stored(&self, run: RunId) -> Option<(&Underway, &str)> {
        Some((self.runs.get(&run)?, self.unstored.fault.as_deref()?))
    }

    pub fn reading(&self, quantity: Limited) -> Option<f64> {
        self.readings.iter().find(|(limited, _)| *limited == quantity).map(|(_, value)| *value)
    }

    /// A run has met a fault of an instrument, which is not ready until it was tried again where it did not come back.
    pub(super) fn met(&mut self, Met { at, fault, recovered }: &Met) -> Option<New> {
        let instrument = self.instruments.iter_mut().find(|one| one.name == fault.instrument)?;
        if !recovered {
            instrument.ready = false;
            instrument.fault = Some(fault.to_string());
            instrument.since.get_or_insert_with(|| at.to_string());
        }
        Some(enter(instrument, *at, fault.to_string()))
    }

    /// The instruments as they were found by asking them. What was wrong before stays known; what is new is told.
    pub(super) fn found(&mut self, mut instruments: Vec<Instrument>) -> Vec<New> {
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

    /// The faults of the instruments, in one sentence.
    pub fn faults(&self) -> Option<String> {
        let faults: Vec<&str> = self.instruments.iter().filter_map(|i| i.fault.as_deref()).collect();
        (!faults.is_empty()).then(|| faults.join("; "))
    }
}

fn enter(instrument: &mut Instrument, at: Timestamp, text: String) -> New {
    let fault = InstrumentFault { at: format!("{at:.3}"), text };
    instrument.faults.insert(0, fault.clone());
    instrument.faults.truncate(FAULTS);
    New { instrument: instrument.name.clone(), fault }
}

/// The last row, as the limits see it.
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
