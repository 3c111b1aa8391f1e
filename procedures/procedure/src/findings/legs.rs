//! The steps of a run as ranges of its table, and tables of some of them.

use jointbench_instrument::{RunTable, TableFault, Trace};
use std::ops::Range;

/// One attempt at a step: consecutive rows with one segment number.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Leg {
    pub segment: i64,
    pub rows: Range<usize>,
    /// +1 or −1, the direction of the motor; 0 if it ended at its start.
    pub direction: f64,
    /// Commanded brake torque if it was constant, and `None` if it changed. 0 without a brake.
    pub brake_nm: Option<f64>,
}

/// Every leg of a run with segment numbers.
pub(crate) fn legs(run: &RunTable) -> Vec<Leg> {
    let segment = run.column("segment").unwrap_or_default();
    let position = run.column("motor_position_rad");
    let brake = run.column("brake_torque_command_nm");
    let mut legs = Vec::new();
    for rows in segment.chunk_by(|a, b| a == b).scan(0, |start, chunk| {
        *start += chunk.len();
        Some(*start - chunk.len()..*start)
    }) {
        let way = position.map_or(0.0, |q| q[rows.end - 1] - q[rows.start]);
        let brake_nm = brake.map_or(Some(0.0), |nm| {
            let nm = &nm[rows.clone()];
            // The first command of a step reaches the supply a moment after the start of the step.
            nm[nm.len() / 4..].iter().all(|v| *v == nm[nm.len() - 1]).then(|| nm[nm.len() - 1])
        });
        let direction = if way == 0.0 { 0.0 } else { way.signum() };
        legs.push(Leg { segment: segment[rows.start] as i64, rows, direction, brake_nm });
    }
    legs
}

/// The table of some legs only.
pub(crate) fn select_legs<'a>(run: &RunTable, legs: impl IntoIterator<Item = &'a Leg>) -> Result<RunTable, TableFault> {
    select_rows(run, &legs.into_iter().map(|leg| leg.rows.clone()).collect::<Vec<_>>())
}

/// The table of some ranges only, in their order.
pub(crate) fn select_rows(run: &RunTable, rows: &[Range<usize>]) -> Result<RunTable, TableFault> {
    let column = |all: &Vec<f64>| rows.iter().flat_map(|rows| &all[rows.clone()]).copied().collect();
    let columns = run.trace().columns().iter().map(column).collect();
    RunTable::new(run.meta().clone(), Trace::from_columns(run.trace().channels().to_vec(), columns))
}
