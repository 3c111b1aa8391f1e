//! Loading history of a brake or gear before the run.

use crate::hysteresis_operators;
use crate::linear::basis::{Basis, dot};
use crate::preprocess::Problem;
use crate::signal::Signal;
use crate::stats::summary::{median, range};
use crate::thresholds::HISTORY_SHARE;
use crate::view::Start;

/// Stop operators that represent any hysteresis, evenly spaced up to half of the range; larger ones never slip.
const STOPS: usize = 8;
/// Number of rows for this test.
const ROWS: usize = 2000;

/// Finds for each recording the last extreme of the signal before its start, from the torque at the beginning.
/// Without it, a wrong initial hysteresis state makes the whole first branch look like structure. Returns whether one
/// is found.
pub fn find(problem: &mut Problem, signal: Signal) -> bool {
    let Some(values) = problem.view.find(signal) else { return false };
    let values = values.to_vec();
    let ends = range(&values);
    let (peak, reach) = (ends.0.abs().max(ends.1.abs()), (ends.1 - ends.0) / 2.0);
    if !hysteresis_operators::turns(&values, 0.2 * reach) {
        return false;
    }
    // The path of the signal: the start of each recording, then row by row.
    let samples = problem.view.samples.find(signal).unwrap_or_default();
    let begins: Vec<usize> = problem.view.starts.iter().map(|s| s.at).collect();
    let row = |start: usize| problem.view.chunks.partition_point(|chunk| chunk.start < start);
    let mut way = values.clone();
    let mut is_row = vec![true; values.len()];
    for start in begins.iter().rev() {
        way.insert(row(*start), samples[*start]);
        is_row.insert(row(*start), false);
    }
    let mut starts: Vec<Start> = begins.iter().enumerate().map(|(i, start)| (row(*start) + i).into()).collect();
    let every = values.len().div_ceil(ROWS);
    let thin = |column: Vec<f64>| -> Vec<f64> { column.into_iter().step_by(every).collect() };
    let curves = (0..=3).map(|k| values.iter().map(|v| (v / peak).powi(k)).collect());
    let others = [Signal::Velocity, Signal::Temperature].into_iter().filter_map(|s| problem.view.find(s));
    let scaled = others.flat_map(|other| {
        let middle = median(other.iter().copied());
        let centred: Vec<f64> = other.iter().map(|o| o - middle).collect();
        let product = centred.iter().zip(&values).map(|(o, v)| o * v).collect();
        [centred, product]
    });
    let fixed: Vec<Vec<f64>> = curves.chain(scaled).map(thin).collect();
    let fixed = Basis::of(&fixed);
    let target = fixed.rest(&thin(problem.target.clone()));
    let left = |starts: &[Start]| {
        let stop = |k: usize| {
            let states = hysteresis_operators::stop(&way, reach * k as f64 / STOPS as f64, starts);
            states.into_iter().zip(&is_row).filter(|(_, is_row)| **is_row).map(|(state, _)| state).collect()
        };
        let stops: Vec<Vec<f64>> = (1..=STOPS).map(|k| fixed.rest(&thin(stop(k)))).collect();
        let rest = Basis::of(&stops).rest(&target);
        dot(&rest, &rest)
    };
    let mut best = left(&starts);
    for i in 0..starts.len() {
        let empty = best;
        let pasts = [-2.0, -1.5, 1.5, 2.0].into_iter().chain((-8..=8).map(|k| f64::from(k) / 8.0));
        // A signal with one sign is assumed to have had the same sign before.
        let (low, high) = (2.0 * ends.0.min(0.0), 2.0 * ends.1.max(0.0));
        for past in pasts.map(|share| share * peak).filter(|past| (low..=high).contains(past)) {
            let mut trial = starts.clone();
            trial[i].past = Some(past);
            let now = left(&trial);
            if now < best && now < (1.0 - HISTORY_SHARE) * empty {
                (best, starts) = (now, trial);
            }
        }
    }
    let found = starts.iter().any(|s| s.past.is_some());
    problem.view.starts.iter_mut().zip(&starts).for_each(|(start, found)| start.past = found.past);
    found
}
