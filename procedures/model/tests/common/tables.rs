//! Tables of all four kinds with the required columns only, as regular or broken as a test requires.

use jointbench_instrument::{Channel, Kind, Meta, RunTable, TableFault, Trace};

/// Properties of a table.
#[derive(Debug, Clone)]
pub struct Shape {
    pub rows: usize,
    /// Size of the first input (motor or shaft position, current).
    pub turn: f64,
    /// Size of the response.
    pub size: f64,
    /// Relative noise of both.
    pub noise: f64,
    pub mix: u64,
    /// Samples of one segment; no segment column if zero.
    pub segment: usize,
    pub repeats: usize,
}

impl Default for Shape {
    fn default() -> Self {
        Self { rows: 3000, turn: 5.0, size: 1.0, noise: 0.01, mix: 1, segment: 0, repeats: 1 }
    }
}

/// Pseudo-random numbers within ±0.5.
pub fn scatter(i: usize, mix: u64) -> f64 {
    ((i as u64 + 1 + mix.wrapping_mul(1_000_003)).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 40) as f64
        / (1u64 << 24) as f64
        - 0.5
}

pub fn table(kind: Kind, shape: &Shape) -> RunTable {
    try_table(kind, shape, |_, _, v| v).unwrap()
}

/// `spoil` changes the value of a column at a row.
pub fn try_table(kind: Kind, shape: &Shape, spoil: impl Fn(&str, usize, f64) -> f64) -> Result<RunTable, TableFault> {
    let mut names: Vec<&str> = kind.required_columns().to_vec();
    if shape.segment > 0 {
        names.push("segment");
    }
    if shape.repeats > 1 {
        names.push("repeat");
    }
    let mut trace = Trace::new(names.iter().map(|n| Channel::new(*n)).collect());
    for i in 0..shape.rows {
        let t = 0.004 * i as f64;
        let wave = |phase: f64| shape.turn * ((2.0 * t + phase).sin() + shape.noise * scatter(i, shape.mix));
        let row: Vec<f64> = names
            .iter()
            .map(|name| {
                let value = match *name {
                    "time_s" => t,
                    "motor_position_rad" if kind == Kind::Stiffness => {
                        50.0 * (wave(0.3) + 1e-3 * shape.size * (2.0 * t).sin())
                    }
                    "motor_position_rad" | "reference_position_rad" => wave(0.0),
                    "link_position_rad" => wave(0.3),
                    "test_position_rad" => wave(0.0) + 1e-3 * shape.size * (1.0 + scatter(i, shape.mix + 3)),
                    "brake_current_a" => (0.5 + 0.1 * wave(0.0)).abs(),
                    "segment" => (i / shape.segment.max(1)) as f64,
                    "repeat" => (i * shape.repeats / shape.rows) as f64,
                    _ => shape.size * ((2.0 * t).cos().signum() + shape.noise * scatter(i, shape.mix + 7)),
                };
                spoil(name, i, value)
            })
            .collect();
        trace.push_row(&row);
    }
    RunTable::new(meta(kind), trace)
}

/// An empty stiffness run with speed, segment and repeat columns.
pub fn stiffness() -> Trace {
    let names = "time_s motor_position_rad link_position_rad link_velocity_rad_s link_torque_nm segment repeat";
    Trace::new(names.split(' ').map(Channel::new).collect())
}

pub fn meta(kind: Kind) -> Meta {
    let baseline: &[&str] = match kind {
        Kind::Friction => &["coulomb", "viscous"],
        Kind::Encoder => &["offset"],
        Kind::Stiffness => &["offset", "compliance"],
        Kind::Brake => &["drag", "torque_per_current"],
    };
    Meta {
        kind: Some(kind),
        torque_constant_nm_per_a: Some(0.08),
        gear_ratio: Some(50.0),
        baseline: baseline.iter().map(|b| (*b).to_owned()).collect(),
        ..Meta::default()
    }
}

/// A row of [`friction_in_steps`].
pub struct Moment {
    pub row: usize,
    pub leg: usize,
    /// Angle of the motor [rad].
    pub angle: f64,
    pub velocity: f64,
    /// Time since the start of the step [s].
    pub step_s: f64,
}

/// Friction at motor speeds [rad/s] in both directions with repeats, each for a number of rows at 250 Hz, with a
/// given torque.
pub fn friction_in_steps(speeds: &[f64], repeats: usize, rows: usize, torque_nm: impl Fn(&Moment) -> f64) -> RunTable {
    const STEP_S: f64 = 0.004;
    let names = ["time_s", "motor_position_rad", "motor_velocity_rad_s", "motor_current_a", "segment", "repeat"];
    let mut trace = Trace::new(names.map(Channel::new).into());
    let mut angle = 0.0f64;
    for leg in 0..2 * repeats * speeds.len() {
        let velocity = if leg % 2 == 0 { 1.0 } else { -1.0 } * speeds[leg / 2 % speeds.len()];
        for i in 0..rows {
            angle += velocity * STEP_S;
            let now = Moment { row: leg * rows + i, leg, angle, velocity, step_s: i as f64 * STEP_S };
            let (segment, repeat) = (leg as f64, (leg / (2 * speeds.len())) as f64);
            trace.push_row(&[now.row as f64 * STEP_S, angle, velocity, torque_nm(&now), segment, repeat]);
        }
    }
    let mut meta = meta(Kind::Friction);
    meta.torque_constant_nm_per_a = Some(1.0);
    RunTable::new(meta, trace).unwrap()
}
