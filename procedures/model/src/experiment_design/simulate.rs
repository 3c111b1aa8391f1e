//! Simulation of a proposed run at the points of its evaluation.

use crate::experiment_design::separation::predict;
use crate::experiment_design::{Choice, Stretch};
use crate::preprocess::memo::Memo;
use crate::preprocess::sweeps::brake_torque_of_current;
use crate::preprocess::{Prepared, Problem, Reduce};
use crate::regression::two_stage_model::TwoStageModel;
use crate::signal::{Signal, Signals};
use crate::stats::summary::mean;
use crate::view::View;
use jointbench_instrument::Kind;
use std::collections::HashSet;
use std::sync::Arc;

/// More points of one stretch add little information, because its common noise is not averaged out. Encoder waves
/// need a finer spacing.
fn most_points(kind: Kind) -> usize {
    if kind == Kind::Encoder { 400 } else { 48 }
}

/// Pause before the run [s].
const PAUSE_S: f64 = 60.0;

/// Samples of the simulated run.
#[derive(Default)]
struct Samples {
    time_s: Vec<f64>,
    motor_rad: Vec<f64>,
    stretch: Vec<usize>,
    chunks: Vec<std::ops::Range<usize>>,
    block: Vec<usize>,
}

/// Points and samples are spaced as in the measured run, so that periodic effects are attenuated at speed as in the
/// data. The joint has the temperature of the end of that run, plus the warming of the choice. The run starts at the
/// same position. `gear`: turns of the motor for each turn of the link.
pub fn simulate(choice: &Choice, prepared: &Prepared, model: &TwoStageModel, gear: f64) -> Problem {
    let samples_of = sample_times(choice, prepared);
    let samples = signals(&samples_of, &choice.stretches, prepared, gear);
    let mut points = Signals::new(samples_of.chunks.len());
    for (signal, values) in samples.iter() {
        let mean = |c: &std::ops::Range<usize>| mean(&values[c.clone()]);
        points.set(signal, samples_of.chunks.iter().map(mean).collect());
    }
    let rows = samples_of.chunks.len();
    let mut view = View::new(points, samples, samples_of.chunks, vec![0], 1.0 / prepared.about.sample_rate_hz);
    view.constants = prepared.main.view.constants;
    let mut problem = Problem {
        view,
        target: vec![0.0; rows],
        sampled: Arc::default(),
        reduce: Reduce::Same,
        blocks: choice.stretches.len(),
        block: samples_of.block,
        fold: vec![0; rows],
        folds: 1,
        replicate_pairs: Vec::new(),
        different_history: HashSet::new(),
        different_angle: HashSet::new(),
        different_motion: None,
        segment: vec![0; rows],
        repeat: vec![0; rows],
        settled: true,
        form_error: None,
        bandwidths: Vec::new(),
        memo: Memo::default(),
    };
    // The drive torque follows from the response, and a part of the response can follow from the drive torque.
    problem.view.points.set(Signal::Drive, vec![0.0; rows]);
    problem.target = predict(&model.main, &problem);
    let drive = if prepared.kind == Kind::Brake { brake_torque_of_current(&problem) } else { problem.target.clone() };
    problem.view.points.set(Signal::Drive, drive);
    if prepared.kind == Kind::Brake {
        problem.target = predict(&model.main, &problem);
    }
    problem
}

