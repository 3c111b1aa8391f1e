//! Samples in model quantities, and their means over chunks.

use crate::preprocess::design::replicates::Same;
use crate::preprocess::design::{blocks, replicates, segments};
use crate::preprocess::memo::Memo;
use crate::preprocess::{Problem, Reduce, residual_acceleration};
use crate::report::fit::{Preparation, ResidualKind};
use crate::signal::{Signal, Signals};
use crate::stats::summary::mean;
use crate::thresholds::{EVEN_PART, EVEN_SPEED};
use crate::view::{Constants, View};
use jointbench_instrument::RunTable;
use std::collections::HashSet;
use std::ops::Range;
use std::sync::Arc;

/// Length of a chunk [s], whose mean is one row.
pub const CHUNK_S: f64 = 0.04;
/// Largest number of rows; a longer run is thinned. More rows take time and hardly change a fit.
pub const MOST_ROWS: usize = 12_000;

/// The samples of a run in model quantities.
pub struct Source {
    pub signals: Signals,
    /// The response.
    pub target: Arc<Vec<f64>>,
    pub time_s: Vec<f64>,
    pub step_s: f64,
    /// First samples of recordings.
    pub starts: Vec<usize>,
    /// First samples of the runs that were joined.
    pub runs: Vec<usize>,
    pub cutoff_hz: f64,
    pub segment: Option<Vec<i64>>,
    pub repeat: Option<Vec<i64>>,
    /// The velocity was derived from the position.
    pub derived_velocity: bool,
    pub constants: Constants,
}

/// Median of the largest group of nearly equal speeds.
fn usual(mut speeds: Vec<f64>) -> f64 {
    speeds.sort_unstable_by(f64::total_cmp);
    let near =
        |low: usize| speeds.partition_point(|v| *v <= speeds[low] * (1.0 + EVEN_SPEED) / (1.0 - EVEN_SPEED)) - low;
    let low = (0..speeds.len()).max_by_key(|low| near(*low));
    low.map_or(0.0, |low| speeds[low + near(low) / 2])
}

/// The samples that become rows, with their groups and conditions.
pub struct Layout<'a> {
    pub chunks: Vec<Range<usize>>,
    /// Number of the stretch of consecutive rows.
    pub group: Vec<usize>,
    pub condition: Vec<usize>,
    /// Rows since the start of the stretch, if repeats can be compared.
    pub phase: Option<Vec<usize>>,
    /// Constant speed: the measured acceleration is noise, except for a residual acceleration.
    pub settled: bool,
    /// Signals that must agree between stretches of one condition to count as repeats. Empty if the condition is
    /// sufficient.
    pub inputs: &'a [Same],
}

impl Source {
    /// How the run was preprocessed to means over chunks of `n` samples.
    pub fn preparation_of_chunks(&self, n: usize, run: &RunTable, main: &Problem, repeats_from: &str) -> Preparation {
        Preparation {
            residual: ResidualKind::PlateauMean,
            sample_rate_hz: 1.0 / self.step_s,
            cutoff_hz: self.derived_velocity.then_some(self.cutoff_hz),
            velocity_lag_s: None,
            decimation: 1,
            bristles: None,
            chunk_s: Some(n as f64 * self.step_s),
            samples: run.len(),
            rows: main.rows(),
            blocks: main.blocks,
            segments_from: if self.segment.is_some() { "column" } else { "found" }.into(),
            repeats_from: repeats_from.into(),
        }
    }

    pub fn chunk(&self, chunk_s: f64) -> usize {
        ((chunk_s / self.step_s).round() as usize).max(1)
    }

    /// Segments as numbered, otherwise stretches of one direction.
    pub fn legs(&self) -> Vec<Range<usize>> {
        let legs = match &self.segment {
            Some(segment) => segments::stretches(segment),
            None => segments::stretches(self.signals.find(Signal::Direction).unwrap_or_default()),
        };
        legs.into_iter().flat_map(|leg| self.within_runs(leg)).collect()
    }

    /// The part of a leg at constant speed. It excludes the ramps at both ends, and after the first ramp the same
    /// time again until the motion has settled: the gear flanks still change there. A leg without a constant speed is
    /// returned whole.
    pub fn even_part(&self, leg: &Range<usize>, chunk: usize) -> Range<usize> {
        let Some(velocity) = self.signals.find(Signal::Velocity) else { return leg.clone() };
        // A model file may demand chunks that are longer than the leg.
        let chunk = chunk.min(leg.len()).max(1);
        let means: Vec<f64> = velocity[leg.clone()].chunks(chunk).map(mean).collect();
        let kept = usual(means.iter().map(|mean| mean.abs()).collect());
        let is_even = |mean: &f64| (mean.abs() - kept).abs() <= EVEN_SPEED * kept;
        let (first, last) = (means.iter().position(is_even), means.iter().rposition(is_even));
        let even = means.iter().filter(|m| is_even(m)).count() as f64;
        match (first, last) {
            (Some(first), Some(last)) if even >= EVEN_PART * means.len() as f64 => {
                leg.start + (2 * first).min(last) * chunk..(leg.start + (last + 1) * chunk).min(leg.end)
            }
            _ => leg.clone(),
        }
    }

