//! The directions along the axes of the stage, and the limits of consistent periods.

use crate::column_names::POSE;
use crate::findings::quantity;
use crate::identification::Quantity;
use jointbench_instrument::RunTable;
use jointbench_instrument::roles::Pose;
use jointbench_model::words;

/// One axis of the stage in one direction.
#[derive(Debug)]
pub struct Direction {
    /// Index among the shifts, then the rotations.
    axis: usize,
    sign: f64,
    /// The parameter that limits the search.
    pub reach: &'static str,
    name: &'static str,
    pub title: &'static str,
    /// Manufacturing tolerance of the data sheet, in the unit of the axis.
    pub manufacturing: f64,
}

const DEGREE: f64 = std::f64::consts::PI / 180.0;

const fn direction(
    axis: usize,
    sign: f64,
    reach: &'static str,
    name: &'static str,
    title: &'static str,
    manufacturing: f64,
) -> Direction {
    Direction { axis, sign, reach, name, title, manufacturing }
}

/// The axial shift towards the ring is omitted, because the ring is in the way.
pub const DIRECTIONS: [Direction; 9] = [
    direction(0, -1.0, "radial_reach_m", "radial_negative", "Radial shift −", 0.15e-3),
    direction(0, 1.0, "radial_reach_m", "radial_positive", "Radial shift +", 0.15e-3),
    direction(2, 1.0, "axial_reach_m", "axial_positive", "Axial shift +", 0.15e-3),
    direction(5, -1.0, "rotation_reach_rad", "rotation_negative", "Rotation −", 0.5 * DEGREE),
    direction(5, 1.0, "rotation_reach_rad", "rotation_positive", "Rotation +", 0.5 * DEGREE),
    direction(3, -1.0, "tilt_reach_rad", "tilt_negative", "Tilt −", 0.5 * DEGREE),
    direction(3, 1.0, "tilt_reach_rad", "tilt_positive", "Tilt +", 0.5 * DEGREE),
    direction(1, -1.0, "vertical_reach_m", "vertical_negative", "Vertical shift −", 0.5e-3),
    direction(1, 1.0, "vertical_reach_m", "vertical_positive", "Vertical shift +", 0.5e-3),
];

/// The farthest consistent position, and the nearest inconsistent one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Found {
    pub good: f64,
    pub bad: Option<f64>,
}

impl Direction {
    pub fn pose(&self, reach: f64) -> Pose {
        let mut pose = Pose::default();
        let axes = pose.shift_m.iter_mut().chain(&mut pose.rotation_rad);
        if let Some(axis) = axes.into_iter().nth(self.axis) {
            *axis = self.sign * reach;
        }
        pose
    }

    pub fn unit(&self) -> &'static str {
        if self.axis < 3 { "m" } else { "rad" }
    }

    /// A position in words, without its sign, which the direction already defines.
    pub fn length(&self, at: f64) -> String {
        words::figure(at.abs(), self.unit())
    }

    /// Name and title of the axis, without the direction.
    pub fn axis(&self) -> (&'static str, &'static str) {
        let name = self.name.split_once('_').map_or(self.name, |(axis, _)| axis);
        (name, self.title.trim_end_matches([' ', '−', '+']))
    }

    pub fn is_opposite(&self, other: &Self) -> bool {
        self.axis == other.axis && self.sign != other.sign
    }

    /// Whether the periods are consistent up to the data sheet's tolerance; `None` if the search did not reach it.
    pub fn holds(&self, found: &Found) -> Option<bool> {
        match found.bad {
            _ if found.good.abs() >= self.manufacturing => Some(true),
            Some(bad) if bad.abs() <= self.manufacturing => Some(false),
            _ => None,
        }
    }

    /// The midpoint between consistent and inconsistent, with both positions as its interval. `None` if the periods
    /// stayed consistent.
    pub fn quantity(&self, found: &Found) -> Option<Quantity> {
        let (good, bad) = (found.good, found.bad?);
        let unit = self.unit();
        let title = format!("{}: loss of the period count", self.title);
        let ends = [good.min(bad), good.max(bad)];
        Some(quantity([self.name, "", &title, unit], 0.5 * (good + bad), Some(ends)))
    }
}

/// `None` if the run did not search this direction, or was inconsistent from the start.
pub fn found(run: &RunTable, direction: &Direction) -> Option<Found> {
    let consistent = run.column("encoder_consistent")?;
    let poses: Vec<&[f64]> = POSE.iter().map(|name| run.column(name)).collect::<Option<_>>()?;
    let repeat = run.column("repeat")?;
    let mut found: Option<Found> = None;
    for row in (0..run.len()).filter(|row| repeat[*row] == 0.0) {
        let on_the_way = poses.iter().enumerate().all(|(axis, pose)| {
            if axis == direction.axis { direction.sign * pose[row] > 0.0 } else { pose[row] == 0.0 }
        });
        if !on_the_way {
            continue;
        }
        let at = direction.sign * poses[direction.axis][row];
        let Found { good, bad } = found.get_or_insert(Found { good: 0.0, bad: None });
        if consistent[row] == 0.0 {
            *bad = Some(bad.map_or(at, |bad: f64| bad.min(at)));
        } else {
            *good = good.max(at);
        }
    }
    // A position at which the periods were inconsistent for a part of the turn counts as inconsistent.
    let found = found?;
    let good = found
        .bad
        .map_or(found.good, |bad| if found.good < bad { found.good } else { last_before(run, direction, bad) });
    Some(Found { good: direction.sign * good, bad: found.bad.map(|bad| direction.sign * bad) })
}

/// The farthest position before `bad`.
fn last_before(run: &RunTable, direction: &Direction, bad: f64) -> f64 {
    let axis = run.column(POSE[direction.axis]).unwrap_or_default();
    axis.iter().map(|at| direction.sign * at).filter(|at| *at < bad).fold(0.0, f64::max)
}