fn sample_times(choice: &Choice, prepared: &Prepared) -> Samples {
    let about = &prepared.about;
    let sample_s = 1.0 / about.sample_rate_hz;
    // Neighbouring chunks of a long run were averaged.
    let chunks = &prepared.main.view.chunks;
    let averaged = chunks.iter().map(|c| c.len()).sum::<usize>() / chunks.len().max(1);
    let each = if about.chunk_s.is_some() { averaged.max(1) } else { 1 };
    let point_s = if about.chunk_s.is_some() { each } else { about.decimation } as f64 * sample_s;
    let mut samples_of = Samples::default();
    for (number, stretch) in choice.stretches.iter().enumerate() {
        let fits = (stretch.duration_s / point_s) as usize;
        let points = fits.clamp(1, most_points(prepared.kind));
        let stride_s = stretch.duration_s / points as f64;
        for point in 0..points {
            samples_of.chunks.push(samples_of.time_s.len()..samples_of.time_s.len() + each);
            samples_of.block.push(number);
            for sample in 0..each {
                let t_s = point as f64 * stride_s + (sample as f64 + 0.5) * sample_s;
                samples_of.time_s.push(stretch.start_s + t_s);
                samples_of.motor_rad.push(stretch.from_rad + stretch.velocity_rad_s * t_s);
                samples_of.stretch.push(number);
            }
        }
    }
    samples_of
}

/// Signals of the simulated run for the models of the kind.
fn signals(samples_of: &Samples, stretches: &[Stretch], prepared: &Prepared, gear: f64) -> Signals {
    let measured = &prepared.main.view.samples;
    let at = |signal, first: bool| {
        let values = measured.find(signal)?;
        if first { values.first().copied() } else { values.last().copied() }
    };
    // Position and velocity of the reported shaft, relative to the motor.
    let link = 1.0 / gear;
    let [turned, turning] = match prepared.kind {
        Kind::Friction | Kind::Encoder => [1.0, 1.0],
        Kind::Stiffness => [1.0, link],
        Kind::Brake => [link, link],
    };
    let each =
        |of: &dyn Fn(&Stretch) -> f64| -> Vec<f64> { samples_of.stretch.iter().map(|s| of(&stretches[*s])).collect() };
    let mut signals = Signals::new(samples_of.time_s.len());
    let before_s = at(Signal::Time, false).unwrap_or(0.0) + PAUSE_S;
    signals.set(Signal::Time, samples_of.time_s.iter().map(|t| before_s + t).collect());
    signals.set(Signal::Direction, each(&|s| s.velocity_rad_s.signum()));
    if prepared.kind == Kind::Friction {
        signals.set(Signal::Acceleration, each(&|_| 0.0));
        signals.set(Signal::Jerk, each(&|_| 0.0));
    }
    if prepared.kind == Kind::Brake {
        // Whether the current rises or falls.
        let before = |s: usize| s.checked_sub(1).map_or(0.0, |s| stretches[s].brake_current_a);
        let rises: Vec<f64> =
            stretches.iter().enumerate().map(|(i, s)| (s.brake_current_a - before(i)).signum()).collect();
        signals.set(Signal::Direction, samples_of.stretch.iter().map(|s| rises[*s]).collect());
        signals.set(Signal::Current, each(&|s| s.brake_current_a));
    }
    let mut set = |signal: Signal, values: Vec<f64>| {
        if measured.find(signal).is_some() {
            signals.set(signal, values);
        }
    };
    let from_rad = at(Signal::Position, true).unwrap_or(0.0);
    let link_rad = at(Signal::Link, true).unwrap_or(0.0);
    set(Signal::Link, samples_of.motor_rad.iter().map(|q| link_rad + link * q).collect());
    set(Signal::Position, samples_of.motor_rad.iter().map(|q| from_rad + turned * q).collect());
    set(Signal::Velocity, each(&|s| turning * s.velocity_rad_s));
    set(Signal::Load, each(&|s| s.load_nm / prepared.load_scale));
    let temperature_c = at(Signal::Temperature, false).unwrap_or(0.0);
    set(Signal::Temperature, each(&|s| temperature_c + s.warmer_k));
    set(Signal::Repeat, each(&|s| f64::from(s.power_ups)));
    // Columns that are not controlled keep their last value.
    for (signal, values) in measured.iter().filter(|(signal, _)| matches!(signal, Signal::Column(_))) {
        signals.set(signal, vec![values.last().copied().unwrap_or(0.0); samples_of.time_s.len()]);
    }
    signals
}
