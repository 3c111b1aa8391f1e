//! Resampling to an even rate, which filters, derivatives and hysteresis operators require.

use crate::preprocess::filter::LowPass;

/// Largest sample rate for the computation of nonlinear columns [Hz].
const WORK_HZ: f64 = 500.0;

/// A run with more samples is resampled to a lower rate, at least [`LEAST_HZ`].
const MOST_SAMPLES: f64 = 150_000.0;
const LEAST_HZ: f64 = 100.0;

/// Tolerance of even sample times, as a share of the step.
const EVEN: f64 = 1e-3;

/// Columns at the work rate.
pub struct Even {
    pub columns: Vec<Vec<f64>>,
    pub time_s: Vec<f64>,
    pub step_s: f64,
    /// First samples of recordings.
    pub starts: Vec<usize>,
    /// The original sample at, or just before, each new sample.
    pub source: Vec<usize>,
    /// Original samples for each new sample.
    pub every: usize,
}

/// Linearly interpolated columns, low-pass filtered and decimated together.
pub fn even(columns: &[&[f64]], time_s: &[f64], starts: &[usize], step_s: f64) -> Even {
    let rate_hz = 1.0 / step_s;
    let most_hz = WORK_HZ.min((MOST_SAMPLES * rate_hz / time_s.len() as f64).max(LEAST_HZ));
    let every = ((rate_hz / most_hz).round() as usize).max(1);
    let mut out = Even {
        columns: vec![Vec::new(); columns.len()],
        time_s: Vec::new(),
        step_s: step_s * every as f64,
        starts: Vec::new(),
        source: Vec::new(),
        every,
    };
    let filter = (every > 1).then(|| LowPass::butterworth(4, 0.8 / every as f64));
    for (start, end) in starts.iter().zip(starts.iter().skip(1).chain([&time_s.len()])) {
        let times = &time_s[*start..*end];
        let places = places(times, step_s);
        out.starts.push(out.time_s.len());
        out.time_s.extend((0..places.len()).step_by(every).map(|i| times[0] + i as f64 * step_s));
        out.source.extend(places.iter().step_by(every).map(|(sample, _)| start + sample));
        let uneven: Vec<Vec<f64>> = columns.iter().map(|c| at(&c[*start..*end], &places)).collect();
        let views: Vec<&[f64]> = uneven.iter().map(Vec::as_slice).collect();
        let smooth = filter.as_ref().map(|filter| filter.each_both_ways(&views, 12 * every));
        for (column, values) in out.columns.iter_mut().zip(smooth.as_ref().unwrap_or(&uneven)) {
            column.extend(values.iter().step_by(every));
        }
    }
    out
}

/// The sample before each moment of an even rate, and the interpolation weight of the next one.
fn places(time_s: &[f64], step_s: f64) -> Vec<(usize, f64)> {
    let count = ((time_s[time_s.len() - 1] - time_s[0]) / step_s + EVEN).floor() as usize + 1;
    let mut sample = 0;
    (0..count)
        .map(|i| {
            let moment_s = time_s[0] + i as f64 * step_s;
            while sample + 2 < time_s.len() && time_s[sample + 1] <= moment_s {
                sample += 1;
            }
            if time_s.len() == 1 {
                return (0, 0.0);
            }
            let share = ((moment_s - time_s[sample]) / (time_s[sample + 1] - time_s[sample])).clamp(0.0, 1.0);
            // A moment on a sample gets the value of that sample.
            let share = if share < EVEN {
                0.0
            } else if share > 1.0 - EVEN {
                1.0
            } else {
                share
            };
            (sample, share)
        })
        .collect()
}

fn at(values: &[f64], places: &[(usize, f64)]) -> Vec<f64> {
    let next = |sample: usize| values[(sample + 1).min(values.len() - 1)];
    places.iter().map(|(sample, share)| values[*sample] + share * (next(*sample) - values[*sample])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uneven_samples_of_a_slow_wave_become_even_ones() {
        let time_s: Vec<f64> = (0..4000).map(|i| f64::from(i) * 1e-3 + 3e-4 * f64::from(i % 3)).collect();
        let wave: Vec<f64> = time_s.iter().map(|t| (5.0 * t).sin()).collect();
        let even = even(&[&wave], &time_s, &[0, 2000], 1e-3);
        assert_eq!((even.every, even.starts.len(), even.step_s), (2, 2, 2e-3));
        let middle = |i: &usize| (50..950).contains(&(i % 1000));
        let off =
            (0..even.time_s.len()).filter(middle).map(|i| (even.columns[0][i] - (5.0 * even.time_s[i]).sin()).abs());
        assert!(off.fold(0.0, f64::max) < 1e-3);
    }
}
