//! Trajectories: filtered and decimated samples.
//!
//! Parallel filtering after Gautier 1997: the response and every column pass the same zero-phase filter before one of n
//! samples is kept. The defaults are those of Janot, Gautier and Brunot 2019 at any sample rate.

use crate::preprocess::chunks::Source;
use crate::preprocess::design::replicates::Same;
use crate::preprocess::design::{blocks, replicates, segments};
use crate::preprocess::filter::{LowPass, by_recording, derivative};
use crate::preprocess::friction::{reversals, unmeasured_gravity};
use crate::preprocess::{Prepared, Problem, Reduce};
use crate::report::fit::Preparation;
use crate::signal::Signal;
use crate::view::{Constants, View};
use crate::{ModelError, Options, ResidualKind};
use jointbench_instrument::RunTable;
use std::collections::HashSet;
use std::sync::Arc;

/// Of a trajectory of more rows than these some are taken.
const MOST_ROWS: usize = 12_000;

/// Where more rows than this share lie beside a reversal, what is left without them is no trajectory.
const MOST_NEAR_REVERSALS: f64 = 0.5;

/// Rows for each second that the defaults aim at.
const ROWS_HZ: f64 = 100.0;

pub fn prepare(run: &RunTable, mut samples: Source, options: &Options) -> Result<Prepared, ModelError> {
    let every = options.decimation.unwrap_or(((1.0 / samples.step_s / ROWS_HZ).round() as usize).max(1));
    // What the response keeps of fast changes, the acceleration has to keep as well: one filter for all columns, the lower of
    // the two, unless hardly anything is left beside the reversals. The slope of a position has been smoothed before, because
    // its steps would be all that is left of it.
    let decimating_hz = 0.4 / (every as f64 * samples.step_s);
    let filtered_hz = if every == 1 { samples.cutoff_hz } else { samples.cutoff_hz.min(decimating_hz) };
    let reach = (1.0 / (filtered_hz * samples.step_s)).ceil() as usize;
    let are_few =
        |near: &Vec<bool>| (near.iter().filter(|n| **n).count() as f64) < MOST_NEAR_REVERSALS * near.len() as f64;
    let near = reversals::near(&samples, reach).filter(are_few);
    let smooths = near.is_some() && !samples.derived_velocity && (every == 1 || samples.cutoff_hz < decimating_hz);
    let filter = match smooths {
        true => Some(LowPass::butterworth(4, 2.0 * samples.cutoff_hz * samples.step_s)),
        false => (every > 1).then(|| LowPass::chebyshev(8, 0.05, 0.8 / every as f64)),
    };
    // The first and last samples of a recording are where filters and derivatives guess.
    let skip = (50.min(run.len() / (20 * samples.starts.len().max(1)))).max(1);
    let starts = samples.starts.clone();
    let pick = |values: &[f64]| {
        by_recording(values, &starts, |_, v| {
            (skip..v.len().saturating_sub(skip)).step_by(every).map(|i| v[i]).collect()
        })
    };
    let velocity = pick(samples.signals.find(Signal::Velocity).unwrap_or_default());
    let direction = samples.signals.find(Signal::Direction).unwrap_or_default();
    let mut rests = standstill(&velocity);
    if let Some(ahead) = segments::main_direction(direction).filter(|ahead| direction.contains(&-ahead)) {
        // Too little to tell anything of that way from what its haste brings.
        let back = segments::way_back(&pick(direction), ahead);
        rests = if rests.is_empty() { back } else { rests.iter().zip(back).map(|(r, b)| *r || b).collect() };
        let one_way = vec![ahead; direction.len()];
        samples.signals.set(Signal::Direction, one_way);
    }
    let weight = unmeasured_gravity::unmeasured(&samples.signals, &samples.target);
    let drive = crate::preprocess::friction::drive(&samples.signals, &samples.target);
    samples.signals.set(Signal::Drive, drive);
    if smooths {
        set_slopes(&mut samples);
    }
    let points = &samples.signals;
    let mut view = View::new(points.clone(), points.clone(), Vec::new(), starts.clone(), samples.step_s);
    view.constants = Constants { weight, ..samples.constants };
    let mut reduce = Reduce::Decimate { filter, every, skip, starts: starts.clone(), left_out: Vec::new() };
    if let Some(near) = near {
        let near = pick(&near.into_iter().map(f64::from).collect::<Vec<_>>());
        if !reversals::bend(&view, &samples.target, &reduce, &near) {
            view.constants.turns_left_out = true;
            rests = near.iter().enumerate().map(|(i, near)| *near > 0.0 || rests.get(i) == Some(&true)).collect();
        }
    }
    let velocity = without(velocity, &rests);
    let run_of: Vec<usize> =
        without(pick(&run_number(run.len(), &samples.runs)), &rests).into_iter().map(|n| n as usize).collect();
    let whole = |values: &Option<Vec<i64>>, left_out: &[bool]| -> Option<Vec<i64>> {
        values.as_ref().map(|v| {
            let v: Vec<f64> = v.iter().map(|x| *x as f64).collect();
            without(pick(&v), left_out).into_iter().map(|x| x as i64).collect()
        })
    };
    let within_a_run = |r: &Vec<i64>| (1..r.len()).any(|i| r[i] != r[i - 1] && run_of[i] == run_of[i - 1]);
    let (repeat, phase, repeats_from) = match whole(&samples.repeat, &rests).filter(within_a_run) {
        Some(repeat) => {
            let phase = phases(&repeat);
            (repeat, phase, "column")
        }
        None => periods(&velocity, &run_of, starts.len() == samples.runs.len()),
    };
    // The same moments of every repeat, so that these can still be held against each other.
    let thin = phase.len().div_ceil(MOST_ROWS).max(1);
    let is_taken = |row: usize| phase[row].is_multiple_of(thin);
    let left_out = thinned(rests, phase.len(), is_taken);
    let taken: Vec<usize> = (0..phase.len()).filter(|row| is_taken(*row)).collect();
    let repeat: Vec<i64> = taken.iter().map(|row| repeat[*row]).collect();
    let run_of: Vec<usize> = taken.iter().map(|row| run_of[*row]).collect();
    let phase: Vec<usize> = taken.iter().map(|row| phase[*row]).collect();
    if let Reduce::Decimate { left_out: out, .. } = &mut reduce {
        out.clone_from(&left_out);
    }
    let target = reduce.apply(samples.target.to_vec());
    if target.len() < 24 {
        return Err(ModelError::TooFewSamples { usable: target.len(), needed: 24, what: "filtered rows" });
    }
    // A recording is forgotten between two blocks, and a stroke is the least that holds one experience of friction.
    let direction = samples.signals.find(Signal::Direction).unwrap_or_default().to_vec();
    let mut stroke = 0usize;
    let strokes: Vec<f64> = (0..run.len())
        .map(|i| {
            if i > 0 && (direction[i] != direction[i - 1] || starts.contains(&i)) {
                stroke += 1;
            }
            stroke as f64
        })
        .collect();
    let group: Vec<usize> = without(pick(&strokes), &left_out).into_iter().map(|s| s as usize).collect();
    // A motion that never turns has no strokes: it says as much in pieces of half of that.
    let never_turns = starts.len() == 1 && stroke == 0;
    let (block, blocks) = blocks::blocks(&group, if never_turns { 32 } else { 16 });
    let folds = blocks.clamp(1, 8);
    let fold: Vec<usize> = block.iter().map(|b| b % folds).collect();

    // Trajectories of different runs are not repeats of each other.
    let replicate_pairs = blocks::replicate_pairs(&run_of, &phase, &repeat, 0);
    let segment = whole(&samples.segment, &left_out).unwrap_or_else(|| group.iter().map(|g| *g as i64).collect());
    let about = Preparation {
        residual: ResidualKind::Raw,
        sample_rate_hz: 1.0 / samples.step_s,
        cutoff_hz: Some(samples.cutoff_hz),
        velocity_lag_s: None,
        decimation: every,
        chunk_s: None,
        samples: run.len(),
        rows: target.len(),
        blocks,
        segments_from: if samples.segment.is_some() { "column" } else { "found" }.into(),
        repeats_from: repeats_from.into(),
    };
    let mut main = Problem {
        view,
        target,
        sampled: Arc::default(),
        reduce,
        block,
        blocks,
        fold,
        folds,
        replicate_pairs,
        different_history: HashSet::new(),
        different_angle: HashSet::new(),
        unlike: None,
        segment,
        repeat,
        settled: false,
    };
    let of = main.repeat.clone();
    let inputs = [Signal::Velocity, Signal::Link, Signal::Load].map(Same::Value);
    replicates::believe(&mut main, &of, &inputs);
    Ok(Prepared {
        kind: run.kind(),
        motion: run.meta().motion,
        baseline: run.meta().baseline.clone(),
        load_scale: run.meta().gear_ratio.unwrap_or(1.0),
        constants: crate::preprocess::constants(run),
        clashes: crate::preprocess::checks::unit_mismatch::clashes(run),
        doubts: crate::preprocess::checks::metadata::doubts(run),
        main,
        moving: None,
        memory: None,
        about,
    })
}

