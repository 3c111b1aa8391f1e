//! Trajectories: filtered and decimated samples, of motion that is never cut.
//!
//! Parallel filtering after Gautier 1997. Two filters with zero phase: a light one on all signals before anything nonlinear
//! is made of them, and a lower one on every finished column and on the torque, before one of n samples is kept. Motion comes
//! from the position alone, so that nothing lags behind it.

use crate::decision::solved::Solved;
use crate::linear::basis::dot;
use crate::preprocess::design::replicates::{Same, are_apart};
use crate::preprocess::design::{blocks, replicates, segments};
use crate::preprocess::filter::{LowPass, by_recording, derivative};
use crate::preprocess::form_error::{ErrorColumn, FormError, Lives};
use crate::preprocess::friction::bristles::{self, quantile};
use crate::preprocess::friction::unmeasured_gravity;
use crate::preprocess::friction::work_rate::{Even, even};
use crate::preprocess::{Prepared, Problem, Reduce, median, sample_s};
use crate::report::fit::{Bristles, Preparation};
use crate::signal::{Signal, Signals};
use crate::view::{Constants, View};
use crate::{ModelError, Options, ResidualKind};
use jointbench_instrument::{Motion, RunTable};
use rayon::prelude::*;
use std::collections::HashSet;
use std::sync::Arc;

/// Corner of the filter of finished columns [Hz]: bearings, gears and drives of joints resonate above it.
const CUTOFF_HZ: f64 = 6.0;
/// Corners that an interval has to hold for as well, as shares of that.
const OTHER_CUTOFFS: [f64; 2] = [0.5, 5.0 / 3.0];
/// Corner of the filter of signals [Hz], and of the slow ones among them.
const SIGNAL_HZ: f64 = 40.0;
const SLOW_HZ: f64 = 1.0;
const UNKNOWN_HZ: f64 = 5.0;
/// Shares of the sample rate that the two corners stay below.
const MOST_OF_RATE: f64 = 0.2;
const MOST_OF_RATE_SIGNALS: f64 = 0.35;
/// Rows for each period of the corner.
const ROWS: f64 = 4.0;
/// Of a longer run fewer are kept, down to two for each period.
const MOST_ROWS: f64 = 12_000.0;
/// The ends of a recording are where filters guess [s], or this share of it.
const ENDS_S: f64 = 0.4;
const ENDS_SHARE: f64 = 0.05;
/// Pieces of a run that are held out in turn: so many of at least a second, and at least so many.
const BLOCKS: usize = 30;
const LEAST_BLOCKS: usize = 8;
const BLOCK_S: f64 = 1.0;
/// The direction turns within so many times the noise of the velocity, or this share of the fastest.
const NOISES: f64 = 2.0;
const LEAST_SPEED: f64 = 1e-4;

/// The run at the work rate.
struct Work {
    signals: Signals,
    torque: Vec<f64>,
    even: Even,
    turns: Vec<usize>,
    encoder_step: f64,
    fastest: f64,
}

