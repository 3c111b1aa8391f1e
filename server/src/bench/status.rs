//! What a bench thread tells of itself.

use crate::view::{BenchState, Blocked, Instrument, Progress};
use jiff::Timestamp;
use jointbench_instrument::limits::Limited;
use jointbench_instrument::{Fault, Trace};

#[derive(Debug, Clone, PartialEq)]
pub struct Status {
    pub state: BenchState,
    pub run: Option<i64>,
    pub progress: Option<Progress>,
    pub instruments: Vec<Instrument>,
    pub blocked: Option<Blocked>,
    /// The newest row of the run, against the limits.
    pub readings: Vec<(Limited, f64)>,
    /// The thread has opened and secured the bench since it began, as far as that was possible.
    pub settled: bool,
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
            settled: false,
        }
    }

    pub fn reading(&self, quantity: Limited) -> Option<f64> {
        self.readings.iter().find(|(limited, _)| *limited == quantity).map(|(_, value)| *value)
    }

    /// A run has ended with a fault of an instrument, which is not ready until it was tried again.
    pub(super) fn found_wanting(&mut self, fault: &Fault) {
        if let Some(instrument) = self.instruments.iter_mut().find(|one| one.name == fault.instrument) {
            instrument.ready = false;
            instrument.fault = Some(fault.to_string());
            instrument.since.get_or_insert_with(|| Timestamp::now().to_string());
        }
    }

    /// The faults of the instruments, in one sentence.
    pub fn faults(&self) -> Option<String> {
        let faults: Vec<&str> = self.instruments.iter().filter_map(|i| i.fault.as_deref()).collect();
        (!faults.is_empty()).then(|| faults.join("; "))
    }
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
