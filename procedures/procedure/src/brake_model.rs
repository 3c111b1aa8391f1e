//! The Preisach model in Everett's form, from measured reversal curves, and its inverse.

use serde::{Deserialize, Serialize};

/// Torque of a brake over its current, for any history since demagnetisation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BrakeModel {
    /// Currents in rising order, the first 0 (A).
    grid_a: Vec<f64>,
    /// Torque reduction by the fall from `grid_a[i]` to `grid_a[j]`, for j ≤ i (Nm).
    falls_nm: Vec<Vec<f64>>,
    /// Torque at zero current (Nm).
    drag_nm: f64,
}

/// Another brake, with which a run compares its own.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ComparedBrake {
    /// Its torque at the output (Nm).
    pub model: BrakeModel,
    /// RMS error of the model on histories from which it is not built (Nm).
    pub error_nm: f64,
    /// Turns of the brake for each turn of the link.
    pub gear_ratio: f64,
}

/// The turning points of a current that are not erased: highest, lowest, next highest and so on.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CurrentHistory {
    turns_a: Vec<f64>,
    now_a: f64,
}

impl CurrentHistory {
    /// Moves the current monotonically to another value.
    pub fn go(&mut self, to_a: f64) {
        let to_a = to_a.max(0.0);
        if to_a != self.now_a {
            let rises = self.turns_a.len().is_multiple_of(2);
            if (to_a > self.now_a) != rises {
                self.turns_a.push(self.now_a);
            }
            self.now_a = to_a;
        }
        // A current beyond the turning point before the last erases the loop between them.
        while let [.., outer, _] = self.turns_a[..] {
            let rises = self.turns_a.len().is_multiple_of(2);
            if (rises && to_a < outer) || (!rises && to_a > outer) {
                break;
            }
            self.turns_a.truncate(self.turns_a.len() - 2);
        }
        if to_a == 0.0 {
            self.turns_a.clear();
        }
    }

    /// The history after a move of the current to another value.
    pub fn after(&self, to_a: f64) -> Self {
        let mut next = self.clone();
        next.go(to_a);
        next
    }
}

impl BrakeModel {
    /// From reversal curves: for each current of the grid except 0, the torques at the currents from 0 up to it,
    /// measured while the current falls. The last value is the torque at the reversal. `None` if a curve is missing
    /// or too short.
    pub fn from_reversals(grid_a: &[f64], curves_nm: &[Vec<f64>]) -> Option<Self> {
        let whole = curves_nm.iter().enumerate().all(|(i, curve)| curve.len() == i + 2);
        if grid_a.len() < 3 || curves_nm.len() + 1 != grid_a.len() || !whole {
            return None;
        }
        let drag_nm = curves_nm.iter().map(|curve| curve[0]).sum::<f64>() / curves_nm.len() as f64;
        let fall = |curve: &Vec<f64>| -> Vec<f64> { curve.iter().map(|nm| curve[curve.len() - 1] - nm).collect() };
        let falls_nm = std::iter::once(vec![0.0]).chain(curves_nm.iter().map(fall)).collect();
        Some(Self { grid_a: grid_a.to_vec(), falls_nm, drag_nm })
    }

    /// Number of currents in the grid, including 0.
    pub fn currents(&self) -> usize {
        self.grid_a.len()
    }

    /// Torque without current (Nm).
    pub fn drag_nm(&self) -> f64 {
        self.drag_nm
    }

    /// Highest current of the model (A).
    pub fn top_a(&self) -> f64 {
        self.grid_a[self.grid_a.len() - 1]
    }

    /// Torque reduction by a fall between two currents; a rise between them adds the same torque.
    ///
    /// Linear between measured points: on squares of the grid in both currents, on the triangles along its edge.
    fn fall_nm(&self, from_a: f64, to_a: f64) -> f64 {
        let place = |current_a: f64| {
            let last = self.grid_a.len() - 2;
            let i = self.grid_a.partition_point(|knot| *knot <= current_a).clamp(1, last + 1) - 1;
            (i, (current_a - self.grid_a[i]) / (self.grid_a[i + 1] - self.grid_a[i]))
        };
        let ((i, u), (j, v)) = (place(from_a), place(to_a));
        let at = |i: usize, j: usize| self.falls_nm[i][j];
        if j < i {
            let low = at(i, j) + v * (at(i, j + 1) - at(i, j));
            let high = at(i + 1, j) + v * (at(i + 1, j + 1) - at(i + 1, j));
            low + u * (high - low)
        } else {
            at(i + 1, i) * (u - v)
        }
    }