pub fn prepare(run: &RunTable, options: &Options, given: Option<&Bristles>) -> Result<Prepared, ModelError> {
    let mut work = read(run)?;
    let rate_hz = 1.0 / work.even.step_s;
    let cutoff_hz = corner(options, rate_hz)?;
    let whole = work.torque.len() as f64 * work.even.step_s * cutoff_hz;
    let rows = ROWS.min((MOST_ROWS / whole).max(2.0));
    let every = match options.decimation {
        Some(every) => (every as f64 / work.even.every as f64).round(),
        None => (rate_hz / (rows * cutoff_hz)).round(),
    };
    let every = (every as usize).max(1);
    let velocity = work.signals.find(Signal::Velocity).unwrap_or_default().to_vec();
    let band = given.map_or_else(|| noise(&velocity, &work, cutoff_hz), |given| given.band_rad_s);
    let direction = match work.turns.is_empty() {
        true => vec![velocity.iter().sum::<f64>().signum(); velocity.len()],
        false => velocity.iter().map(|w| (w / band).tanh()).collect(),
    };
    work.signals.set(Signal::Direction, direction);
    let drive = crate::preprocess::friction::drive(&work.signals, &work.torque);
    work.signals.set(Signal::Drive, drive);
    let position = work.signals.find(Signal::Position).unwrap_or_default();
    let reaches = match given {
        Some(given) => given.reaches_rad.clone(),
        None => bristles::reaches(position, &work.even.starts, &work.turns, work.encoder_step),
    };
    let states = bristles::states(position, &work.even.starts, &reaches);
    let layout = Layout::new(&work, &states, cutoff_hz, every, run);
    if layout.rows.len() < 24 {
        return Err(ModelError::TooFewSamples { usable: layout.rows.len(), needed: 24, what: "filtered rows" });
    }
    let mut bristles = Bristles { reaches_rad: reaches, weights: Vec::new(), band_rad_s: band };
    bristles.weights = given.map_or_else(|| layout.weights(&work, &run.meta().baseline), |given| given.weights.clone());
    let mut view =
        View::new(work.signals.clone(), work.signals.clone(), Vec::new(), work.even.starts.clone(), work.even.step_s);
    view.constants = constants(&work, &bristles, cutoff_hz, run);
    let others: Vec<Layout> = (OTHER_CUTOFFS.map(|share| share * cutoff_hz).into_iter())
        .filter(|other_hz| *other_hz < MOST_OF_RATE * rate_hz)
        .map(|other_hz| {
            Layout::new(&work, &states, other_hz, (rate_hz / (rows * other_hz)).round().max(1.0) as usize, run)
        })
        .collect();
    let problem = |view: &View| {
        let mut main = layout.problem(&work, view);
        main.bandwidths = others.iter().map(|layout| layout.problem(&work, view)).collect();
        main
    };
    let main = problem(&view);
    let bristled = (!states.is_empty()).then(|| {
        let mut view = view.clone();
        let felt = bristles::felt(&states, &bristles);
        view.points.set(Signal::Direction, felt.clone());
        view.samples.set(Signal::Direction, felt);
        problem(&view)
    });
    let about = Preparation {
        residual: ResidualKind::Raw,
        sample_rate_hz: 1.0 / sample_s(run.column("time_s").unwrap_or_default()),
        cutoff_hz: Some(cutoff_hz),
        velocity_lag_s: None,
        decimation: every * work.even.every,
        chunk_s: None,
        samples: run.len(),
        rows: main.rows(),
        blocks: main.blocks,
        segments_from: if layout.segment.is_some() { "column" } else { "found" }.into(),
        repeats_from: layout.repeats_from.into(),
        bristles: Some(bristles),
    };
    Ok(Prepared {
        kind: run.kind(),
        motion: run.meta().motion,
        baseline: run.meta().baseline.clone(),
        load_scale: run.meta().gear_ratio.unwrap_or(1.0),
        constants: crate::preprocess::constants(run),
        clashes: crate::preprocess::checks::unit_mismatch::clashes(run),
        doubts: crate::preprocess::checks::metadata::doubts(run),
        main,
        bristled,
        moving: None,
        memory: None,
        about,
    })
}

/// What was asked for, or the usual corner where the rate allows it.
fn corner(options: &Options, rate_hz: f64) -> Result<f64, ModelError> {
    let highest_hz = 0.45 * rate_hz;
    match options.cutoff_hz {
        Some(cutoff_hz) if cutoff_hz > highest_hz => Err(ModelError::BadOption {
            option: "cutoff_hz",
            why: format!("the run is judged at {rate_hz:.0} samples in a second: expected at most {highest_hz:.0} Hz"),
        }),
        Some(cutoff_hz) => Ok(cutoff_hz),
        None => Ok(CUTOFF_HZ.min(MOST_OF_RATE * rate_hz)),
    }
}

fn constants(work: &Work, bristles: &Bristles, cutoff_hz: f64, run: &RunTable) -> Constants {
    let ends = bristles.reaches_rad.first().zip(bristles.reaches_rad.last());
    Constants {
        slides: run.meta().motion == Motion::Linear,
        rotor_inertia: run.meta().rotor_inertia_kg_m2,
        weight: unmeasured_gravity::unmeasured(&work.signals, &work.torque),
        followed_hz: Some(2.0 * cutoff_hz),
        speeds: Some(work.fastest),
        reaches: ends.map(|(low, high)| [low.max(10.0 * work.encoder_step).min(*high), *high]),
        ..Constants::default()
    }
}

/// What the velocity has between the two corners.
fn noise(velocity: &[f64], work: &Work, cutoff_hz: f64) -> f64 {
    let smooth = filtered(velocity, &work.even, cutoff_hz, 2);
    let apart = median(velocity.iter().zip(&smooth).map(|(fast, slow)| (fast - slow).abs()));
    (NOISES * 1.4826 * apart).max(LEAST_SPEED * work.fastest).max(f64::MIN_POSITIVE)
}