/// Acceleration and jerk of a velocity that the filter of all columns has yet to smooth.
fn set_slopes(samples: &mut Source) {
    let slope =
        |values: &[f64]| by_recording(values, &samples.starts, |range, v| derivative(&samples.time_s[range], v));
    let acceleration = slope(samples.signals.find(Signal::Velocity).unwrap_or_default());
    let jerk = slope(&acceleration);
    samples.signals.set(Signal::Acceleration, acceleration);
    samples.signals.set(Signal::Jerk, jerk);
}

/// The rows that are not left out. Nothing is where `left_out` is empty.
fn without(mut rows: Vec<f64>, left_out: &[bool]) -> Vec<f64> {
    let mut out = left_out.iter();
    rows.retain(|_| left_out.is_empty() || out.next() == Some(&false));
    rows
}

/// Leaves out of the `moving` rows those that are not taken, beside those in which the axis rests.
fn thinned(mut rests: Vec<bool>, moving: usize, is_taken: impl Fn(usize) -> bool) -> Vec<bool> {
    if (0..moving).all(&is_taken) {
        return rests;
    }
    if rests.is_empty() {
        rests = vec![false; moving];
    }
    let mut row = 0..;
    rests.iter_mut().filter(|rests| !**rests).zip(&mut row).for_each(|(out, row)| *out = !is_taken(row));
    rests
}