    /// Torque (Nm) after a history of currents: the classical Preisach model in Everett form (Mayergoyz 1991).
    pub fn torque_nm(&self, history: &CurrentHistory) -> f64 {
        let (mut torque_nm, mut before_a, mut rises) = (self.drag_nm, 0.0, true);
        for turn_a in history.turns_a.iter().chain([&history.now_a]) {
            torque_nm += if rises { self.fall_nm(*turn_a, before_a) } else { -self.fall_nm(before_a, *turn_a) };
            (before_a, rises) = (*turn_a, !rises);
        }
        torque_nm
    }

    /// The current that gives a torque after a history; `None` if the torque is out of range.
    pub fn current_a(&self, history: &CurrentHistory, torque_nm: f64) -> Option<f64> {
        let rises = torque_nm >= self.torque_nm(history);
        let (mut low, mut high) = if rises { (history.now_a, self.top_a()) } else { (0.0, history.now_a) };
        let at = |current_a: f64| self.torque_nm(&history.after(current_a));
        if !(at(low)..=at(high)).contains(&torque_nm) {
            return None;
        }
        for _ in 0..50 {
            let middle = 0.5 * (low + high);
            if at(middle) < torque_nm { low = middle } else { high = middle }
        }
        Some(0.5 * (low + high))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A brake of relays: torque 1 for each pair (up, down) of thresholds whose relay is on.
    struct Relays(Vec<(f64, f64, bool)>);

    impl Relays {
        fn new() -> Self {
            let steps = || (0..60).map(|i| (f64::from(i) + 0.5) / 60.0);
            Self(
                steps()
                    .flat_map(|up| steps().filter(move |down| *down < up).map(move |down| (up, down, false)))
                    .collect(),
            )
        }

        fn go(&mut self, current: f64) -> f64 {
            for (up, down, on) in &mut self.0 {
                *on = (*on || current >= *up) && current > *down;
            }
            // Relays with distant thresholds hold more torque, so that the loop is wider at the top.
            let weight = |(up, down, on): &(f64, f64, bool)| if *on { 1.0 + up - down } else { 0.0 };
            self.0.iter().map(weight).sum::<f64>() / 1830.0
        }
    }

    fn measured() -> BrakeModel {
        let grid: Vec<f64> = (0..=20).map(|i| f64::from(i) / 20.0).collect();
        let curve = |top: usize| {
            let mut relays = Relays::new();
            relays.go(grid[top]);
            let mut down: Vec<f64> = (0..=top).rev().map(|i| relays.go(grid[i])).collect();
            down.reverse();
            down
        };
        let curves: Vec<Vec<f64>> = (1..=20).map(curve).collect();
        BrakeModel::from_reversals(&grid, &curves).unwrap()
    }

    #[test]
    fn any_history_is_predicted_and_inverted() {
        let everett = measured();
        let (mut relays, mut history) = (Relays::new(), CurrentHistory::default());
        let top = everett.torque_nm(&history.after(1.0));
        for current in [0.83, 0.12, 0.55, 0.31, 0.48, 0.33, 0.97, 0.4, 0.61, 0.0, 0.37] {
            let torque = relays.go(current);
            history.go(current);
            assert!((everett.torque_nm(&history) - torque).abs() < 0.02 * top, "at {current}: {torque}");
        }
        for wanted in [0.8 * top, 0.2 * top, 0.5 * top, 0.35 * top] {
            let current = everett.current_a(&history, wanted).unwrap();
            history.go(current);
            let torque = relays.go(current);
            assert!((torque - wanted).abs() < 0.02 * top, "{torque} for {wanted}");
        }
        assert_eq!(everett.current_a(&history, 2.0 * top), None);
    }

    #[test]
    fn a_larger_loop_wipes_out_a_smaller_one() {
        let everett = measured();
        let mut history = CurrentHistory::default();
        for current in [0.8, 0.3, 0.6, 0.3, 0.8] {
            history.go(current);
        }
        assert_eq!(everett.torque_nm(&history), everett.torque_nm(&CurrentHistory::default().after(0.8)));
    }
}