fn filtered(values: &[f64], even: &Even, cutoff_hz: f64, order: usize) -> Vec<f64> {
    let filter = LowPass::butterworth(order, (2.0 * cutoff_hz * even.step_s).min(0.99));
    by_recording(values, &even.starts, |_, v| filter.both_ways(v, pad(cutoff_hz, even.step_s)))
}

/// Samples by which the ends of a recording are continued for a filter.
fn pad(cutoff_hz: f64, step_s: f64) -> usize {
    (1.0 / (cutoff_hz * step_s)).ceil() as usize
}

fn read(run: &RunTable) -> Result<Work, ModelError> {
    let column = |name: &str| run.column(name).unwrap_or_default();
    let needed = "torque_constant_nm_per_a";
    let km = run.meta().torque_constant_nm_per_a.ok_or(ModelError::MissingConstant { needed })?;
    let gear = run.meta().gear_ratio.unwrap_or(1.0);
    let (time_s, position) = (column("time_s"), column("motor_position_rad"));
    if position.iter().all(|q| *q == position[0]) {
        return Err(ModelError::Constant { column: "motor_position_rad".into() });
    }
    let step_s = sample_s(time_s);
    let starts = segments::recordings(time_s, position, step_s);
    let mut beside = Signals::new(run.len());
    crate::preprocess::unknown_columns::keep(&mut beside, run);
    let known =
        [("link_position_rad", Signal::Link), ("link_torque_nm", Signal::Load), ("temperature_c", Signal::Temperature)];
    let known = known.into_iter().filter_map(|(name, signal)| Some((signal, run.column(name)?)));
    let named: Vec<(Signal, &[f64])> = known.chain(beside.iter()).collect();
    let columns: Vec<&[f64]> =
        [position, column("motor_current_a")].into_iter().chain(named.iter().map(|(_, values)| *values)).collect();
    let mut even = even(&columns, time_s, &starts, step_s);
    let columns = std::mem::take(&mut even.columns);
    let signal_hz = SIGNAL_HZ.min(MOST_OF_RATE_SIGNALS / even.step_s);
    let corner = |signal: &Signal| match signal {
        Signal::Temperature => SLOW_HZ.min(signal_hz),
        Signal::Column(_) => UNKNOWN_HZ.min(signal_hz),
        _ => signal_hz,
    };
    let all: Vec<Signal> = [Signal::Position, Signal::Drive].into_iter().chain(named.iter().map(|n| n.0)).collect();
    let smooth: Vec<Vec<f64>> =
        columns.par_iter().zip(&all).map(|(c, signal)| filtered(c, &even, corner(signal), 2)).collect();
    let mut signals = Signals::new(even.time_s.len());
    let mut smooth = smooth.into_iter();
    let (position, current) = (smooth.next().unwrap_or_default(), smooth.next().unwrap_or_default());
    for (signal, values) in all.into_iter().skip(2).zip(smooth) {
        let factor = if signal == Signal::Load { 1.0 / gear } else { 1.0 };
        signals.set(signal, values.into_iter().map(|v| factor * v).collect());
    }
    if signals.find(Signal::Link).is_none() {
        signals.set(Signal::Link, position.iter().map(|q| q / gear).collect());
    }
    let slope = |values: &[f64]| by_recording(values, &even.starts, |range, v| derivative(&even.time_s[range], v));
    let velocity = slope(&position);
    let acceleration = slope(&velocity);
    let encoder_step = bristles::encoder_step(run.column("motor_position_rad").unwrap_or_default());
    let turns = bristles::turns(&position, &even.starts, encoder_step);
    let fastest = quantile(velocity.iter().map(|w| w.abs()), 0.995).max(f64::MIN_POSITIVE);
    signals.set(Signal::Jerk, slope(&acceleration));
    signals.set(Signal::Acceleration, acceleration);
    signals.set(Signal::Velocity, velocity);
    signals.set(Signal::Position, position);
    signals.set(Signal::Time, even.time_s.iter().map(|t| t - even.time_s[0]).collect());
    let torque = current.iter().map(|i| km * i).collect();
    Ok(Work { signals, torque, even, turns, encoder_step, fastest })
}

