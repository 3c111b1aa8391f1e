//! Amplitude spectrum by Welch's method: Hann windows that overlap by half, powers averaged (Welch, IEEE Trans. Audio 15, 1967).

use super::over_time::{stretches, usual_step_s};
use realfft::RealFftPlanner;
use std::f64::consts::TAU;
use std::ops::Range;

/// The shortest window of which a spectrum says something.
const SHORTEST: usize = 32;
/// A window of 16,384 rows resolves 0.06 Hz at 1 kHz; a longer one averages too little.
const LONGEST: usize = 1 << 14;

/// How large a sine at each frequency would have to be.
#[derive(Debug, Clone, PartialEq)]
pub struct Spectrum {
    pub frequency_hz: Vec<f64>,
    /// In the unit of the values: the amplitude of a sine.
    pub amplitude: Vec<f64>,
    /// Windows that were averaged.
    pub windows: usize,
}

/// Of values at about equal steps. `None` where no stretch without a pause or a missing value has 32 rows.
pub fn spectrum(time_s: &[f64], values: &[f64]) -> Option<Spectrum> {
    let step_s = usual_step_s(time_s);
    let whole: Vec<Range<usize>> = stretches(time_s).into_iter().flat_map(|rows| finite(rows, values)).collect();
    let most = whole.iter().map(Range::len).max().filter(|most| *most >= SHORTEST && step_s > 0.0)?;
    // Two windows and a half, where they are long enough to resolve anything: one alone averages nothing.
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
    // The two halves of the spectrum together, over the sum of the window.
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