    /// The samples of some chunks, and all turning points between them. The states of rate-independent hysteresis
    /// operators depend only on the turning points.
    pub fn around(&self, chunks: Vec<Range<usize>>) -> (Source, Vec<Range<usize>>) {
        let direction = self.signals.find(Signal::Direction).unwrap_or_default();
        let mut kept = vec![false; self.time_s.len()];
        chunks.iter().for_each(|c| kept[c.clone()].fill(true));
        self.starts.iter().for_each(|s| kept[*s] = true);
        let turns = (1..direction.len()).filter(|i| direction[*i] != direction[i - 1]);
        turns.for_each(|i| kept[i - 1..=i].fill(true));
        let rows: Vec<usize> = (0..kept.len()).filter(|i| kept[*i]).collect();
        let at = |sample: &usize| rows.partition_point(|r| r < sample);
        let gather = |values: &[f64]| -> Vec<f64> { rows.iter().map(|i| values[*i]).collect() };
        let whole = |values: &Option<Vec<i64>>| values.as_ref().map(|v| rows.iter().map(|i| v[*i]).collect());
        let mut signals = Signals::new(rows.len());
        self.signals.iter().for_each(|(signal, values)| signals.set(signal, gather(values)));
        let moved = chunks.iter().map(|c| at(&c.start)..at(&c.start) + c.len()).collect();
        let source = Source {
            signals,
            target: gather(&self.target).into(),
            time_s: gather(&self.time_s),
            starts: self.starts.iter().map(at).collect(),
            runs: self.runs.iter().map(at).collect(),
            segment: whole(&self.segment),
            repeat: whole(&self.repeat),
            ..*self
        };
        (source, moved)
    }

    /// Splits a leg at the ends of runs.
    fn within_runs(&self, leg: Range<usize>) -> Vec<Range<usize>> {
        let inside = self.runs.iter().copied().filter(|s| leg.start < *s && *s < leg.end);
        let edges: Vec<usize> = std::iter::once(leg.start).chain(inside).chain([leg.end]).collect();
        edges.windows(2).map(|w| w[0]..w[1]).collect()
    }
}

/// The means of response and signals over chunks, as a problem.
pub fn problem(samples: &Source, layout: Layout) -> Problem {
    let Layout { chunks, group, condition, phase, settled, inputs } = layout;
    let points = if settled { steady_means(samples, &chunks, &group) } else { means(samples, &chunks) };
    let target = chunk_means(&samples.target, &chunks);
    let (block, blocks) = blocks::blocks(&group, 48);
    let left_out_unit = if settled { blocks::left_out_unit(&condition, &group) } else { &condition };
    let (mut fold, folds) = blocks::folds(left_out_unit, &block, 10);
    // The remanence of a brake after its largest current cannot be predicted from smaller loops.
    if let Some(current) = points.find(Signal::Current) {
        blocks::share_edges(&mut fold, folds, &group, current);
    }
    let first = |values: &Option<Vec<i64>>| -> Vec<i64> {
        values.as_ref().map_or_else(|| vec![0; chunks.len()], |v| chunks.iter().map(|c| v[c.start]).collect())
    };
    let repeat = first(&samples.repeat);
    let segment = match &samples.segment {
        Some(_) => first(&samples.segment),
        None => group.iter().map(|g| *g as i64).collect(),
    };
    // Numbered legs of one condition are repeats of each other, independent of the numbers of the repeats.
    let of: Vec<i64> = match inputs.is_empty() || samples.segment.is_none() {
        true => repeat.clone(),
        false => group.iter().map(|g| *g as i64).collect(),
    };
    let replicate_pairs = phase.map_or_else(Vec::new, |phase| blocks::replicate_pairs(&condition, &phase, &of, 1));
    let link = points.find(Signal::Link).filter(|_| settled && !samples.constants.slides);
    let (replicate_pairs, different_angle) = match link.filter(|link| replicates::are_apart(&replicate_pairs, link)) {
        Some(link) => replicates::by_angle(replicate_pairs, &condition, &of, link),
        None => (replicate_pairs, HashSet::new()),
    };
    let mut view = View::new(points, samples.signals.clone(), chunks, samples.starts.clone(), samples.step_s);
    view.constants = samples.constants;
    let mut problem = Problem {
        view,
        target,
        sampled: samples.target.clone(),
        reduce: Reduce::Same,
        block,
        blocks,
        fold,
        folds,
        replicate_pairs,
        different_history: HashSet::new(),
        different_angle,
        different_motion: None,
        segment,
        repeat,
        settled,
        form_error: None,
        bandwidths: Vec::new(),
        memo: Memo::default(),
    };
    replicates::check_replicates(&mut problem, &of, inputs);
    problem
}