/// Which samples are rows at one corner, and what stands beside every model there.
struct Layout {
    reduce: Reduce,
    rows: Vec<usize>,
    row_s: f64,
    target: Vec<f64>,
    /// States of elements that remember, at the rows.
    states: Vec<Vec<f64>>,
    /// Acceleration, jerk, snap and the change of the load, at the rows.
    slopes: Vec<Vec<f64>>,
    segment: Option<Vec<i64>>,
    repeat: Vec<i64>,
    repeats_from: &'static str,
    phase: Vec<usize>,
    run: Vec<usize>,
}

impl Layout {
    fn new(work: &Work, states: &[Vec<f64>], cutoff_hz: f64, every: usize, run: &RunTable) -> Self {
        let even = &work.even;
        let whole = |values: Option<Vec<i64>>| values.map(|v| even.source.iter().map(|i| v[*i]).collect::<Vec<i64>>());
        let number = segments::runs(run);
        let run_of: Vec<usize> = even.source.iter().map(|s| number.partition_point(|first| first <= s) - 1).collect();
        let within = |r: &Vec<i64>| (1..r.len()).any(|i| r[i] != r[i - 1] && run_of[i] == run_of[i - 1]);
        let numbered = whole(segments::integers(run, "repeat")).filter(within);
        let velocity = work.signals.find(Signal::Velocity).unwrap_or_default();
        let single = even.starts.len() == number.len();
        let (repeat, phase, repeats_from) = match numbered {
            Some(repeat) => {
                let phase = phases(&repeat, &run_of);
                (repeat, phase, "column")
            }
            None => periods(velocity, &run_of, single),
        };
        let rows = rows(even, &phase, every);
        let filter = LowPass::butterworth(2, (2.0 * cutoff_hz * even.step_s).min(0.99));
        let reduce = Reduce::Pick {
            filter,
            pad: pad(cutoff_hz, even.step_s),
            rows: rows.clone().into(),
            starts: even.starts.clone().into(),
        };
        let slope = |values: &[f64]| by_recording(values, &even.starts, |range, v| derivative(&even.time_s[range], v));
        let of = |signal| work.signals.find(signal).map(<[f64]>::to_vec).unwrap_or_default();
        let snap = slope(&of(Signal::Jerk));
        let mut slopes = vec![of(Signal::Acceleration), of(Signal::Jerk), snap];
        slopes.extend(work.signals.find(Signal::Load).map(slope));
        let pick = |values: &[i64]| rows.iter().map(|row| values[*row]).collect::<Vec<i64>>();
        Self {
            row_s: every as f64 * even.step_s,
            target: reduce.apply(work.torque.clone()),
            states: reduce.apply_all(states.to_vec()),
            slopes: reduce.apply_all(slopes),
            segment: whole(segments::numbered(run)).map(|segment| pick(&segment)),
            repeat: pick(&repeat),
            repeats_from,
            phase: rows.iter().map(|row| (phase[*row] + every / 2) / every).collect(),
            run: rows.iter().map(|row| run_of[*row]).collect(),
            rows,
            reduce,
        }
    }

    /// What the torque at reversals says of the elements.
    fn weights(&self, work: &Work, baseline: &[String]) -> Vec<f64> {
        let is_given = |id: &str| baseline.iter().any(|given| given == id);
        let of = |signal| work.signals.find(signal).map(|values| self.reduce.apply(values.to_vec()));
        let mut free: Vec<Vec<f64>> = of(Signal::Velocity).into_iter().collect();
        free.push(self.slopes[0].clone());
        free.extend(is_given("direction_offset").then(|| vec![1.0; self.target.len()]));
        free.extend(is_given("signal_delay").then(|| self.slopes[1].clone()));
        let mut torque = self.target.clone();
        if let Some(load) = of(Signal::Load).filter(|_| is_given("load_transmission")) {
            torque.iter_mut().zip(load).for_each(|(torque, load)| *torque -= load);
        }
        bristles::weights(&self.states, &free, &torque)
    }

