//! Segments, recordings and repeats: from their columns, or detected if these are missing.

use crate::thresholds::{OTHER_DIRECTION, PERIOD_CORRELATION, RECORDING_GAP, RECORDING_JUMP, SWING, TREND_NOISES};
use jointbench_instrument::RunTable;
use std::ops::Range;

/// Stretches of equal value.
pub fn stretches<T: PartialEq>(column: &[T]) -> Vec<Range<usize>> {
    let mut out = Vec::new();
    let mut start = 0;
    for i in 1..=column.len() {
        if i == column.len() || column[i] != column[start] {
            out.push(start..i);
            start = i;
        }
    }
    out
}

/// First samples of the runs that were joined to a table.
pub fn runs(run: &RunTable) -> Vec<usize> {
    let column = run.column("run").unwrap_or_default();
    std::iter::once(0).chain((1..column.len()).filter(|i| column[*i] != column[i - 1])).collect()
}

/// First samples of recordings: after a gap in time of more than ten samples, or at a jump of the position.
pub fn recordings(time_s: &[f64], position: &[f64], step_s: f64) -> Vec<usize> {
    let reach = RECORDING_JUMP * crate::preprocess::median(position.windows(2).map(|w| (w[1] - w[0]).abs())).max(1e-4);
    let gap = |i: usize| time_s[i] - time_s[i - 1] > RECORDING_GAP * step_s;
    let jump = |i: usize| (position[i] - position[i - 1]).abs() > reach.max(0.5);
    std::iter::once(0).chain((1..time_s.len()).filter(|i| gap(*i) || jump(*i))).collect()
}

/// Direction of each sample: the sign of the velocity with a hysteresis, so that noise around zero does not change
/// it.
pub fn direction(velocity: &[f64], band: f64) -> Vec<f64> {
    let first = velocity.iter().find(|v| v.abs() > band).map_or(0.0, |v| v.signum());
    let mut sign = first;
    velocity
        .iter()
        .map(|v| {
            if v.abs() > band {
                sign = v.signum();
            }
            sign
        })
        .collect()
}

/// Rising or falling: the trend changes where the signal has returned from its last extreme by more than its noise.
pub fn trend(values: &[f64]) -> Vec<f64> {
    /// Median of |x − 2y + z| of white noise, in standard deviations.
    const SECOND_DIFFERENCE: f64 = 0.6745 * 2.449;
    let every = values.len().div_ceil(crate::preprocess::INFORMATIVE_ROWS);
    let can_absorb = values.windows(3).step_by(every).map(|w| (w[0] - 2.0 * w[1] + w[2]).abs());
    let depth = TREND_NOISES * crate::preprocess::median(can_absorb) / SECOND_DIFFERENCE;
    let (mut low, mut high) = (0, 0);
    let mut sign = 0.0;
    let mut trend = vec![0.0; values.len()];
    let mut from = 0;
    for (i, v) in values.iter().enumerate() {
        low = if *v < values[low] { i } else { low };
        high = if *v > values[high] { i } else { high };
        // Up to the extreme the previous trend continues.
        let turned = if sign <= 0.0 && v - values[low] > depth {
            Some((1.0, low))
        } else if sign >= 0.0 && values[high] - v > depth {
            Some((-1.0, high))
        } else {
            None
        };
        if let Some((next, at)) = turned {
            trend[from..at].fill(if sign == 0.0 { next } else { sign });
            (sign, from, low, high) = (next, at, i, i);
        }
    }
    trend[from..].fill(sign);
    trend
}

/// The direction of a run that moves in the other direction in less than a tenth of its samples.
pub fn main_direction(direction: &[f64]) -> Option<f64> {
    let ahead = direction.iter().sum::<f64>().signum();
    let back = direction.iter().filter(|d| **d == -ahead).count() as f64;
    (back < OTHER_DIRECTION * direction.len() as f64).then_some(ahead)
}

/// A joint that creeps over its gear teeth repeatedly swings back a little, which is no reversal. If these swings are
/// short and rare, the whole run has one direction.
pub fn without_swings(direction: Vec<f64>, position: &[f64], starts: &[usize]) -> Vec<f64> {
    let Some(ahead) = main_direction(&direction) else { return direction };
    let (mut reached, mut deepest, mut travel) = (f64::NEG_INFINITY, 0.0f64, 0.0f64);
    for (i, q) in position.iter().enumerate() {
        if starts.contains(&i) {
            reached = f64::NEG_INFINITY;
        } else if ahead * q > reached {
            travel += ahead * q - reached;
        }
        reached = reached.max(ahead * q);
        deepest = deepest.max(reached - ahead * q);
    }
    if deepest < SWING * travel { vec![ahead; direction.len()] } else { direction }
}

