//! Torque over current with memory: a Preisach model, stored as the stack of turning points that are not wiped out.
//!
//! The widths of the elements have an arctangent density, so the loss after a reversal of `d` is
//! `SHARE · (d − WIDTH · atan(d / WIDTH))`. Every loop between two currents closes, and a larger loop wipes it out
//! (Mayergoyz, *Mathematical Models of Hysteresis*, chapter 1).

use crate::sim::plant::curve;

/// Rising branch from zero, torque over current, both as fractions of the rating (assumed, S-shaped, +18 % at 130 %).
const RISING: [(f64, f64); 13] = [
    (0.0, 0.0),
    (0.1, 0.03),
    (0.2, 0.09),
    (0.3, 0.19),
    (0.4, 0.33),
    (0.5, 0.47),
    (0.6, 0.61),
    (0.7, 0.74),
    (0.8, 0.85),
    (0.9, 0.94),
    (1.0, 1.00),
    (1.15, 1.10),
    (1.3, 1.18),
];
/// The branches differ by 6 % of the rating at half the current (assumed: 3 to 8 %).
const SHARE: f64 = 0.47;
const WIDTH: f64 = 0.1;
/// Turning points that are closer than this are one.
const LEAST_TURN: f64 = 1e-6;
/// Beyond this number of nested loops, the innermost are dropped first.
const DEEPEST: usize = 32;

/// Torque of the first rise from zero.
pub fn rising(current: f64) -> f64 {
    curve::at(&RISING, current)
}

/// Contribution of the elements of finite width that have switched over a monotonic stretch.
fn turned(stretch: f64, width: f64) -> f64 {
    SHARE * (stretch - width * (stretch / width).atan())
}

/// Currents and torques as fractions of the rating.
pub struct Branches {
    width: f64,
    /// Turning points, the oldest first: a maximum, a minimum, and so on.
    turns: Vec<f64>,
    /// Torque of the elements up to the last turning point.
    settled: f64,
    current: f64,
}

impl Branches {
    /// A width of `None` is that of the data sheet.
    pub fn new(width: Option<f64>) -> Self {
        Self { width: width.unwrap_or(WIDTH), turns: Vec::new(), settled: 0.0, current: 0.0 }
    }

    /// Torque after the current has moved monotonically to `current`.
    pub fn advance(&mut self, current: f64) -> f64 {
        let current = current.max(0.0);
        let rises = self.turns.len().is_multiple_of(2);
        if current != self.current && (current > self.current) != rises {
            self.turn();
        }
        self.current = current;
        self.wipe();
        // Elements of zero width follow the current; on the first rise the sum of both is the rising branch.
        rising(current) - turned(current, self.width) + self.settled + self.since_last_turn()
    }

    fn turn(&mut self) {
        let last = self.turns.last().copied().unwrap_or(0.0);
        if (self.current - last).abs() < LEAST_TURN || self.turns.len() >= DEEPEST {
            self.turns.pop();
        } else {
            self.turns.push(self.current);
        }
        self.settle();
    }

    /// A stretch beyond the last turning point but one wipes out the loop between them.
    fn wipe(&mut self) {
        let before = self.turns.len();
        while let [.., outer, _inner] = self.turns[..] {
            let rises = self.turns.len().is_multiple_of(2);
            if (rises && self.current < outer) || (!rises && self.current > outer) {
                break;
            }
            self.turns.truncate(self.turns.len() - 2);
        }
        // A fall to zero wipes out everything.
        if self.current == 0.0 {
            self.turns.clear();
        }
        if self.turns.len() != before {
            self.settle();
        }
    }

    fn settle(&mut self) {
        let (mut from, mut sign) = (0.0, 1.0);
        self.settled = 0.0;
        for turn in &self.turns {
            self.settled += sign * turned((turn - from).abs(), self.width);
            (from, sign) = (*turn, -sign);
        }
    }

    fn since_last_turn(&self) -> f64 {
        let from = self.turns.last().copied().unwrap_or(0.0);
        let sign = if self.turns.len().is_multiple_of(2) { 1.0 } else { -1.0 };
        sign * turned((self.current - from).abs(), self.width)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn go(branches: &mut Branches, from: f64, to: f64) -> f64 {
        (0..=100).map(|step| branches.advance(from + (to - from) * f64::from(step) / 100.0)).last().unwrap()
    }

    #[test]
    fn the_falling_branch_lies_above_and_both_meet_at_the_ends() {
        let mut branches = Branches::new(None);
        let up = go(&mut branches, 0.0, 0.5);
        assert!((up - rising(0.5)).abs() < 1e-12);
        assert!((go(&mut branches, 0.5, 1.0) - 1.0).abs() < 1e-12);
        let down = go(&mut branches, 1.0, 0.5);
        assert!((0.03..0.08).contains(&(down - up)), "{}", down - up);
        assert_eq!(go(&mut branches, 0.5, 0.0), 0.0);
        assert_eq!(go(&mut branches, 0.0, 0.5), up, "nothing of it is remembered at zero");
    }

    #[test]
    fn minor_loops_close_and_larger_ones_wipe_them_out() {
        let mut branches = Branches::new(None);
        let (top, mut low, mut high) = (go(&mut branches, 0.0, 0.8), Vec::new(), Vec::new());
        let outer = go(&mut branches, 0.8, 0.3);
        go(&mut branches, 0.3, 0.4);
        for _ in 0..3 {
            high.push(go(&mut branches, 0.4, 0.6));
            low.push(go(&mut branches, 0.6, 0.4));
        }
        assert!(
            high.windows(2).chain(low.windows(2)).all(|pair| (pair[0] - pair[1]).abs() < 1e-12),
            "{high:?} {low:?}"
        );
        assert!(high[0] > low[0]);
        assert!((go(&mut branches, 0.4, 0.3) - outer).abs() < 1e-12, "back at the turn that began it");
        assert!((go(&mut branches, 0.3, 0.8) - top).abs() < 1e-12);
        assert!((go(&mut branches, 0.8, 1.0) - 1.0).abs() < 1e-12, "on the rising branch again");
    }

    #[test]
    fn torque_follows_the_current_everywhere() {
        let mut branches = Branches::new(None);
        let mut last = 0.0;
        for turn in [1.2, 0.1, 0.9, 0.2, 0.7, 0.05, 1.3] {
            let start = branches.current;
            for step in 1..=200 {
                let torque = branches.advance(start + (turn - start) * f64::from(step) / 200.0);
                assert!((torque > last) == (turn > start), "towards {turn}, step {step}");
                last = torque;
            }
        }
        for step in 0..10_000 {
            branches.advance(0.5 + 0.4 * (-1e-4 * f64::from(step)).exp() * f64::from(1 - 2 * (step % 2)));
        }
        assert!(branches.turns.len() <= DEEPEST);
    }
}
