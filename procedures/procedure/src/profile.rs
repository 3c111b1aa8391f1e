//! A set-point over the time of a step: straight lines between knots.

use serde::{Deserialize, Serialize};

/// Piecewise linear in time: the first knot is at 0 s, times never decrease, and the last value holds for ever.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Profile {
    knots: Vec<(f64, f64)>,
}

impl Profile {
    /// One value for ever, of duration 0.
    pub fn constant(value: f64) -> Self {
        Self { knots: vec![(0.0, value)] }
    }

    /// Starts at a value; [`Profile::to`] and [`Profile::hold`] continue from there.
    pub fn from(value: f64) -> Self {
        Self::constant(value)
    }

    /// Continues to a value in `seconds`.
    pub fn to(mut self, value: f64, seconds: f64) -> Self {
        self.knots.push((self.duration_s() + seconds.max(0.0), value));
        self
    }

    /// Holds the last value for `seconds`.
    pub fn hold(self, seconds: f64) -> Self {
        let value = self.end();
        self.to(value, seconds)
    }

    /// Appends another profile.
    pub fn then(mut self, next: &Profile) -> Self {
        let from_s = self.duration_s();
        self.knots.extend(next.knots.iter().map(|(t_s, value)| (from_s + t_s, *value)));
        self
    }

    /// From rest to a speed, a dwell of `dwell_s`, and back to rest.
    pub fn plateau(speed_rad_s: f64, acceleration_rad_s2: f64, dwell_s: f64) -> Self {
        let ramp_s = speed_rad_s.abs() / acceleration_rad_s2;
        Self::from(0.0).to(speed_rad_s, ramp_s).hold(dwell_s).to(0.0, ramp_s)
    }

    /// The same in the opposite direction.
    pub fn turned(self) -> Self {
        Self { knots: self.knots.into_iter().map(|(t_s, value)| (t_s, -value)).collect() }
    }

    /// Value at a time; constant before the first and after the last knot.
    pub fn at(&self, t_s: f64) -> f64 {
        let after = self.knots.partition_point(|(knot_s, _)| *knot_s <= t_s);
        match (after.checked_sub(1).map(|i| self.knots[i]), self.knots.get(after)) {
            (Some((t0, v0)), Some(&(t1, v1))) => v0 + (v1 - v0) * (t_s - t0) / (t1 - t0),
            (Some((_, last)), None) => last,
            (None, _) => self.knots[0].1,
        }
    }

    /// Time of the last knot.
    pub fn duration_s(&self) -> f64 {
        self.knots[self.knots.len() - 1].0
    }

    /// Value after the last knot.
    pub fn end(&self) -> f64 {
        self.knots[self.knots.len() - 1].1
    }

    /// Time and value of every knot.
    pub fn knots(&self) -> &[(f64, f64)] {
        &self.knots
    }

    /// Largest absolute value.
    pub fn largest(&self) -> f64 {
        self.knots.iter().map(|(_, value)| value.abs()).fold(0.0, f64::max)
    }

    /// The steepest slope, per second.
    pub fn steepest(&self) -> f64 {
        let slope = |pair: &[(f64, f64)]| ((pair[1].1 - pair[0].1) / (pair[1].0 - pair[0].0)).abs();
        self.knots.windows(2).filter(|pair| pair[1].0 > pair[0].0).map(slope).fold(0.0, f64::max)
    }

    /// The integral from the start to each knot.
    pub fn integral(&self) -> Vec<f64> {
        let mut sum = 0.0;
        let areas = self.knots.windows(2).map(|pair| (pair[1].0 - pair[0].0) * 0.5 * (pair[0].1 + pair[1].1));
        std::iter::once(0.0)
            .chain(areas.map(|area| {
                sum += area;
                sum
            }))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_leg_rises_holds_and_falls() {
        let profile = Profile::plateau(-10.0, 20.0, 2.0);
        assert_eq!(profile.duration_s(), 3.0);
        for (t_s, value) in
            [(-1.0, 0.0), (0.0, 0.0), (0.25, -5.0), (0.5, -10.0), (2.5, -10.0), (2.75, -5.0), (9.0, 0.0)]
        {
            assert_eq!(profile.at(t_s), value, "at {t_s} s");
        }
        assert_eq!((profile.largest(), profile.steepest()), (10.0, 20.0));
        assert_eq!(profile.integral(), [0.0, -2.5, -22.5, -25.0]);
    }

    #[test]
    fn a_step_in_no_time_takes_the_new_value() {
        let profile = Profile::from(1.0).to(3.0, 0.0).hold(1.0);
        assert_eq!((profile.at(0.0), profile.at(0.5), profile.end()), (3.0, 3.0, 3.0));
    }
}
