//! Delay between two instruments that measure one motion, estimated from their readings, because no clock shows it.
//!
//! If both are on one shaft, the delayed one reports an earlier position, so that their difference is proportional to
//! the speed. The estimated lag removes this proportionality, with the first instrument's positions interpolated
//! between its readings. Errors once and twice in a turn are no lag and are fitted too. Zeros and hysteresis differ
//! between stretches of motion, so that each stretch has its own offset.

use super::solve::{jackknife95, solve};

/// Readings of both instruments in one tick, each with its time by the bench's clock.
#[derive(Debug, Clone, Copy)]
pub struct ReadingPair {
    /// Readings of one stretch are consecutive.
    pub stretch: u32,
    pub first_s: f64,
    pub first_rad: f64,
    pub second_s: f64,
    pub second_rad: f64,
}

/// Delay of the second instrument beyond its time stamps, with half the width of the 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lag {
    pub s: f64,
    pub reach_s: f64,
}

/// Derivative with respect to the lag (the difference falls as the speed rises), then cosine and sine of the angle
/// and of twice the angle.
type Row = [f64; 5];

const ROUNDS: usize = 10;
/// A tenth of the resolution of time stamps.
const FOUND_S: f64 = 1e-7;
/// Parts of the run that are left out in turn for the interval, because neighbouring readings have correlated errors.
const PARTS: usize = 10;
/// Least rotation for an estimate of the lag.
const TURNED_RAD: f64 = 1.0;

/// `None` if the motion does not determine the lag to half a reading period.
pub fn lag(readings: &[ReadingPair]) -> Option<Lag> {
    let stretches: Vec<&[ReadingPair]> = readings.chunk_by(|a, b| a.stretch == b.stretch).collect();
    let turned_rad =
        |stretch: &&[ReadingPair]| stretch.windows(2).map(|w| (w[1].first_rad - w[0].first_rad).abs()).sum::<f64>();
    if stretches.iter().map(turned_rad).sum::<f64>() < TURNED_RAD {
        return None;
    }
    let mut lag_s = 0.0;
    for _ in 0..ROUNDS {
        let (rows, y) = equations(&stretches, lag_s);
        let step_s = solve(&rows, &y)?.values[0];
        lag_s += step_s;
        if step_s.abs() < FOUND_S {
            let reach_s = reach(&rows, &y)?;
            return (reach_s < 0.5 * period_s(readings)?).then_some(Lag { s: lag_s, reach_s });
        }
    }
    None
}

fn period_s(readings: &[ReadingPair]) -> Option<f64> {
    let mut steps_s: Vec<f64> = readings.windows(2).map(|w| w[1].first_s - w[0].first_s).collect();
    steps_s.sort_by(f64::total_cmp);
    steps_s.get(steps_s.len() / 2).copied()
}

/// The remaining difference for a lag of the second instrument.
fn equations(stretches: &[&[ReadingPair]], lag_s: f64) -> (Vec<Row>, Vec<f64>) {
    let (mut rows, mut y) = (Vec::new(), Vec::new());
    for stretch in stretches {
        let start = rows.len();
        let mut behind = 1;
        for pair in *stretch {
            let moment_s = pair.second_s - lag_s;
            while behind < stretch.len() && stretch[behind].first_s < moment_s {
                behind += 1;
            }
            let Some([a, b]) = stretch.get(behind - 1..=behind) else { break };
            if a.first_s > moment_s {
                continue;
            }
            let speed_rad_s = (b.first_rad - a.first_rad) / (b.first_s - a.first_s);
            let angle_rad = a.first_rad + speed_rad_s * (moment_s - a.first_s);
            let twice_rad = 2.0 * angle_rad;
            rows.push([-speed_rad_s, angle_rad.cos(), angle_rad.sin(), twice_rad.cos(), twice_rad.sin()]);
            y.push(pair.second_rad - angle_rad);
        }
        about_their_mean(&mut rows[start..], &mut y[start..]);
    }
    (rows, y)
}

fn about_their_mean(rows: &mut [Row], y: &mut [f64]) {
    let count = rows.len() as f64;
    let mean: Row = std::array::from_fn(|i| rows.iter().map(|row| row[i]).sum::<f64>() / count);
    let mean_y = y.iter().sum::<f64>() / count;
    rows.iter_mut().for_each(|row| row.iter_mut().zip(mean).for_each(|(value, mean)| *value -= mean));
    y.iter_mut().for_each(|y| *y -= mean_y);
}

/// Half width of the jackknife interval over parts of the run.
fn reach(rows: &[Row], y: &[f64]) -> Option<f64> {
    let without = |part: usize| {
        let [from, to] = [part, part + 1].map(|end| end * rows.len() / PARTS);
        let rows = [&rows[..from], &rows[to..]].concat();
        let y = [&y[..from], &y[to..]].concat();
        Some(solve(&rows, &y)?.values[0])
    };
    let left: Vec<f64> = (0..PARTS).map(without).collect::<Option<_>>()?;
    Some(jackknife95(&left))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// Strokes back and forth at 250 Hz, with a once-per-turn error and counts. The second instrument has a lag of
    /// `lag_s` against its time stamps, which are 0.8 ms after those of the first.
    fn strokes(lag_s: f64, top_rad_s: f64) -> Vec<ReadingPair> {
        let counted = |rad: f64, counts: f64| (rad / TAU * counts).floor() / counts * TAU;
        let shaft = |t_s: f64| -top_rad_s / 3.0 * (3.0 * t_s).cos();
        let tick = |i: u32| {
            let first_s = f64::from(i) * 4e-3;
            let second_s = first_s + 0.8e-3;
            let truly_rad = shaft(second_s - lag_s);
            let second_rad = counted(truly_rad + 4e-3 * (truly_rad + 1.0).sin() + 0.3, 262_144.0);
            ReadingPair {
                stretch: i / 500,
                first_s,
                first_rad: counted(shaft(first_s), 16_384.0),
                second_s,
                second_rad,
            }
        };
        (0..3000).map(tick).collect()
    }

    #[test]
    fn a_lag_is_found_however_long_and_its_interval_holds_it() {
        for lag_s in [0.0, 64e-6, 1.3e-3, -2e-3, 9e-3] {
            let found = lag(&strokes(lag_s, 40.0)).unwrap();
            assert!((found.s - lag_s).abs() <= found.reach_s, "{lag_s}: {found:?}");
            assert!(found.reach_s < 20e-6, "{lag_s}: {found:?}");
        }
    }

    #[test]
    fn without_motion_there_is_no_lag() {
        for top_rad_s in [0.0, 1e-4, 1e-2] {
            assert_eq!(lag(&strokes(1e-3, top_rad_s)), None, "{top_rad_s} rad/s");
        }
        assert_eq!(lag(&[]), None);
        // At one speed a lag and a zero offset are identical.
        let even: Vec<ReadingPair> = strokes(0.0, 0.0)
            .iter()
            .map(|pair| ReadingPair {
                first_rad: 40.0 * pair.first_s,
                second_rad: 40.0 * pair.second_s - 0.01,
                ..*pair
            })
            .collect();
        assert_eq!(lag(&even), None);
    }
}
