//! The signals of a run for the effects: preprocessed, in SI units, one value for each point.
//!
//! A point is a steady-state chunk or a filtered sample. Hysteresis effects are simulated on the samples behind the
//! points and averaged over them.

use crate::signal::{Signal, Signals};
use crate::stats::summary::range;
use crate::thresholds::{LOAD_OF_DRIVE, LOADED_ROWS, SAME_TURNS};
use std::collections::BTreeSet;
use std::f64::consts::TAU;
use std::ops::Range;
use std::sync::Arc;

/// Constants of the set-up that effects use.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Constants {
    /// Pole pairs of the encoder from the set-up. `None` if not given.
    pub pole_pairs: Option<u32>,
    /// Number of poles of the brake from the set-up. `None` if not given.
    pub poles: Option<u32>,
    /// Rotor inertia from the set-up [kg·m²].
    pub rotor_inertia: Option<f64>,
    /// The axis slides, so that nothing is periodic in its position.
    pub slides: bool,
    /// Gravity torque that the measured load does not contain: approximate coefficients of cos and sin of the link
    /// angle [Nm].
    pub weight: Option<[f64; 2]>,
    /// For a run that is judged sample by sample: the filter passes waves up to this frequency and blocks waves of
    /// twice this frequency [Hz].
    pub followed_hz: Option<f64>,
    /// Its fastest speed without outliers [rad/s].
    pub speeds: Option<f64>,
    /// Range of reaches that its reversals can identify [rad].
    pub reaches: Option<[f64; 2]>,
    /// One side of the joint is clamped, and the motion of the other side is the twist itself.
    pub is_held: bool,
    /// RMS quantization error of the response, if it stays within the same encoder counts, as for a clamped joint.
    pub rounding: f64,
    /// Largest quantization error of the response: half a count of each of its encoders. Zero if unknown.
    pub half_counts: f64,
}

/// The first sample of a recording, with the loading history before it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Start {
    /// Index of the sample.
    pub at: usize,
    /// The last extreme of the signal before the recording. `None`: no loading history.
    pub past: Option<f64>,
}

impl From<usize> for Start {
    fn from(at: usize) -> Self {
        Self { at, past: None }
    }
}

/// Signals at the points, and the samples behind them.
#[derive(Debug, Clone, Default)]
pub struct View {
    /// Signals at the points.
    pub points: Signals,
    /// Signals at the samples behind the points; the same as `points` if points are samples.
    pub samples: Signals,
    /// The samples of each point. Empty if points are samples.
    pub chunks: Vec<Range<usize>>,
    /// First samples of recordings; the history before them is not in the run.
    pub starts: Vec<Start>,
    /// Time step of the samples [s].
    pub sample_s: f64,
    /// The measured load of each sample, if `samples` contains a smoothed one.
    pub measured_load: Option<Arc<Vec<f64>>>,
    /// Constants of the set-up and limits of the run.
    pub constants: Constants,
    zeros: Vec<f64>,
}

impl View {
    /// A view without constants and loading history. `starts` are the first samples of recordings, `sample_s` is in s.
    pub fn new(
        points: Signals,
        samples: Signals,
        chunks: Vec<Range<usize>>,
        starts: Vec<usize>,
        sample_s: f64,
    ) -> Self {
        let zeros = vec![0.0; points.len()];
        let starts = starts.into_iter().map(Start::from).collect();
        Self { points, samples, chunks, starts, sample_s, measured_load: None, constants: Constants::default(), zeros }
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        self.points.len()
    }

    /// Whether there are no points.
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    /// The signal at the points. `None` if it is missing.
    pub fn find(&self, signal: Signal) -> Option<&[f64]> {
        self.points.find(signal)
    }

    /// The signal at the points, or zeros if it is missing: an effect without its signals is never evaluated.
    pub fn get(&self, signal: Signal) -> &[f64] {
        self.points.find(signal).unwrap_or(&self.zeros)
    }

    /// All motion has one direction, so that effects with and without a sign change are confounded.
    pub fn is_one_directional(&self) -> bool {
        let direction = self.get(Signal::Direction);
        direction.first().is_some_and(|first| *first != 0.0 && direction.iter().all(|d| d == first))
    }

    /// Whether the link carries a measured load.
    pub fn bears_load(&self) -> bool {
        self.is_load(self.get(Signal::Load))
    }

    /// Whether a torque at the link is a load: one that is small relative to the motor torque is noise.
    pub fn is_load(&self, load: &[f64]) -> bool {
        let square: f64 = self.find(Signal::Drive).unwrap_or_default().iter().map(|v| v * v).sum();
        let least = LOAD_OF_DRIVE * (square / load.len().max(1) as f64).sqrt();
        load.iter().filter(|load| load.abs() > least).count() as f64 > LOADED_ROWS * load.len() as f64
    }

    /// Turns between the extremes of an angle.
    pub fn turns(&self, angle: Signal) -> f64 {
        let ends = range(self.get(angle));
        (ends.1 - ends.0) / TAU
    }

