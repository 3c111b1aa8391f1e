//! Holds: rows with constant set-points, and means over their steady-state ends.

use jointbench_instrument::RunTable;
use jointbench_model::stats::summary::mean;
use std::ops::Range;

/// Consecutive rows of one step with one set-point of speed and one of the brake.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Hold {
    pub segment: i64,
    pub repeat: i64,
    pub rows: Range<usize>,
    /// Motor-side set-point.
    pub velocity_rad_s: f64,
    /// Brake command: a current in a brake run, otherwise the corresponding torque. 0 without a brake.
    pub brake: f64,
}

impl Hold {
    /// The mean of a column over the last `share` of the rows.
    pub fn mean(&self, column: &[f64], share: f64) -> f64 {
        let tail = self.tail(share);
        mean(&column[tail.clone()])
    }

    /// The last `share` of the rows, at least one.
    pub fn tail(&self, share: f64) -> Range<usize> {
        let rows = ((self.rows.len() as f64 * share) as usize).clamp(1, self.rows.len());
        self.rows.end - rows..self.rows.end
    }
}

/// Holds of at least `least_s`, in the order of the run.
pub(crate) fn holds(run: &RunTable, least_s: f64) -> Vec<Hold> {
    let time_s = run.column("time_s").unwrap_or_default();
    let zeros = vec![0.0; run.len()];
    let column = |names: &[&str]| names.iter().find_map(|name| run.column(name)).unwrap_or(&zeros);
    let segment = column(&["segment"]);
    let repeat = column(&["repeat"]);
    let velocity = column(&["velocity_setpoint_rad_s"]);
    let brake = column(&["brake_current_command_a", "brake_torque_command_nm"]);
    let mut holds = Vec::new();
    let mut start = 0;
    for row in 1..=run.len() {
        let key = |i: usize| (segment[i], velocity[i], brake[i]);
        if row < run.len() && key(row) == key(start) {
            continue;
        }
        if time_s[row - 1] - time_s[start] >= least_s {
            holds.push(Hold {
                segment: segment[start] as i64,
                repeat: repeat[start] as i64,
                rows: start..row,
                velocity_rad_s: velocity[start],
                brake: brake[start],
            });
        }
        start = row;
    }
    holds
}
