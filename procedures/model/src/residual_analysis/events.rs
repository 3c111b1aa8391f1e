//! Events that do not repeat: a sensor that jumps for a while, a particle that passes once.
//!
//! No function of an axis predicts an event, and in the difference of two repeats it looks like noise. An event is a
//! short section whose mean is an outlier of the scatter of all sections. The repeats of the same moment do not show
//! it. A section whose mean is at most half a count of the encoders is none: while an encoder advances by nearly a
//! multiple of its count from sample to sample, its quantization error is constant, and averages do not reduce it.

use crate::effect::ShapeSearch;
use crate::preprocess::Problem;
use crate::regression::linear_model::LinearModel;
use crate::signal::Signal;
use crate::thresholds::EVENT_ERRORS;
use std::collections::HashMap;
use std::ops::Range;

/// Tested lengths of events, in rows.
const LENGTHS: [usize; 7] = [1, 2, 4, 8, 16, 32, 64];
/// The scatter of sections of one length is estimated only if there are more than this number times the length.
const STRETCHES: usize = 16;
/// Rows on each side of a reversal that are excluded.
const REVERSAL_ROWS: usize = 2;
/// Largest number of tested sections.
const MOST: usize = 400;
/// Median absolute value of a normal variable, in standard deviations.
const MEDIAN: f64 = 0.6745;

/// A section of rows with the mean residual.
#[derive(Debug, Clone)]
pub struct Event {
    pub rows: Range<usize>,
    pub mean: f64,
}

/// The residual of a model, with the rows that repeat each row.
pub struct Events<'p> {
    problem: &'p Problem,
    residual: Vec<f64>,
    /// Rows that are excluded: at reversals, at jumps, or in a known event.
    is_out: Vec<bool>,
    repeats: HashMap<usize, Vec<usize>>,
}

impl<'p> Events<'p> {
    pub fn of(problem: &'p Problem, residual: &[f64]) -> Self {
        let mut repeats: HashMap<usize, Vec<usize>> = HashMap::new();
        for (a, b) in &problem.replicate_pairs {
            repeats.entry(*a).or_default().push(*b);
            repeats.entry(*b).or_default().push(*a);
        }
        // A residual at a reversal belongs to the reversal.
        let direction = problem.view.get(Signal::Direction);
        let mut is_out = vec![false; residual.len()];
        for row in (1..direction.len().min(residual.len())).filter(|row| direction[*row] != direction[row - 1]) {
            is_out[row.saturating_sub(REVERSAL_ROWS)..(row + REVERSAL_ROWS).min(residual.len())].fill(true);
        }
        Self { problem, residual: residual.to_vec(), is_out, repeats }
    }

    /// Excludes the rows at jumps of the model: a mean over a jump contains both sides.
    pub fn without_jumps(mut self, model: &LinearModel) -> Self {
        let time = self.problem.view.get(Signal::Time);
        let shapes = model.terms.iter().flat_map(|term| term.form.shape.iter().zip(&term.shape));
        for (_, at_s) in shapes.filter(|(shape, _)| shape.search == ShapeSearch::Jump) {
            let after = time.partition_point(|t| t < at_s);
            self.is_out[after.saturating_sub(1)..(after + 1).min(time.len())].fill(true);
        }
        self
    }

    /// The events, the largest first.
    pub fn find(mut self) -> Vec<Event> {
        let scale = |length: usize| Some((length, self.scale(length)?));
        let scales: Vec<(usize, f64)> = LENGTHS.into_iter().filter_map(scale).collect();
        let mut found = Vec::new();
        for _ in 0..MOST {
            let farthest = scales.iter().filter_map(|(length, scale)| self.farthest(*length, *scale));
            let farthest = farthest.filter(|(.., mean)| mean.abs() > self.problem.view.constants.half_counts);
            let Some((z, rows, mean)) = farthest.max_by(|a, b| a.0.total_cmp(&b.0)) else { break };
            if z < EVENT_ERRORS {
                break;
            }
            let surrounding = rows.start.saturating_sub(rows.len())..(rows.end + rows.len()).min(self.residual.len());
            self.is_out[surrounding].fill(true);
            if !self.recurs(&rows, mean) && !self.begins(&rows) {
                found.push(Event { rows, mean });
            }
        }
        joined(found)
    }

    /// Whether the section begins within its own length after the start of a recording.
    fn begins(&self, rows: &Range<usize>) -> bool {
        let chunk = |row: usize| self.problem.view.chunks.get(row).map_or(row, |chunk| chunk.start);
        let mut starts = self.problem.view.starts.iter().map(|start| start.at);
        let before = chunk(rows.start.saturating_sub(rows.len()));
        starts.any(|start| (before..=chunk(rows.start)).contains(&start))
    }