    /// Share of a turn that an angle covered.
    pub fn turned(&self, angle: Signal) -> f64 {
        const PARTS: f64 = 72.0;
        let part = |a: &f64| (a.rem_euclid(TAU) / TAU * PARTS) as usize;
        let parts: BTreeSet<usize> = self.samples.find(angle).unwrap_or_default().iter().map(part).collect();
        parts.len() as f64 / PARTS
    }

    /// Whether motor and link turn alike, without a gear between their angles.
    pub fn is_direct(&self) -> bool {
        (self.turns(Signal::Position) / self.turns(Signal::Link) - 1.0).abs() < SAME_TURNS
    }

    /// One column from one signal.
    pub fn map(&self, signal: Signal, f: impl Fn(f64) -> f64) -> Vec<f64> {
        self.get(signal).iter().map(|x| f(*x)).collect()
    }

    /// The mean of a curve over a signal. It differs from the curve at the mean if the curve bends within a point.
    pub fn mean_of(&self, signal: Signal, f: impl Fn(f64) -> f64) -> Vec<f64> {
        match self.samples.find(signal) {
            Some(samples) => self.average(samples.iter().map(|x| f(*x)).collect()),
            None => self.map(signal, f),
        }
    }

    /// One column from two signals.
    pub fn map2(&self, a: Signal, b: Signal, f: impl Fn(f64, f64) -> f64) -> Vec<f64> {
        self.get(a).iter().zip(self.get(b)).map(|(a, b)| f(*a, *b)).collect()
    }

    /// Largest absolute value.
    pub fn peak(&self, signal: Signal) -> f64 {
        self.get(signal).iter().fold(0.0, |m, x| x.abs().max(m))
    }

    /// A column of the samples, averaged over the points.
    pub fn average(&self, samples: Vec<f64>) -> Vec<f64> {
        if self.chunks.is_empty() {
            return samples;
        }
        self.chunks.iter().map(|c| samples[c.clone()].iter().sum::<f64>() / c.len().max(1) as f64).collect()
    }

    /// Mean of cos(h·angle) and sin(h·angle) over each point.
    ///
    /// At constant speed a chunk has n samples, each δ further. Its mean is the value at the middle times the
    /// Dirichlet kernel sin(n·h·δ/2)/(n·sin(h·δ/2)). A periodic effect is thus attenuated at speed as in the data.
    pub fn harmonic(&self, signal: Signal, order: f64) -> [Vec<f64>; 2] {
        let angle = self.get(signal);
        let mut cos = Vec::with_capacity(angle.len());
        let mut sin = Vec::with_capacity(angle.len());
        let steps = self.samples.find(signal);
        let speed = self.phase_step(signal);
        for (i, a) in angle.iter().enumerate() {
            let fade = match (self.chunks.get(i), steps) {
                (Some(chunk), Some(samples)) if chunk.len() > 1 => {
                    let step = (samples[chunk.end - 1] - samples[chunk.start]) / (chunk.len() - 1) as f64;
                    dirichlet(chunk.len() as f64, order * step)
                }
                _ => speed.as_ref().map_or(1.0, |speed| (2.0 - order * speed[i]).clamp(0.0, 1.0)),
            };
            let (s, c) = (order * a).sin_cos();
            cos.push(c * fade);
            sin.push(s * fade);
        }
        [cos, sin]
    }

    /// Turns in a second relative to `followed_hz`. `None` if points are means.
    fn phase_step(&self, angle: Signal) -> Option<Vec<f64>> {
        let followed = self.constants.followed_hz?;
        let values = self.get(angle);
        let last = values.len().saturating_sub(1);
        let step = |i: usize| {
            let (low, high) = (i.saturating_sub(1), (i + 1).min(last));
            (values[high] - values[low]).abs() / ((high - low).max(1) as f64 * self.sample_s)
        };
        Some((0..values.len()).map(|i| step(i) / (TAU * followed)).collect())
    }
}

fn dirichlet(n: f64, step: f64) -> f64 {
    let below = (0.5 * step).sin();
    if below.abs() < 1e-9 { 1.0 } else { (0.5 * n * step).sin() / (n * below) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_harmonic_fades_as_its_samples_do() {
        let angle: Vec<f64> = (0..40).map(|i| 0.3 + 0.17 * f64::from(i)).collect();
        let chunks: Vec<_> = (0..4).map(|c| c * 10..(c + 1) * 10).collect();
        let mut samples = Signals::new(40);
        samples.set(Signal::Link, angle.clone());
        let mean = |c: &Range<usize>| angle[c.clone()].iter().sum::<f64>() / 10.0;
        let mut points = Signals::new(4);
        points.set(Signal::Link, chunks.iter().map(mean).collect());
        let view = View::new(points, samples, chunks, vec![0], 0.004);
        let [cos, _] = view.harmonic(Signal::Link, 3.0);
        let truth = view.average(angle.iter().map(|a| (3.0 * a).cos()).collect());
        for (c, t) in cos.iter().zip(truth) {
            assert!((c - t).abs() < 1e-12, "{c} {t}");
        }
    }
}
