//! Ramps of motor current from rest at several positions: their steps, and the rows at which the joint moved.

use crate::bench_facts::BenchFacts;
use crate::catalogue::legs::{Legs, stroke};
use crate::parameter::Values;
use crate::plan::{Drive, EndCondition};
use crate::profile::Profile;
use jointbench_instrument::RunTable;
use std::ops::Range;

/// Rest without torque between the approach and a motor current (s; chosen).
pub(in crate::catalogue) const REST_S: f64 = 0.4;
/// Highest motor speed after the breakaway, at which the velocity loop takes over (chosen).
pub(in crate::catalogue) const RUNAWAY_RAD_S: f64 = 10.0;

/// Ramps in both directions. Each position is one step that includes the approach: the joint always arrives in the
/// direction in which it will break away.
pub(in crate::catalogue) struct Ramps {
    pub positions: u32,
    /// Arc of the positions (link).
    pub arc_rad: f64,
    /// Approach speed (motor).
    pub speed_rad_s: f64,
    pub top_a: f64,
    pub ramp_s: f64,
    pub until: EndCondition,
}

impl Ramps {
    pub fn plan(&self, legs: &mut Legs, bench: &BenchFacts) {
        let arc_rad = self.arc_rad * bench.constants.gear_ratio;
        let stretch_rad = arc_rad / f64::from(self.positions);
        let stroke = |way_rad: f64, legs: &Legs| stroke(way_rad, self.speed_rad_s, legs.acceleration_rad_s2);
        if bench.constants.link_range_rad.is_some_and(|range_rad| range_rad < std::f64::consts::TAU) {
            // A whole turn does not fit in the range: the arc is centred on the initial pose.
            legs.push("to the start of the arc".into(), stroke(-0.5 * arc_rad, legs), Profile::constant(0.0));
        }
        for (repeat, sign) in [(0, 1.0), (1, -1.0)] {
            legs.repeat = repeat;
            for position in 1..=self.positions {
                let velocity = stroke(sign * stretch_rad, legs);
                let from_s = velocity.duration_s() + REST_S;
                let current_a = Profile::from(0.0).hold(REST_S).to(sign * self.top_a, self.ramp_s);
                let way = if sign > 0.0 { "forward" } else { "backward" };
                let label = format!("breakaway {way}, {position} of {}", self.positions);
                legs.push(label, velocity, Profile::constant(0.0));
                legs.drive_of_last(Drive::Current { from_s, current_a, until: self.until });
            }
        }
        // The velocity loop stops the joint after the last breakaway before the run ends.
        legs.push("rest".into(), Profile::from(0.0).hold(REST_S), Profile::constant(0.0));
    }
}

/// The rows of every step whose last row has a motor current.
pub(in crate::catalogue) fn ramps(run: &RunTable, setpoint_a: &[f64]) -> Vec<Range<usize>> {
    let (mut ramps, mut start) = (Vec::new(), 0);
    for rows in run.column("segment").unwrap_or_default().chunk_by(|a, b| a == b) {
        let end = start + rows.len();
        if setpoint_a[end - 1] != 0.0 {
            ramps.push(start..end);
        }
        start = end;
    }
    ramps
}

/// Whether a ramp reached `top_a`, so that the joint did not move before.
pub(in crate::catalogue) fn is_held(ramp: &Range<usize>, setpoint_a: &[f64], top_a: f64) -> bool {
    setpoint_a[ramp.end - 1].abs() > 0.999 * top_a
}

/// Position at which a ramp of motor current moved the joint.
pub(in crate::catalogue) struct Onset {
    /// First row of the consecutive increases, and the end of the ramp's rows.
    pub row: usize,
    pub end: usize,
    pub current_a: f64,
}

/// The ramps that ended with motion of the joint, and the number of ramps that reached `top_a` without motion. A ramp
/// that a pause interrupted at rest is neither.
pub(in crate::catalogue) fn onsets(
    run: &RunTable,
    setpoint_a: &[f64],
    increases: usize,
    top_a: f64,
) -> (Vec<Onset>, usize) {
    let position = run.column("motor_position_rad").unwrap_or_default();
    let (held, moved): (Vec<_>, Vec<_>) =
        ramps(run, setpoint_a).into_iter().partition(|ramp| is_held(ramp, setpoint_a, top_a));
    let onset = |ramp: Range<usize>| {
        let row = ramp.end - increases.min(ramp.len() - 1);
        let is_onset = 2 * onward(&position[row - 1..ramp.end], setpoint_a[ramp.end - 1]) >= increases;
        is_onset.then(|| Onset { row, end: ramp.end, current_a: setpoint_a[row] })
    };
    (moved.into_iter().filter_map(onset).collect(), held.len())
}

/// The step of the torque between two rows of a ramp.
pub(in crate::catalogue) fn ramp_step_nm(values: &Values) -> f64 {
    values.number("ramp_nm_s") / values.number("sample_rate_hz")
}

/// Number of row-to-row steps in the direction of the current. A fast breakaway ends before all increases occurred.
fn onward(position_rad: &[f64], current_a: f64) -> usize {
    position_rad.windows(2).filter(|pair| (pair[1] - pair[0]) * current_a > 0.0).count()
}
