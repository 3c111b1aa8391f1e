//! Pose of the stage with the encoder under test during a step, and the search for the edge of its range.

use jointbench_instrument::roles::Pose;
use serde::{Deserialize, Serialize};

/// Pose of the stage during a step.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub enum StagePose {
    /// The last pose.
    #[default]
    AsLeft,
    /// Moved to at rest, before the step.
    At(Pose),
    /// Searched for while the shaft turns.
    Edge(Edge),
}

/// A direction from a pose with consistent periods, followed until they are inconsistent: in equal strides first,
/// then by bisection of the last one. Every try is approached from the consistent side.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Edge {
    /// Pose with consistent periods, from which the search starts.
    pub from: Pose,
    /// Farthest pose of the search.
    pub to: Pose,
    /// Strides from end to end.
    pub strides: u32,
    /// Bisections of the interval between consistent and inconsistent.
    pub halvings: u32,
    /// Duration of each try, which should exceed a turn.
    pub dwell_s: f64,
}

impl Edge {
    /// Tries of the longest search: all strides, then all bisections.
    pub fn tries(&self) -> u32 {
        1 + self.strides + self.halvings
    }

    fn parts(&self) -> u32 {
        self.strides << self.halvings
    }

    /// A pose at a part of the direction.
    pub(crate) fn pose(&self, part: u32) -> Pose {
        let share = f64::from(part) / f64::from(self.parts());
        let between = |from: [f64; 3], to: [f64; 3]| std::array::from_fn(|i| from[i] + share * (to[i] - from[i]));
        Pose {
            shift_m: between(self.from.shift_m, self.to.shift_m),
            rotation_rad: between(self.from.rotation_rad, self.to.rotation_rad),
        }
    }
}

/// Progress of the search, in parts of the direction.
#[derive(Debug, Clone)]
pub(crate) struct EdgeSearch {
    edge: Edge,
    at: u32,
    /// The farthest consistent part.
    pub good: u32,
    /// The nearest inconsistent part.
    bad: Option<u32>,
}

impl EdgeSearch {
    pub fn new(edge: Edge) -> Self {
        Self { edge, at: 0, good: 0, bad: None }
    }

    /// The next part to try, after the result at the present one. `None`: the edge is found, or the end of the
    /// direction is reached.
    pub fn next(&mut self, consistent: bool) -> Option<u32> {
        if consistent {
            self.good = self.at;
        } else {
            self.bad = Some(self.at);
        }
        let stride = 1 << self.edge.halvings;
        let next = match self.bad {
            None if self.good + stride <= self.edge.parts() => self.good + stride,
            Some(bad) if bad > self.good + 1 => self.good + (bad - self.good) / 2,
            _ => return None,
        };
        self.at = next;
        Some(next)
    }

    pub fn is_beyond(&self) -> bool {
        self.bad == Some(self.at)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WAY: Edge = Edge {
        from: Pose { shift_m: [0.0; 3], rotation_rad: [0.0; 3] },
        to: Pose { shift_m: [-0.4e-3, 0.0, 0.0], rotation_rad: [0.0; 3] },
        strides: 5,
        halvings: 3,
        dwell_s: 0.1,
    };

    /// Number of tries and the last consistent position (m).
    fn search(consistent: impl Fn(f64) -> bool) -> (u32, f64, Option<u32>) {
        let mut search = EdgeSearch::new(WAY);
        let (mut tries, mut at) = (1, 0);
        while let Some(next) = search.next(consistent(WAY.pose(at).shift_m[0])) {
            (tries, at) = (tries + 1, next);
        }
        (tries, WAY.pose(search.good).shift_m[0], search.bad)
    }

    #[test]
    fn an_edge_is_found_within_one_part_and_in_the_tries_that_were_planned() {
        for edge_mm in [-0.005, -0.08, -0.25, -0.2501, -0.399] {
            let (tries, good_m, bad) = search(|at_m| at_m >= 1e-3 * edge_mm);
            assert!(tries <= WAY.tries(), "{tries} tries");
            assert!((0.0..0.0101).contains(&(1e3 * good_m - edge_mm)), "{good_m} m for {edge_mm} mm");
            assert!(bad.is_some());
        }
    }

    #[test]
    fn no_edge_is_none_and_a_bad_start_ends_at_once() {
        assert_eq!(search(|_| true), (6, -0.4e-3, None));
        assert_eq!(search(|_| false), (1, 0.0, Some(0)));
    }
}
