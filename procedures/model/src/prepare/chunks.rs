//! Samples in model quantities, and their means over chunks.

use super::{Problem, Reduce, layout, segments};
use crate::view::{Constants, Signal, Signals, View};
use std::ops::Range;

/// The samples of a run in model quantities.
pub struct Source {
    pub signals: Signals,
    /// What the model predicts.
    pub target: Vec<f64>,
    pub time_s: Vec<f64>,
    pub step_s: f64,
    /// First samples of recordings.
    pub starts: Vec<usize>,
    /// First samples of the runs that were joined.
    pub runs: Vec<usize>,
    pub cutoff_hz: f64,
    pub segment: Option<Vec<i64>>,
    pub repeat: Option<Vec<i64>>,
    /// The velocity came from the position.
    pub derived_velocity: bool,
    pub constants: Constants,
}

/// Which samples become rows, and what they have in common.
pub struct Layout {
    pub chunks: Vec<Range<usize>>,
    /// Stretch of consecutive rows.
    pub group: Vec<usize>,
    pub condition: Vec<usize>,
    /// Rows since the stretch began, where repeats can be compared.
    pub phase: Option<Vec<usize>>,
    /// Constant speed: what is measured as acceleration is noise.
    pub settled: bool,
}

impl Source {
    pub fn chunk(&self, chunk_s: f64) -> usize {
        ((chunk_s / self.step_s).round() as usize).max(1)
    }

    /// Segments, as numbered or as found: stretches of one direction.
    pub fn legs(&self) -> Vec<Range<usize>> {
        let legs = match &self.segment {
            Some(segment) => segments::stretches(&segment.iter().map(|s| *s as f64).collect::<Vec<_>>()),
            None => segments::stretches(self.signals.find(Signal::Direction).unwrap_or_default()),
        };
        legs.into_iter().flat_map(|leg| self.within_runs(leg)).collect()
    }

    /// No leg goes on in the next run.
    fn within_runs(&self, leg: Range<usize>) -> Vec<Range<usize>> {
        let inside = self.runs.iter().copied().filter(|s| leg.start < *s && *s < leg.end);
        let edges: Vec<usize> = std::iter::once(leg.start).chain(inside).chain([leg.end]).collect();
        edges.windows(2).map(|w| w[0]..w[1]).collect()
    }
}

/// The means of target and signals over chunks, as a problem.
pub fn problem(samples: &Source, layout: Layout) -> Problem {
    let Layout { chunks, group, condition, phase, settled } = layout;
    let mean = |values: &[f64]| -> Vec<f64> {
        chunks.iter().map(|c| values[c.clone()].iter().sum::<f64>() / c.len() as f64).collect()
    };
    let mut points = Signals::new(chunks.len());
    for signal in Signal::ALL {
        let Some(values) = samples.signals.find(signal) else { continue };
        let still = settled && matches!(signal, Signal::Acceleration | Signal::Jerk);
        points.set(signal, if still { vec![0.0; chunks.len()] } else { mean(values) });
    }
    if settled && let Some(velocity) = points.find(Signal::Velocity) {
        // The sign of the filtered velocity rings after a hard reversal, far into a slow plateau.
        let direction = velocity.iter().map(|v| v.signum()).collect();
        points.set(Signal::Direction, direction);
    }
    let target = mean(&samples.target);
    let (block, blocks) = layout::blocks(&group, 48);
    let (fold, folds) = layout::folds(&condition, &block, 10);
    let first = |values: &Option<Vec<i64>>| -> Vec<i64> {
        values.as_ref().map_or_else(|| vec![0; chunks.len()], |v| chunks.iter().map(|c| v[c.start]).collect())
    };
    let repeat = first(&samples.repeat);
    let segment = match &samples.segment {
        Some(_) => first(&samples.segment),
        None => group.iter().map(|g| *g as i64).collect(),
    };
    let twins = phase.map_or_else(Vec::new, |phase| layout::twins(&condition, &phase, &repeat, 1));
    let mut view = View::new(points, samples.signals.clone(), chunks, samples.starts.clone(), samples.step_s);
    view.constants = samples.constants;
    Problem { view, target, reduce: Reduce::Same, block, blocks, fold, folds, twins, segment, repeat, settled }
}