fn chunk_means(values: &[f64], chunks: &[Range<usize>]) -> Vec<f64> {
    chunks.iter().map(|c| mean(&values[c.clone()])).collect()
}

fn means(samples: &Source, chunks: &[Range<usize>]) -> Signals {
    let mut points = Signals::new(chunks.len());
    samples.signals.iter().for_each(|(signal, values)| points.set(signal, chunk_means(values, chunks)));
    points
}

/// The means at constant speed: without jerk, and with the residual acceleration as the acceleration.
fn steady_means(samples: &Source, chunks: &[Range<usize>], group: &[usize]) -> Signals {
    let mut points = means(samples, chunks);
    for signal in [Signal::Acceleration, Signal::Jerk] {
        if points.find(signal).is_some() {
            points.set(signal, vec![0.0; chunks.len()]);
        }
    }
    if let Some(position) = samples.signals.find(Signal::Position) {
        let wavering = residual_acceleration::accelerations(&samples.time_s, position, samples.step_s, chunks, group);
        points.set(Signal::Acceleration, wavering);
    }
    if let Some(velocity) = points.find(Signal::Velocity) {
        // The sign of the filtered velocity rings after a fast reversal, far into a slow dwell.
        let direction = velocity.iter().map(|v| v.signum()).collect();
        points.set(Signal::Direction, direction);
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hysteresis_operators;

    fn source(signals: Signals) -> Source {
        let n = signals.len();
        Source {
            signals,
            target: vec![0.0; n].into(),
            time_s: (0..n).map(|i| i as f64).collect(),
            step_s: 1.0,
            starts: vec![0],
            runs: vec![0],
            cutoff_hz: 0.1,
            segment: None,
            repeat: Some(vec![0; n]),
            derived_velocity: true,
            constants: Constants::default(),
        }
    }

    #[test]
    fn a_leg_loses_its_ramps_even_where_they_are_longer_than_its_dwell() {
        let of = |speed: &dyn Fn(f64) -> f64| {
            let n = 310;
            let mut signals = Signals::new(n);
            signals.set(Signal::Velocity, (0..n).map(|i| -speed(i as f64)).collect());
            source(signals).even_part(&(0..n), 4)
        };
        let ramps = |i: f64| 1.8 * (i / 80.0).min((310.0 - i) / 80.0).min(1.0);
        let even = of(&ramps);
        assert!((140..=160).contains(&even.start) && (228..=242).contains(&even.end), "{even:?}");
        assert_eq!(of(&|i| (i / 310.0 * std::f64::consts::PI).sin()), 0..310, "a wave keeps no speed");
    }

    #[test]
    fn a_memory_is_the_same_on_the_samples_around_chunks() {
        // Back and forth, three times, in steps of different length.
        let way = |i: usize| if (i / 40).is_multiple_of(2) { i % 40 } else { 40 - i % 40 } as f64;
        let n = 240;
        let position: Vec<f64> = (0..n).map(|i| way(i) + 0.3 * (way(i) * 0.2).sin()).collect();
        let direction = (0..n).map(|i| if (i / 40_usize).is_multiple_of(2) { 1.0 } else { -1.0 }).collect();
        let mut signals = Signals::new(n);
        signals.set(Signal::Position, position.clone());
        signals.set(Signal::Direction, direction);
        let source = source(signals);
        let chunks = vec![84..88, 165..169, 210..214];
        let (thin, moved) = source.around(chunks.clone());
        assert!(thin.time_s.len() < 30 && thin.starts == [0], "{:?}", thin.time_s);
        let few = thin.signals.find(Signal::Position).unwrap_or_default();
        for state in [hysteresis_operators::dahl, hysteresis_operators::stop, hysteresis_operators::maxwell_slip] {
            let (whole, part) = (state(&position, 5.0, &[0.into()]), state(few, 5.0, &[0.into()]));
            for (c, m) in chunks.iter().zip(&moved) {
                for (a, b) in whole[c.clone()].iter().zip(&part[m.clone()]) {
                    assert!((a - b).abs() < 1e-12, "{a} {b}");
                }
            }
        }
    }
}
