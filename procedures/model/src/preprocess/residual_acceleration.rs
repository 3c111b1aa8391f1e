//! Residual acceleration of steady-state motion: a slow step over gear teeth oscillates about its speed, and after a
//! ramp the drive still approaches its speed.

use crate::linear::basis::dot;
use crate::preprocess::design::segments;
use crate::stats::summary::median;
use crate::thresholds::{NOISE_ERRORS, OSCILLATION};
use std::ops::Range;

/// The speed at the edge of a chunk is the slope of the position over about this time [s].
const EDGE_S: f64 = 0.004;
/// In fewer chunks of a stretch the correlation is accidental.
const FEWEST: usize = 10;

/// Mean acceleration over every chunk. In a stretch (`group`) with oscillating motion it is computed for all chunks,
/// in other stretches only for chunks with a significant acceleration. Otherwise it is zero, because it would be the
/// noise of the position. It is derived from the position, because the velocity of a drive is delayed. The speeds at
/// both ends of a chunk give its mean acceleration.
pub fn accelerations(
    time_s: &[f64],
    position: &[f64],
    step_s: f64,
    chunks: &[Range<usize>],
    group: &[usize],
) -> Vec<f64> {
    let half = ((EDGE_S / step_s).round() as usize).div_ceil(2).max(1);
    let speed = |edge: usize, by: isize| {
        let from = edge.checked_sub(half)?.checked_add_signed(by)?;
        let to = from + 2 * half - 1;
        let lasts_s = time_s.get(to)? - time_s[from];
        (lasts_s < (2 * half) as f64 * step_s).then(|| (position[to] - position[from]) / lasts_s)
    };
    // Mean of the slopes `apart` samples before and after an edge.
    let around = |edge: usize, apart: isize| Some((speed(edge, -apart)? + speed(edge, apart)?) / 2.0);
    let of = |apart: isize| -> Vec<f64> {
        let change = |c: &Range<usize>| Some(around(c.end, apart)? - around(c.start, apart)?);
        chunks.iter().map(|c| change(c).unwrap_or(0.0) / (c.len() as f64 * step_s)).collect()
    };
    let (mut at_edges, neighbours) = (of(0), [of(2 * half as isize), of(2 * half as isize + 1)]);
    for stretch in segments::stretches(group) {
        // An oscillation is in phase with its neighbours, or in antiphase.
        let wavers =
            neighbours.iter().any(|b| correlation(&at_edges[stretch.clone()], &b[stretch.clone()]).abs() > OSCILLATION);
        if stretch.len() < FEWEST || !wavers {
            let pairs = at_edges[stretch.clone()].iter().zip(&neighbours[0][stretch.clone()]);
            let scatter = median(pairs.map(|(at, neighbours)| (*at - neighbours).abs()));
            for (at, neighbours) in at_edges[stretch.clone()].iter_mut().zip(&neighbours[0][stretch]) {
                if at.abs().min(neighbours.abs()) <= NOISE_ERRORS * scatter || at.signum() != neighbours.signum() {
                    *at = 0.0;
                }
            }
        }
    }
    at_edges
}

/// Correlation about zero.
fn correlation(a: &[f64], b: &[f64]) -> f64 {
    dot(a, b) / (dot(a, a) * dot(b, b)).sqrt().max(f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn count(position: f64) -> f64 {
        let count = std::f64::consts::TAU / 16384.0;
        (position / count).round() * count
    }

    fn chunks() -> Vec<Range<usize>> {
        (0..50).map(|k| 4 + 10 * k..14 + 10 * k).collect()
    }

    /// Result for a motion at 250 Hz, with an encoder of 14 bits.
    fn found_of(position: impl Fn(f64) -> f64) -> Vec<f64> {
        let time_s: Vec<f64> = (0..510).map(|i| f64::from(i) * 0.004).collect();
        let position: Vec<f64> = time_s.iter().map(|t| count(position(*t))).collect();
        accelerations(&time_s, &position, 0.004, &chunks(), &[0; 50])
    }

    /// Found and exact acceleration for a speed of 10 rad/s with an oscillation of this amplitude and frequency.
    fn found(wave_rad_s: f64, w: f64) -> (Vec<f64>, Vec<f64>) {
        let speed = |sample: usize| wave_rad_s * (w * (sample as f64 - 0.5) * 0.004).sin();
        let exact = chunks().iter().map(|c| (speed(c.end) - speed(c.start)) / 0.04).collect();
        (found_of(|t| 10.0 * t - wave_rad_s / w * (w * t).cos()), exact)
    }

    #[test]
    fn a_step_that_wavers_accelerates() {
        for (w, of) in [(30.0, 0.9), (280.0, 0.7)] {
            let (found, exact) = found(1.0, w);
            let share = dot(&found, &exact) / dot(&exact, &exact);
            assert!(of < share && share < 1.01 && correlation(&found, &exact) > 0.97, "{w} rad/s: {share}");
        }
    }

    #[test]
    fn what_creeps_towards_its_speed_accelerates_as_long_as_that_shows() {
        // 3 % of 100 rad/s remain and decay with 80 ms.
        let found = found_of(|t| 100.0 * t + 3.0 * 0.08 * (-t / 0.08).exp());
        let exact = |k: usize| {
            3.0 * ((-(0.014 + 0.04 * k as f64) / 0.08).exp() - (-(0.054 + 0.04 * k as f64) / 0.08).exp()) / 0.04
        };
        for (k, found) in found.iter().enumerate().take(2) {
            assert!((found / exact(k) - 1.0).abs() < 0.25, "{k}: {found} for {}", exact(k));
        }
        let one_count = 1.01 * count(0.0004) / 0.004 / 0.04;
        assert!(found[10..].iter().all(|a| a.abs() <= one_count), "{found:?}");
    }

    #[test]
    fn the_steps_of_an_encoder_are_no_motion() {
        assert!(found(0.0, 30.0).0.iter().all(|a| *a == 0.0));
    }
}
