//! Torque over rising current at each speed, and the current of a torque.

use super::CURVE;
use crate::catalogue::brake_hysteresis::SETTLED;
use crate::findings::{Hold, holds};
use crate::parameter::Values;
use jointbench_instrument::RunTable;

/// Relative difference below which two set-points are the same speed.
const SAME: f64 = 1e-3;

/// The torque at one speed: the mean of both directions.
pub struct Curve {
    /// Motor-side speed.
    pub speed_rad_s: f64,
    /// Current and torque, rising.
    pub points: Vec<(f64, f64)>,
}

pub struct Curves(pub Vec<Curve>);

/// Complete steps of a run: those that end at zero current. A step that a pause interrupted is repeated as a whole.
pub fn complete(run: &RunTable) -> Vec<Hold> {
    let held: Vec<Hold> = holds(run, 0.3).into_iter().filter(|hold| hold.repeat >= i64::from(CURVE)).collect();
    let is_complete = |step: &&[Hold]| step.len() > 1 && step[step.len() - 1].brake == 0.0;
    held.chunk_by(|a, b| a.segment == b.segment).filter(is_complete).flatten().cloned().collect()
}

impl Curves {
    pub fn of(run: &RunTable) -> Self {
        let torque = run.column("brake_torque_nm").unwrap_or_default();
        // Speed, current and torque of each hold.
        let mut points: Vec<[f64; 3]> = complete(run)
            .iter()
            .filter(|hold| hold.repeat == i64::from(CURVE) && hold.brake > 0.0)
            .map(|hold| [hold.velocity_rad_s.abs(), hold.brake, hold.mean(torque, SETTLED)])
            .collect();
        points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
        let mean = |same: &[[f64; 3]]| (same[0][1], same.iter().map(|point| point[2]).sum::<f64>() / same.len() as f64);
        let curve = |of_speed: &[[f64; 3]]| Curve {
            speed_rad_s: of_speed[0][0],
            points: of_speed.chunk_by(|a, b| is_same(a[1], b[1])).map(mean).collect(),
        };
        let curves = points.chunk_by(|a, b| is_same(a[0], b[0])).map(curve);
        Self(curves.filter(|curve| curve.points.len() >= 3).collect())
    }

    /// The torque of the parameters, or half of the torque that all speeds reach.
    pub fn demanded_nm(&self, values: &Values) -> Result<f64, String> {
        let given_nm = values.number("torque_nm");
        if given_nm > 0.0 {
            return Ok(given_nm);
        }
        let tops = self.0.iter().map(|curve| curve.points[curve.points.len() - 1].1);
        tops.reduce(f64::min).map(|top_nm| 0.5 * top_nm).ok_or_else(|| "no torque curve is complete".to_owned())
    }

    /// Each speed with the current of the torque.
    pub fn currents(&self, speeds_rad_s: &[f64], torque_nm: f64) -> Result<Vec<(f64, f64)>, String> {
        let current = |speed_rad_s: &f64| {
            let curve = self.0.iter().find(|curve| is_same(curve.speed_rad_s, *speed_rad_s));
            let curve = curve.ok_or_else(|| format!("no torque curve at {speed_rad_s:.1} rad/s (motor)"))?;
            Ok((*speed_rad_s, curve.current_a(torque_nm)?))
        };
        speeds_rad_s.iter().map(current).collect()
    }
}

pub fn is_same(a: f64, b: f64) -> bool {
    (a - b).abs() <= SAME * a.abs().max(b.abs())
}

impl Curve {
    /// The current of a torque: on the parabola through the two currents around it and the next nearest one.
    pub fn current_a(&self, torque_nm: f64) -> Result<f64, String> {
        let (low_nm, high_nm) = (self.points[0].1, self.points[self.points.len() - 1].1);
        let around = self.points.windows(2).position(|pair| (pair[0].1..=pair[1].1).contains(&torque_nm));
        let Some(i) = around else {
            return Err(format!(
                "{torque_nm:.2} Nm are out of range: the currents at {:.1} rad/s reach {low_nm:.2} to {high_nm:.2} Nm \
                 (motor speed)",
                self.speed_rad_s
            ));
        };
        let (mut low_a, mut high_a) = (self.points[i].0, self.points[i + 1].0);
        for _ in 0..50 {
            let middle_a = 0.5 * (low_a + high_a);
            *(if self.between(i, middle_a) < torque_nm { &mut low_a } else { &mut high_a }) = middle_a;
        }
        Ok(0.5 * (low_a + high_a))
    }

    /// The torque at a current; outside of the measured currents that of the nearest one.
    pub fn torque_nm(&self, current_a: f64) -> f64 {
        let last = self.points.len() - 1;
        let current_a = current_a.clamp(self.points[0].0, self.points[last].0);
        let i = self.points.partition_point(|(known_a, _)| *known_a <= current_a).clamp(1, last) - 1;
        self.between(i, current_a)
    }

    /// Parabola through the points `i` and `i` + 1 and the next point on the nearer side.
    fn between(&self, i: usize, current_a: f64) -> f64 {
        let is_low = current_a - self.points[i].0 < self.points[i + 1].0 - current_a;
        let third = match (i.checked_sub(1), self.points.get(i + 2)) {
            (Some(before), Some(_)) if is_low => self.points[before],
            (_, Some(after)) => *after,
            (Some(before), None) => self.points[before],
            (None, None) => return self.points[i].1,
        };
        let [(a, x), (b, y), (c, z)] = [self.points[i], self.points[i + 1], third];
        let slope = (y - x) / (b - a);
        let bend = ((z - y) / (c - b) - slope) / (c - a);
        x + slope * (current_a - a) + bend * (current_a - a) * (current_a - b)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_is_inverted_between_its_points() {
        let points = (1..=6).map(|i| (f64::from(i) * 0.1, f64::from(i * i) * 0.3)).collect();
        let curve = Curve { speed_rad_s: 1.0, points };
        for current_a in [0.1, 0.13, 0.27, 0.44, 0.58, 0.6] {
            // 0.3·(10·I)² is a parabola, which the interpolation reproduces.
            let torque_nm = 30.0 * current_a * current_a;
            assert!((curve.torque_nm(current_a) - torque_nm).abs() < 1e-12);
            assert!((curve.current_a(torque_nm).unwrap() - current_a).abs() < 1e-9, "{current_a}");
        }
        assert!(curve.current_a(0.2).is_err() && curve.current_a(11.0).is_err());
    }
}
