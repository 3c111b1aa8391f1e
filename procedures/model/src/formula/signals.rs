//! The signals of each kind of run, with their names in formulas.

use crate::signal::{Signal, may_cause};
use jointbench_instrument::Kind;
use jointbench_instrument::units::{quantity_of, unit_of};

/// Function name for a column of the run that is no signal.
pub const COLUMN: &str = "column";

/// A signal in a formula.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NamedSignal {
    /// Name in a formula: `velocity`.
    pub name: &'static str,
    /// The signal of the model.
    pub signal: Signal,
    /// SI unit for a rotating joint, `1` if dimensionless.
    pub unit: &'static str,
    /// Its source column; empty for a derived signal.
    pub column: &'static str,
    /// Description in a few words, with the side of the gear or the sign where it matters.
    pub meaning: &'static str,
}

const fn named(
    name: &'static str,
    signal: Signal,
    unit: &'static str,
    column: &'static str,
    meaning: &'static str,
) -> NamedSignal {
    NamedSignal { name, signal, unit, column, meaning }
}

impl NamedSignal {
    /// A column that is no signal of the kind, with its own name and unit.
    pub(crate) fn of_column(column: &'static str) -> Self {
        named(column, Signal::Column(column), unit_of(column).unwrap_or("1"), column, "a column of the run")
    }
}

const TIME: NamedSignal = named("time", Signal::Time, "s", "time_s", "time since the first sample");
const TEMPERATURE: NamedSignal = named("temperature", Signal::Temperature, "°C", "temperature_c", "temperature");
const DIRECTION: NamedSignal = named("direction", Signal::Direction, "1", "", "+1 or −1, sign of the velocity");

const FRICTION: &[NamedSignal] = &[
    TIME,
    named("position", Signal::Position, "rad", "motor_position_rad", "motor position, counted over turns"),
    named("velocity", Signal::Velocity, "rad/s", "motor_velocity_rad_s", "motor velocity"),
    named("acceleration", Signal::Acceleration, "rad/s²", "", "motor acceleration"),
    named("jerk", Signal::Jerk, "rad/s³", "", "change of the acceleration"),
    DIRECTION,
    named("link_position", Signal::Link, "rad", "link_position_rad", "link position, counted over turns"),
    named("load", Signal::Load, "Nm", "link_torque_nm", "link torque on the motor side, divided by the gear ratio"),
    TEMPERATURE,
    named("motor_torque", Signal::Drive, "Nm", "", "smooth estimate of the motor torque"),
];
const ENCODER: &[NamedSignal] = &[
    TIME,
    named("position", Signal::Position, "rad", "reference_position_rad", "reference position, counted over turns"),
    named("velocity", Signal::Velocity, "rad/s", "velocity_rad_s", "velocity"),
    DIRECTION,
    TEMPERATURE,
];
const STIFFNESS: &[NamedSignal] = &[
    TIME,
    named("position", Signal::Position, "rad", "motor_position_rad", "motor position, counted over turns"),
    named("link_position", Signal::Link, "rad", "link_position_rad", "link position, counted over turns"),
    named("velocity", Signal::Velocity, "rad/s", "link_velocity_rad_s", "link velocity"),
    DIRECTION,
    named("load", Signal::Load, "Nm", "link_torque_nm", "link torque"),
    TEMPERATURE,
];
const BRAKE: &[NamedSignal] = &[
    TIME,
    named("current", Signal::Current, "A", "brake_current_a", "coil current"),
    named("velocity", Signal::Velocity, "rad/s", "velocity_rad_s", "shaft velocity"),
    named("position", Signal::Position, "rad", "position_rad", "shaft position, counted over turns"),
    named("direction", Signal::Direction, "1", "", "+1 where the current rises, −1 where it falls"),
    TEMPERATURE,
];

/// Signals of a kind that a formula may use.
pub fn signals(kind: Kind) -> &'static [NamedSignal] {
    match kind {
        Kind::Friction => FRICTION,
        Kind::Encoder => ENCODER,
        Kind::Stiffness => STIFFNESS,
        Kind::Brake => BRAKE,
    }
}

/// Formula name of a column or of a residual-map axis. `None` if a formula cannot use it.
pub fn in_formula(kind: Kind, column: &str) -> Option<String> {
    let quantity = quantity_of(column).unwrap_or(column);
    let signal = signals(kind).iter().find(|s| s.column == column || s.name == quantity);
    signal.map(|s| s.name.to_owned()).or_else(|| may_cause(column).then(|| format!("{COLUMN}({column})")))
}

/// The left-hand side of a formula: the response of the kind.
pub fn left_hand_side(kind: Kind) -> &'static str {
    match kind {
        Kind::Friction | Kind::Brake => "tau",
        Kind::Encoder => "error",
        Kind::Stiffness => "torsion",
    }
}
