//! A run that has not been made, at the points at which it would be judged.

use super::Choice;
use super::design::predict;
use crate::assembly::Assembly;
use crate::prepare::{Prepared, Problem, Reduce};
use crate::view::{Signal, Signals, View};

/// More points of one stretch say little more: what one stretch has in common is not averaged away.
const MOST_POINTS: usize = 48;

/// The pause before the run [s].
const PAUSE_S: f64 = 60.0;

/// Points are spaced as those of the run at hand, and so are the samples behind them: a periodic effect fades at speed as
/// it would in the data. The joint is as warm as it was at the end of that run; it starts where that one started.
pub fn imagine(choice: &Choice, prepared: &Prepared, model: &Assembly) -> Problem {
    let about = &prepared.about;
    let sample_s = 1.0 / about.sample_rate_hz;
    // Neighbouring chunks of a long run were averaged.
    let chunks = &prepared.main.view.chunks;
    let averaged = chunks.iter().map(|c| c.len()).sum::<usize>() / chunks.len().max(1);
    let each = if about.chunk_s.is_some() { averaged.max(1) } else { 1 };
    let point_s = if about.chunk_s.is_some() { each } else { about.decimation } as f64 * sample_s;
    let measured = &prepared.main.view.samples;
    let at = |signal, first: bool| {
        let values = measured.find(signal)?;
        if first { values.first().copied() } else { values.last().copied() }
    };
    let (before_s, from_rad) = (at(Signal::Time, false).unwrap_or(0.0), at(Signal::Position, true).unwrap_or(0.0));
    let link = at(Signal::Link, true).unwrap_or(0.0) - from_rad / prepared.load_scale;

    let (mut time, mut position, mut velocity, mut load) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let (mut chunks, mut block) = (Vec::new(), Vec::new());
    for (number, stretch) in choice.stretches.iter().enumerate() {
        let fits = (stretch.duration_s / point_s) as usize;
        let points = fits.clamp(1, MOST_POINTS);
        let stride_s = stretch.duration_s / points as f64;
        for point in 0..points {
            chunks.push(time.len()..time.len() + each);
            block.push(number);
            for sample in 0..each {
                let t_s = point as f64 * stride_s + (sample as f64 + 0.5) * sample_s;
                time.push(before_s + PAUSE_S + stretch.start_s + t_s);
                position.push(from_rad + stretch.from_rad + stretch.velocity_rad_s * t_s);
                velocity.push(stretch.velocity_rad_s);
                load.push(stretch.load_nm / prepared.load_scale);
            }
        }
    }
    let n = time.len();
    let mut samples = Signals::new(n);
    samples.set(Signal::Time, time);
    samples.set(Signal::Direction, velocity.iter().map(|v: &f64| v.signum()).collect());
    samples.set(Signal::Velocity, velocity);
    samples.set(Signal::Acceleration, vec![0.0; n]);
    samples.set(Signal::Jerk, vec![0.0; n]);
    samples.set(Signal::Link, position.iter().map(|q| link + q / prepared.load_scale).collect());
    samples.set(Signal::Position, position);
    if measured.find(Signal::Load).is_some() {
        samples.set(Signal::Load, load);
    }
    if let Some(temperature_c) = at(Signal::Temperature, false) {
        samples.set(Signal::Temperature, vec![temperature_c; n]);
    }

    let mut points = Signals::new(chunks.len());
    for signal in Signal::ALL {
        let Some(values) = samples.find(signal) else { continue };
        let mean = |c: &std::ops::Range<usize>| values[c.clone()].iter().sum::<f64>() / c.len() as f64;
        points.set(signal, chunks.iter().map(mean).collect());
    }
    let rows = chunks.len();
    let mut view = View::new(points, samples, chunks, vec![0], sample_s);
    view.constants = prepared.main.view.constants;
    let mut problem = Problem {
        view,
        target: vec![0.0; rows],
        reduce: Reduce::Same,
        blocks: choice.stretches.len(),
        block,
        fold: vec![0; rows],
        folds: 1,
        twins: Vec::new(),
        unlike: None,
        segment: vec![0; rows],
        repeat: vec![0; rows],
        settled: true,
    };
    problem.target = predict(&model.main, &problem);
    problem.view.points.set(Signal::Drive, problem.target.clone());
    problem
}
