//! What the columns of a run mean to the models, and their values.

use jointbench_instrument::units::unit_of;
use std::collections::BTreeSet;
use std::sync::{Arc, Mutex, PoisonError};

/// What a signal means to the models, whatever its column is called.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Signal {
    /// Since the first sample [s].
    Time,
    /// Motor, reference encoder or brake shaft [rad].
    Position,
    /// The same [rad/s].
    Velocity,
    Acceleration,
    /// Change of the acceleration [rad/s³].
    Jerk,
    /// +1 or −1, the sign of the velocity, denoised.
    Direction,
    /// Link side [rad].
    Link,
    /// Friction: link torque on the motor side, τ_link/N [Nm]. Stiffness: link torque [Nm].
    Load,
    Temperature,
    /// Coil current of a brake [A].
    Current,
    /// Smooth estimate of the motor torque, made without the noise of the measured one [Nm].
    Drive,
    /// Number of the repeat, from 0.
    Repeat,
    /// A column that no effect of the library knows, by its name.
    Column(&'static str),
}

impl Signal {
    /// Those that the library knows.
    pub const ALL: [Signal; 12] = [
        Signal::Time,
        Signal::Position,
        Signal::Velocity,
        Signal::Acceleration,
        Signal::Jerk,
        Signal::Direction,
        Signal::Link,
        Signal::Load,
        Signal::Temperature,
        Signal::Current,
        Signal::Drive,
        Signal::Repeat,
    ];

    /// A column of a run that may be none that the library knows. Its name is kept for good, once: there are as many as
    /// people give to their columns.
    pub fn named(column: &str) -> Signal {
        static NAMES: Mutex<BTreeSet<&'static str>> = Mutex::new(BTreeSet::new());
        if let Some(known) = Signal::of_column(column) {
            return known;
        }
        let mut names = NAMES.lock().unwrap_or_else(PoisonError::into_inner);
        let known = names.get(column).copied();
        let name = known.unwrap_or_else(|| Box::leak(column.to_owned().into_boxed_str()));
        names.insert(name);
        Signal::Column(name)
    }

    /// The signal that a column of the run table becomes, where the library knows it.
    pub fn of_column(column: &str) -> Option<Signal> {
        Some(match column {
            "time_s" => Signal::Time,
            "motor_position_rad" | "reference_position_rad" | "position_rad" => Signal::Position,
            "motor_velocity_rad_s" | "velocity_rad_s" | "link_velocity_rad_s" => Signal::Velocity,
            "link_position_rad" => Signal::Link,
            "link_torque_nm" => Signal::Load,
            "temperature_c" => Signal::Temperature,
            "brake_current_a" => Signal::Current,
            "repeat" => Signal::Repeat,
            _ => return None,
        })
    }
}

/// Signals of equal length. A copy shares them.
#[derive(Debug, Clone, Default)]
pub struct Signals {
    columns: Vec<(Signal, Arc<Vec<f64>>)>,
    len: usize,
}

impl Signals {
    pub fn new(len: usize) -> Self {
        Self { columns: Vec::new(), len }
    }

    pub fn len(&self) -> usize {
        self.len
    }

    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    pub fn set(&mut self, signal: Signal, values: Vec<f64>) {
        debug_assert_eq!(values.len(), self.len);
        self.columns.retain(|(known, _)| *known != signal);
        self.columns.push((signal, Arc::new(values)));
    }

    pub fn find(&self, signal: Signal) -> Option<&[f64]> {
        self.iter().find(|(known, _)| *known == signal).map(|(_, values)| values)
    }

    pub fn iter(&self) -> impl Iterator<Item = (Signal, &[f64])> {
        self.columns.iter().map(|(signal, values)| (*signal, values.as_slice()))
    }

    /// Columns that no effect knows, and on which what is left may depend.
    pub fn unknown(&self) -> impl Iterator<Item = Signal> {
        self.iter().map(|(signal, _)| signal).filter(|s| matches!(s, Signal::Column(column) if may_cause(column)))
    }
}

/// What is told in these units follows from the torque and does not cause it, is motion, which known columns tell, or a
/// clock. Over the drive's own effort every scatter of the torque shows.
const NO_CAUSE: [&str; 9] = ["Nm", "A", "V", "W", "rad", "rad/s", "rad/s²", "s", "ms"];

/// Where a stage stood: set from outside, and no motion of the joint.
pub fn is_pose(column: &str) -> bool {
    column.starts_with("stage_")
}

/// What is left may depend on a column of this name. Not on one without a unit: it may be the response under another
/// name.
pub fn may_cause(column: &str) -> bool {
    is_pose(column) || unit_of(column).is_some_and(|unit| !NO_CAUSE.contains(&unit))
}
