//! The parts of a run at constant speed, as differences of both encoders over the angle.

use super::SETTLE_S;
use crate::column_names::POSE;
use crate::findings::solve;
use jointbench_instrument::RunTable;
use jointbench_instrument::units::wrapped;
use std::f64::consts::TAU;
use std::ops::Range;

/// Whole turns at one speed.
#[derive(Debug, Clone)]
pub struct Sweep {
    pub repeat: i64,
    /// Measured speed, from the reference.
    pub speed_rad_s: f64,
    /// Angle of the reference at the reading times of the encoder under test.
    pub angle_rad: Vec<f64>,
    /// Test − reference within half a turn of its centre.
    pub error_rad: Vec<f64>,
    /// First axis of the stage; 0 if the run does not move it.
    pub radial_m: f64,
}

/// Mean and first two harmonics of an error over the turn.
#[derive(Debug, Clone, Copy)]
pub struct Shape {
    pub mean_rad: f64,
    /// Cosine and sine.
    pub once_rad: [f64; 2],
    pub twice_rad: [f64; 2],
}

impl Sweep {
    /// By least squares, so that uneven sampling does not bias the mean.
    pub fn shape(&self) -> Option<Shape> {
        let row = |angle: &f64| [1.0, angle.cos(), angle.sin(), (2.0 * angle).cos(), (2.0 * angle).sin()];
        let rows: Vec<[f64; 5]> = self.angle_rad.iter().map(row).collect();
        let [mean_rad, c1, s1, c2, s2] = solve(&rows, &self.error_rad)?.values;
        Some(Shape { mean_rad, once_rad: [c1, s1], twice_rad: [c2, s2] })
    }
}

/// Every part at constant speed of at least one turn, in the order of the run. Empty if the columns are not those of
/// an encoder run of this product.
pub fn sweeps(run: &RunTable) -> Vec<Sweep> {
    let Some(columns) = Columns::of(run) else { return Vec::new() };
    let mut sweeps = Vec::new();
    let mut start = 0;
    for chunk in columns.segment.chunk_by(|a, b| a == b) {
        let rows = start..start + chunk.len();
        start = rows.end;
        sweeps.extend(columns.sweep(rows));
    }
    sweeps
}

struct Columns<'a> {
    time_s: &'a [f64],
    reference: &'a [f64],
    test: &'a [f64],
    skew_s: &'a [f64],
    setpoint: &'a [f64],
    segment: &'a [f64],
    repeat: &'a [f64],
    /// Pose of the stage; empty if the run does not move it.
    pose: Vec<&'a [f64]>,
    /// A count reports the lower end of its step; half a count is added.
    half_counts: [f64; 2],
}

impl<'a> Columns<'a> {
    fn of(run: &'a RunTable) -> Option<Self> {
        let half = |name: &str| {
            let channel = run.trace().channels().iter().find(|channel| channel.name == name);
            0.5 * channel.and_then(|channel| channel.resolution).unwrap_or(0.0)
        };
        Some(Self {
            time_s: run.column("time_s")?,
            reference: run.column("reference_position_rad")?,
            test: run.column("test_position_rad")?,
            skew_s: run.column("encoder_skew_s")?,
            setpoint: run.column("velocity_setpoint_rad_s")?,
            segment: run.column("segment")?,
            repeat: run.column("repeat")?,
            pose: POSE.iter().filter_map(|name| run.column(name)).collect(),
            half_counts: [half("reference_position_rad"), half("test_position_rad")],
        })
    }

    fn sweep(&self, rows: Range<usize>) -> Option<Sweep> {
        let top = self.setpoint[rows.clone()].iter().fold(0.0, |top: f64, v| top.max(v.abs()));
        let mut even = rows.filter(|row| top > 0.0 && self.setpoint[*row].abs() == top);
        let (first, last) = (even.next()?, even.next_back()?);
        // An edge search has the sensor at many positions.
        if self.pose.iter().any(|axis| axis[first..=last].iter().any(|at| *at != axis[first])) {
            return None;
        }
        let settled_s = self.time_s[first] + SETTLE_S;
        let first = (first..=last).find(|row| self.time_s[*row] >= settled_s)?;
        let turned_rad = |row: usize| (self.reference[last] - self.reference[row]).abs();
        let turns = (turned_rad(first) / TAU).floor();
        if turns < 1.0 {
            return None;
        }
        let first = (first..=last).find(|row| turned_rad(*row) <= turns * TAU)?;
        let speed_rad_s = (self.reference[last] - self.reference[first]) / (self.time_s[last] - self.time_s[first]);
        let [reference_half, test_half] = self.half_counts;
        let angle = |row: usize| self.reference[row] + reference_half + speed_rad_s * self.skew_s[row];
        let angle_rad: Vec<f64> = (first..=last).map(angle).collect();
        let error = |row: usize| wrapped(self.test[row] + test_half - angle(row));
        Some(Sweep {
            repeat: self.repeat[first] as i64,
            speed_rad_s,
            error_rad: (first..=last).map(error).collect(),
            angle_rad,
            radial_m: self.pose.first().map_or(0.0, |radial| radial[first]),
        })
    }
}