/// The number of the run of every sample.
fn run_number(samples: usize, runs: &[usize]) -> Vec<f64> {
    (0..samples).map(|i| (runs.partition_point(|s| *s <= i) - 1) as f64).collect()
}

/// Repeat and phase of every row by the period of each run's motion, where `whole` runs were recorded without a gap.
fn periods(velocity: &[f64], run_of: &[usize], whole: bool) -> (Vec<i64>, Vec<usize>, &'static str) {
    let (mut repeat, mut phase) = (Vec::new(), Vec::new());
    let mut from = "none";
    let runs = segments::stretches(run_of);
    for rows in runs {
        let first = repeat.last().map_or(0, |last| last + 1);
        let found = if whole { segments::period(&velocity[rows.clone()]) } else { None };
        if found.is_some() {
            from = "found";
        }
        let period = found.unwrap_or(rows.len());
        repeat.extend((0..rows.len()).map(|i| first + (i / period) as i64));
        phase.extend((0..rows.len()).map(|i| i % period));
    }
    (repeat, phase, from)
}

/// Rows in which the axis rests, where it rests for more than a tenth of the run: friction at rest is whatever the load
/// asks for, and no static effect can say how much. Empty where nothing is left out.
fn standstill(velocity: &[f64]) -> Vec<bool> {
    let fastest = velocity.iter().fold(0.0f64, |m, v| m.max(v.abs()));
    let rests: Vec<bool> = velocity.iter().map(|v| v.abs() < 0.01 * fastest).collect();
    if rests.iter().filter(|r| **r).count() * 10 > velocity.len() { rests } else { Vec::new() }
}

/// Rows since the repeat began.
fn phases(repeat: &[i64]) -> Vec<usize> {
    let mut phase = 0;
    (0..repeat.len())
        .map(|i| {
            phase = if i > 0 && repeat[i] == repeat[i - 1] { phase + 1 } else { 0 };
            phase
        })
        .collect()
}