    /// First row and mean of every section of a length without an excluded row.
    fn means(&self, length: usize) -> impl Iterator<Item = (usize, f64)> {
        let (mut sum, mut out) = (0.0, 0usize);
        let next = move |last: usize| {
            (sum, out) = (sum + self.residual[last], out + usize::from(self.is_out[last]));
            let first = (last + 1).checked_sub(length)?;
            let found = (out == 0).then_some((first, sum / length as f64));
            (sum, out) = (sum - self.residual[first], out - usize::from(self.is_out[first]));
            found
        };
        (0..self.residual.len()).filter_map(next)
    }

    /// Robust scatter of the means of sections of one length. `None` if there are too few.
    fn scale(&self, length: usize) -> Option<f64> {
        let sizes: Vec<f64> = self.means(length).map(|(_, mean)| mean.abs()).collect();
        let scale = crate::stats::summary::median(sizes.iter().copied()) / MEDIAN;
        (STRETCHES * length < sizes.len() && scale > 0.0).then_some(scale)
    }

    fn farthest(&self, length: usize, scale: f64) -> Option<(f64, Range<usize>, f64)> {
        let (at, mean) = self.means(length).max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
        Some((mean.abs() / scale, at..at + length, mean))
    }

    /// Whether at least half of the event is present in the rows that repeat it.
    fn recurs(&self, rows: &Range<usize>, mean: f64) -> bool {
        let (mut sum, mut count) = (0.0, 0.0);
        for other in rows.clone().filter_map(|row| self.repeats.get(&row)).flatten() {
            (sum, count) = (sum + self.residual[*other], count + 1.0);
        }
        count > 0.0 && sum / count / mean > 0.5
    }

    /// Start and end time of an event [s].
    pub fn span_s(problem: &Problem, event: &Event) -> [f64; 2] {
        let time = problem.view.get(Signal::Time);
        [time[event.rows.start], time[event.rows.end.min(time.len() - 1)]]
    }
}

/// Neighbouring sections of one sign as one event, if the gap between them is no longer than the shorter one. The
/// largest mean is first.
fn joined(mut sections: Vec<Event>) -> Vec<Event> {
    sections.sort_by_key(|section| section.rows.start);
    let mut events: Vec<Event> = Vec::new();
    for next in sections {
        let follows = |last: &&mut Event| {
            let shorter = last.rows.len().min(next.rows.len());
            last.mean * next.mean > 0.0 && next.rows.start - last.rows.end <= shorter
        };
        match events.last_mut().filter(follows) {
            Some(last) => {
                let (n, more) = (last.rows.len() as f64, next.rows.len() as f64);
                last.mean = (n * last.mean + more * next.mean) / (n + more);
                last.rows.end = next.rows.end;
            }
            None => events.push(next),
        }
    }
    events.sort_by(|a, b| b.mean.abs().total_cmp(&a.mean.abs()));
    events
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::preprocess::Reduce;
    use crate::preprocess::memo::Memo;
    use crate::signal::Signals;
    use crate::view::View;
    use std::collections::HashSet;

    /// Two repeats of 500 rows with a pulse in the middle; the second repeat always has it.
    fn found(again: f64) -> Vec<Event> {
        let n = 1000;
        let noise = |i: usize| (12.9898 * i as f64).sin() * (78.233 * i as f64).cos();
        let swing = |i: usize, size: f64| if (200..210).contains(&i) { size } else { 0.0 };
        let residual: Vec<f64> =
            (0..n).map(|i| noise(i) + swing(i % 500, if i < 500 { again } else { 12.0 })).collect();
        let mut signals = Signals::new(n);
        signals.set(Signal::Time, (0..n).map(|i| 0.01 * i as f64).collect());
        let problem = Problem {
            view: View::new(signals.clone(), signals, Vec::new(), vec![0], 0.01),
            target: residual.clone(),
            sampled: Vec::new().into(),
            reduce: Reduce::Same,
            block: vec![0; n],
            blocks: 1,
            fold: vec![0; n],
            folds: 1,
            replicate_pairs: (0..500).map(|i| (i, i + 500)).collect(),
            different_history: HashSet::new(),
            different_angle: HashSet::new(),
            different_motion: None,
            segment: vec![0; n],
            repeat: (0..n).map(|i| (i / 500) as i64).collect(),
            settled: false,
            form_error: None,
            bandwidths: Vec::new(),
            memo: Memo::default(),
        };
        Events::of(&problem, &residual).find()
    }

    #[test]
    fn what_happens_once_is_an_event_and_what_comes_again_is_none() {
        let once = found(0.0);
        assert!(matches!(&once[..], [one] if (695..710).contains(&one.rows.start)), "{once:?}");
        assert!(found(12.0).is_empty());
    }
}
