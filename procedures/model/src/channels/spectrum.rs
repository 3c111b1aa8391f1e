//! Amplitude spectrum by Welch's method: Hann windows that overlap by half, powers averaged (Welch, IEEE Trans. Audio 15, 1967).

use super::over_time::{stretches, usual_step_s};
use realfft::RealFftPlanner;
use std::f64::consts::TAU;
use std::ops::Range;

/// Shortest useful window.
const SHORTEST: usize = 32;
/// Longest window: 16,384 rows resolve 0.06 Hz at 1 kHz, and a longer window leaves too few averages.
const LONGEST: usize = 1 << 14;

/// Amplitude spectrum: the amplitude of a sine at each frequency.
#[derive(Debug, Clone, PartialEq)]
pub struct Spectrum {
    /// Frequencies from 0 to half the sample rate, equally spaced [Hz]; as many as amplitudes.
    pub frequency_hz: Vec<f64>,
    /// Amplitude of a sine, in the unit of the values.
    pub amplitude: Vec<f64>,
    /// Number of averaged windows.
    pub windows: usize,
}

/// Spectrum of values at nearly equal time steps. `None` without a stretch of 32 rows that has no pause and no
/// missing value.
pub fn spectrum(time_s: &[f64], values: &[f64]) -> Option<Spectrum> {
    let step_s = usual_step_s(time_s);
    let whole: Vec<Range<usize>> = stretches(time_s).into_iter().flat_map(|rows| finite(rows, values)).collect();
    let most = whole.iter().map(Range::len).max().filter(|most| *most >= SHORTEST && step_s > 0.0)?;
    // Half the stretch, if that is long enough, so that at least two windows are averaged.
    let length = previous_power_of_two(if most >= 4 * SHORTEST { most / 2 } else { most }).min(LONGEST);
    let window: Vec<f64> = (0..length).map(|i| 0.5 - 0.5 * (TAU * i as f64 / length as f64).cos()).collect();
    let transform = RealFftPlanner::<f64>::new().plan_fft_forward(length);
    let (mut input, mut output) = (transform.make_input_vec(), transform.make_output_vec());
    let mut powers = vec![0.0; output.len()];
    let mut windows = 0;
    for rows in whole {
        for begin in rows.clone().step_by(length / 2).take_while(|begin| begin + length <= rows.end) {
            let part = &values[begin..begin + length];
            let mean = part.iter().sum::<f64>() / length as f64;
            for ((place, value), weight) in input.iter_mut().zip(part).zip(&window) {
                *place = (value - mean) * weight;
            }
            transform.process(&mut input, &mut output).ok()?;
            powers.iter_mut().zip(&output).for_each(|(power, bin)| *power += bin.norm_sqr());
            windows += 1;
        }
    }
    // Both halves of the spectrum, divided by the sum of the window.
    let scale = 2.0 / window.iter().sum::<f64>();
    Some(Spectrum {
        frequency_hz: (0..powers.len()).map(|k| k as f64 / (length as f64 * step_s)).collect(),
        amplitude: powers.iter().map(|power| scale * (power / windows as f64).sqrt()).collect(),
        windows,
    })
}

/// Parts of the rows without a missing value.
fn finite(rows: Range<usize>, values: &[f64]) -> Vec<Range<usize>> {
    let parts = values[rows.clone()].split(|value| !value.is_finite());
    let mut begin = rows.start;
    parts
        .map(|part| {
            let range = begin..begin + part.len();
            begin = range.end + 1;
            range
        })
        .collect()
}

fn previous_power_of_two(n: usize) -> usize {
    1 << n.ilog2()
}