    fn problem(&self, work: &Work, view: &View) -> Problem {
        let n = self.rows.len();
        let count = ((n as f64 * self.row_s / BLOCK_S) as usize).clamp(LEAST_BLOCKS, BLOCKS);
        let block: Vec<usize> = (0..n).map(|row| row * count / n).collect();
        let way = |row: &usize| work.turns.partition_point(|turn| turn <= row);
        let mut problem = Problem {
            view: view.clone(),
            target: self.target.clone(),
            sampled: Arc::default(),
            reduce: self.reduce.clone(),
            fold: block.clone(),
            folds: count,
            blocks: count,
            block,
            replicate_pairs: blocks::replicate_pairs(&self.run, &self.phase, &self.repeat, 0),
            different_history: HashSet::new(),
            different_angle: HashSet::new(),
            unlike: None,
            segment: self.segment.clone().unwrap_or_else(|| self.rows.iter().map(|row| way(row) as i64).collect()),
            repeat: self.repeat.clone(),
            settled: false,
            form_error: Some(Arc::new(self.form_error(work, view))),
            bandwidths: Vec::new(),
            solved: Solved::default(),
        };
        let of = problem.repeat.clone();
        replicates::believe(&mut problem, &of, &[Signal::Velocity, Signal::Load].map(Same::Value));
        let link = problem.reduce.apply(view.get(Signal::Link).to_vec());
        if are_apart(&problem.replicate_pairs, &link) {
            problem.different_angle = problem.replicate_pairs.iter().copied().collect();
        }
        problem
    }

    fn form_error(&self, work: &Work, view: &View) -> FormError {
        let direction = self.reduce.apply(view.get(Signal::Direction).to_vec());
        let rms = |values: &[f64]| (dot(values, values) / values.len().max(1) as f64).sqrt();
        let bristle = |state: &Vec<f64>| ErrorColumn {
            lives: Lives::Bristle,
            values: state.iter().zip(&direction).map(|(z, s)| z - s).collect(),
            scale: rms(state),
        };
        let slopes = [Lives::Jerk, Lives::Snap, Lives::LoadRate].into_iter().zip(&self.slopes[1..]);
        let slopes = slopes.map(|(lives, values)| ErrorColumn { lives, values: values.clone(), scale: rms(values) });
        let size = |values: &[f64]| values.iter().map(|v| v.abs()).collect();
        let to_turn = |row: &usize| {
            let next = work.turns.partition_point(|turn| turn < row);
            let near = [next.checked_sub(1), Some(next)].into_iter().flatten().filter_map(|turn| work.turns.get(turn));
            near.map(|turn| turn.abs_diff(*row) as f64 * work.even.step_s).fold(f64::INFINITY, f64::min)
        };
        FormError {
            columns: self.states.iter().map(bristle).chain(slopes).collect(),
            turn_s: self.rows.iter().map(to_turn).collect(),
            swift: [size(&self.slopes[0]), size(&self.slopes[1])],
            row_s: self.row_s,
            sample_s: work.even.step_s / work.even.every as f64,
        }
    }
}

/// One of `every` samples, at the same moments of each repeat, without the ends of recordings.
fn rows(even: &Even, phase: &[usize], every: usize) -> Vec<usize> {
    let mut rows = Vec::new();
    for (start, end) in even.starts.iter().zip(even.starts.iter().skip(1).chain([&phase.len()])) {
        let ends = ((ENDS_S / even.step_s) as usize).min((ENDS_SHARE * (end - start) as f64) as usize);
        rows.extend((start + ends..end - ends).filter(|i| phase[*i].is_multiple_of(every)));
    }
    rows
}

/// Samples since the repeat began.
fn phases(repeat: &[i64], run_of: &[usize]) -> Vec<usize> {
    let mut phase = 0;
    (0..repeat.len())
        .map(|i| {
            let goes_on = i > 0 && repeat[i] == repeat[i - 1] && run_of[i] == run_of[i - 1];
            phase = if goes_on { phase + 1 } else { 0 };
            phase
        })
        .collect()
}

/// Repeat and phase of every sample by the period of each run's motion, where `whole` runs were recorded without a gap.
fn periods(velocity: &[f64], run_of: &[usize], whole: bool) -> (Vec<i64>, Vec<usize>, &'static str) {
    let (mut repeat, mut phase) = (Vec::new(), Vec::new());
    let mut from = "none";
    for samples in segments::stretches(run_of) {
        let first = repeat.last().map_or(0, |last| last + 1);
        let found = if whole { segments::period(&velocity[samples.clone()]) } else { None };
        if found.is_some() {
            from = "found";
        }
        let period = found.unwrap_or(samples.len());
        repeat.extend((0..samples.len()).map(|i| first + (i / period) as i64));
        phase.extend((0..samples.len()).map(|i| i % period));
    }
    (repeat, phase, from)
}
