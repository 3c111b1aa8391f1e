//! Rows of a trajectory for one filter corner, with the nuisance columns of every model.

use crate::effects::friction::{direction_offset, load_transmission, signal_delay};
use crate::linear::basis::dot;
use crate::preprocess::design::replicates::{Same, are_apart};
use crate::preprocess::design::{blocks, replicates, segments};
use crate::preprocess::filter::{LowPass, by_recording, derivative};
use crate::preprocess::form_error::{ErrorColumn, FormError, FormErrorKind};
use crate::preprocess::friction::bristles;
use crate::preprocess::friction::signals::{Work, pad};
use crate::preprocess::friction::work_rate::Even;
use crate::preprocess::memo::Memo;
use crate::preprocess::{Problem, Reduce};
use crate::signal::Signal;
use crate::view::View;
use jointbench_instrument::RunTable;
use std::collections::HashSet;
use std::sync::Arc;

/// Excluded ends of a recording, where filters extrapolate [s], or this share of it.
const ENDS_S: f64 = 0.4;
const ENDS_SHARE: f64 = 0.05;
/// Blocks of a run that are left out in turn: this number, of at least one second each, and at least the smaller
/// number.
const BLOCKS: usize = 30;
const LEAST_BLOCKS: usize = 8;
const BLOCK_S: f64 = 1.0;

/// The samples that are rows for one filter corner, with the nuisance columns.
pub struct Layout {
    cutoff_hz: f64,
    reduce: Reduce,
    pub rows: Vec<usize>,
    row_s: f64,
    target: Vec<f64>,
    /// States of presliding elements, at the rows.
    states: Vec<Vec<f64>>,
    /// Acceleration, jerk, snap and load rate, at the rows.
    slopes: Vec<Vec<f64>>,
    pub segment: Option<Vec<i64>>,
    repeat: Vec<i64>,
    pub repeats_from: &'static str,
    phase: Vec<usize>,
    run: Vec<usize>,
}

impl Layout {
    pub fn new(work: &Work, states: &[Vec<f64>], cutoff_hz: f64, every: usize, run: &RunTable) -> Self {
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
        let slope = |values: &[f64]| slope(values, even);
        let of = |signal| work.signals.find(signal).map(<[f64]>::to_vec).unwrap_or_default();
        let snap = slope(&of(Signal::Jerk));
        let mut slopes = vec![of(Signal::Acceleration), of(Signal::Jerk), snap];
        slopes.extend(work.signals.find(Signal::Load).map(slope));
        let pick = |values: &[i64]| rows.iter().map(|row| values[*row]).collect::<Vec<i64>>();
        Self {
            cutoff_hz,
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

    /// Weights of the presliding elements, from the torque at reversals.
    pub fn weights(&self, work: &Work, baseline: &[String]) -> Vec<f64> {
        let is_given = |id: &str| baseline.iter().any(|given| given == id);
        let of = |signal| work.signals.find(signal).map(|values| self.reduce.apply(values.to_vec()));
        let mut free: Vec<Vec<f64>> = of(Signal::Velocity).into_iter().collect();
        free.push(self.slopes[0].clone());
        free.extend(is_given(direction_offset::ID).then(|| vec![1.0; self.target.len()]));
        free.extend(is_given(signal_delay::ID).then(|| self.slopes[1].clone()));
        let mut torque = self.target.clone();
        if let Some(load) = of(Signal::Load).filter(|_| is_given(load_transmission::ID)) {
            torque.iter_mut().zip(load).for_each(|(torque, load)| *torque -= load);
        }
        bristles::weights(&self.states, &free, &torque)
    }

    pub fn problem(&self, work: &Work, view: &View) -> Problem {
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
            different_motion: None,
            segment: self.segment.clone().unwrap_or_else(|| self.rows.iter().map(|row| way(row) as i64).collect()),
            repeat: self.repeat.clone(),
            settled: false,
            form_error: Some(Arc::new(self.form_error(work, view))),
            bandwidths: Vec::new(),
            memo: Memo::default(),
        };
        let of = problem.repeat.clone();
        replicates::check_replicates(&mut problem, &of, &[Signal::Velocity, Signal::Load].map(Same::Value));
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
            kind: FormErrorKind::Bristle,
            values: state.iter().zip(&direction).map(|(z, s)| z - s).collect(),
            scale: rms(state),
        };
        let slopes =
            [FormErrorKind::Jerk, FormErrorKind::Snap, FormErrorKind::LoadRate].into_iter().zip(&self.slopes[1..]);
        let slopes = slopes.map(|(kind, values)| ErrorColumn { kind, values: values.clone(), scale: rms(values) });
        // Without a reversal there are no bristles.
        let rate = (!self.states.is_empty()).then(|| {
            let direction = view.samples.find(Signal::Direction).unwrap_or_default();
            let values = self.reduce.apply(slope(direction, &work.even));
            ErrorColumn { kind: FormErrorKind::BristleRate, scale: rms(&values), values }
        });
        let size = |values: &[f64]| values.iter().map(|v| v.abs()).collect();
        FormError {
            columns: self.states.iter().map(bristle).chain(slopes).chain(rate).collect(),
            turn_s: self.rows.iter().map(|row| work.turn_s(*row)).collect(),
            near_s: 1.0 / self.cutoff_hz,
            fast: [size(&self.slopes[0]), size(&self.slopes[1])],
            row_s: self.row_s,
            sample_s: work.even.step_s / work.even.every as f64,
        }
    }
}

/// Derivative in time, within each recording.
fn slope(values: &[f64], even: &Even) -> Vec<f64> {
    by_recording(values, &even.starts, |range, v| derivative(&even.time_s[range], v))
}

/// Every n-th sample (`every`), at the same phases of each repeat, without the ends of recordings.
fn rows(even: &Even, phase: &[usize], every: usize) -> Vec<usize> {
    let mut rows = Vec::new();
    for (start, end) in even.starts.iter().zip(even.starts.iter().skip(1).chain([&phase.len()])) {
        let ends = ((ENDS_S / even.step_s) as usize).min((ENDS_SHARE * (end - start) as f64) as usize);
        rows.extend((start + ends..end - ends).filter(|i| phase[*i].is_multiple_of(every)));
    }
    rows
}

/// Samples since the start of the repeat.
fn phases(repeat: &[i64], run_of: &[usize]) -> Vec<usize> {
    let mut phase = 0;
    (0..repeat.len())
        .map(|i| {
            let continues = i > 0 && repeat[i] == repeat[i - 1] && run_of[i] == run_of[i - 1];
            phase = if continues { phase + 1 } else { 0 };
            phase
        })
        .collect()
}

/// Repeat and phase of every sample, from the period of each run's motion. Only if the `whole` runs were recorded
/// without a gap.
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
