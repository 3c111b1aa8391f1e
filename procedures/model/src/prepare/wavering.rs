//! What settled motion accelerates all the same: a slow step over teeth wavers about its speed.

use super::segments;
use crate::linear::dot;
use std::ops::Range;

/// The speed at the edge of a chunk is the slope of the position over about so long.
const EDGE_S: f64 = 0.004;
/// So well it follows the slopes beside it, of no common sample, where the motion itself wavers.
const FOLLOWS: f64 = 0.9;
/// Fewer chunks of a stretch follow by accident.
const FEWEST: usize = 10;

/// Mean acceleration over every chunk, in stretches (`group`) in which the motion wavers; zero in all others, where it would
/// be the noise of the position. From the position, since the velocity of a drive is late: over a chunk the speeds at both
/// its ends say it all.
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
    // The mean of the slopes `apart` samples before and behind an edge.
    let around = |edge: usize, apart: isize| Some((speed(edge, -apart)? + speed(edge, apart)?) / 2.0);
    let of = |apart: isize| -> Vec<f64> {
        let change = |c: &Range<usize>| Some(around(c.end, apart)? - around(c.start, apart)?);
        chunks.iter().map(|c| change(c).unwrap_or(0.0) / (c.len() as f64 * step_s)).collect()
    };
    let (mut at_edges, beside) = (of(0), [of(2 * half as isize), of(2 * half as isize + 1)]);
    for stretch in segments::stretches(group) {
        // A wave is in step with what is beside it, or turned over.
        let wavers =
            beside.iter().any(|b| correlation(&at_edges[stretch.clone()], &b[stretch.clone()]).abs() > FOLLOWS);
        if stretch.len() < FEWEST || !wavers {
            at_edges[stretch].fill(0.0);
        }
    }
    at_edges
}

/// About zero.
fn correlation(a: &[f64], b: &[f64]) -> f64 {
    dot(a, b) / (dot(a, a) * dot(b, b)).sqrt().max(f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Found and exact, of a speed of 10 rad/s that wavers by so much so fast, at 250 Hz, with an encoder of 14 bits.
    fn found(wave_rad_s: f64, w: f64) -> (Vec<f64>, Vec<f64>) {
        let time_s: Vec<f64> = (0..510).map(|i| f64::from(i) * 0.004).collect();
        let count = std::f64::consts::TAU / 16384.0;
        let position: Vec<f64> =
            time_s.iter().map(|t| ((10.0 * t - wave_rad_s / w * (w * t).cos()) / count).round() * count).collect();
        let chunks: Vec<Range<usize>> = (0..50).map(|k| 4 + 10 * k..14 + 10 * k).collect();
        let speed = |sample: usize| wave_rad_s * (w * (sample as f64 - 0.5) * 0.004).sin();
        let exact = chunks.iter().map(|c| (speed(c.end) - speed(c.start)) / 0.04).collect();
        (accelerations(&time_s, &position, 0.004, &chunks, &[0; 50]), exact)
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
    fn the_steps_of_an_encoder_are_no_motion() {
        assert!(found(0.0, 30.0).0.iter().all(|a| *a == 0.0));
    }
}
