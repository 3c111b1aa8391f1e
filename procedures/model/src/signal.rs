//! Signals: the meaning of a run's columns for the models, and their values.

use jointbench_instrument::units::unit_of;
use std::collections::BTreeSet;
use std::sync::{Arc, Mutex, PoisonError};

/// Meaning of a signal for the models, independent of its column name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Signal {
    /// Time since the first sample [s].
    Time,
    /// Motor, reference encoder or brake shaft [rad].
    Position,
    /// Velocity of the same shaft [rad/s].
    Velocity,
    /// Acceleration of the same shaft [rad/s²].
    Acceleration,
    /// Derivative of the acceleration [rad/s³].
    Jerk,
    /// +1 or −1, the denoised sign of the velocity.
    Direction,
    /// Link side [rad].
    Link,
    /// Friction: link torque on the motor side, τ_link/N [Nm]. Stiffness: link torque [Nm].
    Load,
    /// Temperature of the joint, encoder or brake [°C].
    Temperature,
    /// Coil current of a brake [A].
    Current,
    /// Smooth estimate of the motor torque without the noise of the measured one [Nm].
    Drive,
    /// Number of the repeat, from 0.
    Repeat,
    /// A column that no effect of the library uses, by its name.
    Column(&'static str),
}

impl Signal {
    /// The signals of the library.
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

    /// A column of a run that the library may not contain. Each name is stored once and never freed: the number of
    /// names is limited by the columns of users.
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

    /// The signal of a run-table column, if the library contains it.
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

/// Signals of equal length. Copies share the data.
#[derive(Debug, Clone, Default)]
pub struct Signals {
    columns: Vec<(Signal, Arc<Vec<f64>>)>,
    len: usize,
}

impl Signals {
    /// No signals yet, for `len` values each.
    pub fn new(len: usize) -> Self {
        Self { columns: Vec::new(), len }
    }

    /// Number of values of each signal.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether the signals have no values.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Sets or replaces a signal. `values` has [`Signals::len`] entries.
    pub fn set(&mut self, signal: Signal, values: Vec<f64>) {
        debug_assert_eq!(values.len(), self.len);
        self.columns.retain(|(known, _)| *known != signal);
        self.columns.push((signal, Arc::new(values)));
    }

    /// Values of a signal. `None` if it is missing.
    pub fn find(&self, signal: Signal) -> Option<&[f64]> {
        self.iter().find(|(known, _)| *known == signal).map(|(_, values)| values)
    }

    /// All signals with their values, in the order in which they were set.
    pub fn iter(&self) -> impl Iterator<Item = (Signal, &[f64])> {
        self.columns.iter().map(|(signal, values)| (*signal, values.as_slice()))
    }

    /// Columns that no effect uses and that the residual may depend on.
    pub fn unknown(&self) -> impl Iterator<Item = Signal> {
        self.iter().map(|(signal, _)| signal).filter(|s| matches!(s, Signal::Column(column) if may_cause(column)))
    }
}

/// Units of quantities that do not cause the torque: they follow from the torque, describe motion that known columns
/// already contain, or are a clock. Any scatter of the torque would depend on the drive's own effort.
const NO_CAUSE: [&str; 9] = ["Nm", "A", "V", "W", "rad", "rad/s", "rad/s²", "s", "ms"];

/// Position of a stage: set from outside, no motion of the joint.
pub(crate) fn is_pose(column: &str) -> bool {
    column.starts_with("stage_")
}

/// Whether the residual may depend on a column of this name. A column without a unit is excluded, because it may be
/// the response under another name.
pub(crate) fn may_cause(column: &str) -> bool {
    is_pose(column) || unit_of(column).is_some_and(|unit| !NO_CAUSE.contains(&unit))
}
