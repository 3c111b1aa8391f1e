//! A velocity that a drive estimates comes later than the position that it is told with: a filter stands between them.

use crate::linear::basis::{Basis, dot};
use crate::preprocess::filter::{by_recording, derivative};

/// Beyond this share of a period at the corner of the low-pass filter a lag is not what two slopes can tell.
const LONGEST: f64 = 0.5;

/// By how much the velocity comes after its position. Both smoothed ones tell: what the slope of the position is ahead by is
/// the acceleration times the lag.
pub fn of(
    time_s: &[f64],
    smooth_velocity: &[f64],
    slope_of_position: &[f64],
    starts: &[usize],
    cutoff_hz: f64,
) -> Option<f64> {
    let acceleration = by_recording(smooth_velocity, starts, |range, v| derivative(&time_s[range], v));
    let ahead: Vec<f64> = slope_of_position.iter().zip(smooth_velocity).map(|(q, v)| q - v).collect();
    let lag_s = dot(&ahead, &acceleration) / dot(&acceleration, &acceleration).max(f64::MIN_POSITIVE);
    Some(lag_s).filter(|lag_s| lag_s.abs() * cutoff_hz <= LONGEST)
}

/// What a torque keeps, squared, beside friction, inertia and load of this motion.
pub fn left(torque: &[f64], velocity: &[f64], acceleration: &[f64], load: Option<&[f64]>) -> f64 {
    let mut columns = vec![
        vec![1.0; torque.len()],
        velocity.iter().map(|v| v.signum()).collect(),
        velocity.to_vec(),
        acceleration.to_vec(),
    ];
    columns.extend(load.map(<[f64]>::to_vec));
    let rest = Basis::of(&columns).rest(torque);
    dot(&rest, &rest)
}

/// The velocity at the moments of its position.
pub fn moved(time_s: &[f64], velocity: &[f64], starts: &[usize], lag_s: f64) -> Vec<f64> {
    by_recording(velocity, starts, |range, v| later(&time_s[range], v, lag_s))
}

/// The values as they are so much later, on the straight line between two of them. The ends go on as they are.
fn later(time_s: &[f64], values: &[f64], by_s: f64) -> Vec<f64> {
    let at = |moment_s: f64| {
        let behind = time_s.partition_point(|t| *t <= moment_s);
        if behind == 0 || behind == values.len() {
            return values[behind.min(values.len() - 1)];
        }
        let share = (moment_s - time_s[behind - 1]) / (time_s[behind] - time_s[behind - 1]);
        values[behind - 1] + share * (values[behind] - values[behind - 1])
    };
    time_s.iter().map(|t| at(t + by_s)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_velocity_that_comes_late_is_moved_back() {
        let time_s: Vec<f64> = (0..1000).map(|i| f64::from(i) * 0.004).collect();
        let velocity = |delay_s: f64| -> Vec<f64> { time_s.iter().map(|t| (7.0 * (t - delay_s)).sin()).collect() };
        for lag_s in [0.0019, -0.01, 0.0] {
            let late = velocity(lag_s);
            let found_s = of(&time_s, &late, &velocity(0.0), &[0], 25.0).unwrap();
            assert!((found_s - lag_s).abs() < 2e-4, "{lag_s} s: {found_s} s");
            let moved = moved(&time_s, &late, &[0], found_s);
            let worst = (5..995).map(|i| (moved[i] - velocity(0.0)[i]).abs()).fold(0.0, f64::max);
            assert!(worst < 5e-3, "{lag_s} s: {worst}");
        }
    }

    #[test]
    fn the_torque_says_of_which_moments_it_is() {
        let time_s: Vec<f64> = (0..1000).map(|i| f64::from(i) * 0.004).collect();
        let motion = |delay_s: f64| -> [Vec<f64>; 2] {
            let phase = |t: f64| 7.0 * (t - delay_s);
            [time_s.iter().map(|t| phase(*t).sin()).collect(), time_s.iter().map(|t| 7.0 * phase(*t).cos()).collect()]
        };
        let [v, a] = motion(0.0);
        let torque: Vec<f64> = v.iter().zip(&a).map(|(v, a)| 0.03 * v.signum() + 0.01 * v + 1e-3 * a).collect();
        let [late, late_a] = motion(0.002);
        assert!(left(&torque, &v, &a, None) < 0.5 * left(&torque, &late, &late_a, None));
    }

    #[test]
    fn a_velocity_of_something_else_stays() {
        let time_s: Vec<f64> = (0..1000).map(|i| f64::from(i) * 0.004).collect();
        let slow: Vec<f64> = time_s.iter().map(|t| (1.5 * t).sin()).collect();
        let other: Vec<f64> = time_s.iter().map(|t| (1.5 * t).cos()).collect();
        assert_eq!(of(&time_s, &slow, &other, &[0], 25.0), None);
    }
}