/// A column as integers, if the run has it.
pub fn integers(run: &RunTable, column: &str) -> Option<Vec<i64>> {
    run.column(column).map(|values| values.iter().map(|v| *v as i64).collect())
}

/// The segments as numbered by the run. `None` if the column does not number segments: one number for the whole run,
/// or another one every few samples.
pub fn numbered(run: &RunTable) -> Option<Vec<i64>> {
    const LEAST_SAMPLES: usize = 8;
    let segment = integers(run, "segment")?;
    let segments = segment.chunk_by(|a, b| a == b).count();
    (1 < segments && segments * LEAST_SAMPLES < segment.len()).then_some(segment)
}

/// Rows of a long signal that determine its period.
const ENOUGH: usize = 4_000;

/// The period of a signal in rows: the first peak of its autocorrelation that is nearly one. `None` if fewer than two
/// periods were recorded. A long signal is first searched in steps, so that the cost stays linear.
pub fn period(signal: &[f64]) -> Option<usize> {
    let n = signal.len();
    let stride = n.div_ceil(ENOUGH).max(1);
    let mean = signal.iter().sum::<f64>() / n.max(1) as f64;
    let x: Vec<f64> = signal.iter().map(|v| v - mean).collect();
    let correlation = |lag: usize| {
        let (a, b) = (&x[..n - lag], &x[lag..]);
        let (mut ab, mut aa, mut bb) = (0.0, 0.0, 0.0);
        for (a, b) in a.iter().zip(b).step_by(stride) {
            ab += a * b;
            aa += a * a;
            bb += b * b;
        }
        if aa * bb > 0.0 { ab / (aa * bb).sqrt() } else { 0.0 }
    };
    let mut lag = n / 100 + 2;
    while lag < n / 2 && correlation(lag) > 0.5 {
        lag += stride;
    }
    let best = |lags: &mut dyn Iterator<Item = usize>| {
        lags.map(|l| (l, correlation(l))).fold((0, 0.0), |m, c| if c.1 > m.1 + 1e-3 { c } else { m })
    };
    let (near, _) = best(&mut (lag..=n / 2).step_by(stride));
    let (period, value) = best(&mut (near.saturating_sub(stride - 1).max(1)..=(near + stride - 1).min(n / 2)));
    (value > PERIOD_CORRELATION).then_some(period)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_signal_turns_at_its_extremes_and_not_in_its_noise() {
        let triangle = |i: usize| if i % 200 < 100 { i % 200 } else { 200 - i % 200 } as f64;
        let noise = |i: usize| 0.8 * (12.9898 * i as f64).sin();
        let legs = stretches(&trend(&(0..800).map(|i| triangle(i) + noise(i)).collect::<Vec<_>>()));
        assert_eq!(legs.len(), 8, "{legs:?}");
        assert!(legs.iter().all(|leg| leg.len().abs_diff(100) < 5), "{legs:?}");
    }

    #[test]
    fn swings_on_the_way_are_no_motion_the_other_way() {
        let swinging = |size: f64| {
            let position: Vec<f64> =
                (0..2000).map(|i| 1e-3 * f64::from(i) + size * (0.02 * f64::from(i)).sin()).collect();
            let velocity: Vec<f64> = position.windows(2).map(|w| w[1] - w[0]).collect();
            without_swings(direction(&velocity, 0.0), &position[1..], &[0])
        };
        assert!(swinging(0.051).iter().all(|d| *d == 1.0));
        assert!(swinging(0.2).contains(&-1.0), "a tenth of the way back and forth");
    }

    #[test]
    fn a_period_is_found_in_short_and_long_signals() {
        for (period_rows, rows) in [(50, 3_000), (1_237, 4_100), (20_011, 200_000)] {
            let turn = std::f64::consts::TAU / period_rows as f64;
            let signal: Vec<f64> =
                (0..rows).map(|i| (turn * i as f64).sin() + 0.4 * (turn * 3.0 * i as f64).cos()).collect();
            let found = period(&signal).unwrap();
            assert!(found.abs_diff(period_rows) * 100 <= period_rows, "{found} instead of {period_rows}");
        }
        assert_eq!(period(&(0..50_000).map(|i| (f64::from(i) * 1e-4).exp()).collect::<Vec<_>>()), None);
    }
}
