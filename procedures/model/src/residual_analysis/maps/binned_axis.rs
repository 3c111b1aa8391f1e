//! Axes that a residual may depend on, divided into bins.

use crate::preprocess::{Prepared, Problem};
use crate::signal::Signal;
use crate::stats::summary::range;
use crate::thresholds::{SAME_LEVEL, TIME_AXIS};
use jointbench_instrument::Kind;
use std::f64::consts::TAU;

/// One quantity at the rows, in the unit of its column, with the bin of every row.
#[derive(Debug, Clone)]
pub struct BinnedAxis {
    /// Column name of the run table, or the name of a derived quantity.
    pub name: String,
    pub unit: String,
    pub values: Vec<f64>,
    pub bin: Vec<usize>,
    /// Smallest, mean and largest value of the rows of each bin.
    pub bins: Vec<Bin>,
    /// Whether the quantity is constant within a block of the run.
    pub is_held: bool,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bin {
    pub from: f64,
    pub centre: f64,
    pub to: f64,
}

const BINS: usize = 24;
const ANGLE_BINS: usize = 60;

/// Every axis of the run whose quantity changes. Of two axes with the same values only the first is shown.
pub fn scales(prepared: &Prepared) -> Vec<BinnedAxis> {
    let problem = &prepared.main;
    let mut scales: Vec<BinnedAxis> = Vec::new();
    for signal in [
        Signal::Velocity,
        Signal::Link,
        Signal::Position,
        Signal::Load,
        Signal::Temperature,
        Signal::Time,
        Signal::Repeat,
        Signal::Current,
        Signal::Drive,
        Signal::Direction,
    ] {
        let is_informative = signal != Signal::Load || prepared.kind != Kind::Friction || problem.view.bears_load();
        let Some(values) = problem.view.find(signal).filter(|_| is_informative) else {
            continue;
        };
        let scale = BinnedAxis::of(prepared, signal, values);
        if scale.bins.len() > 1 && !scales.iter().any(|s| s.says_the_same(&scale)) {
            scales.push(scale);
        }
    }
    for signal in problem.view.points.unknown() {
        let (as_read, scale) = BinnedAxis::of_unknown(prepared, signal);
        if scale.bins.len() > 1 && !scales.iter().any(|s| s.says_the_same(&as_read)) {
            scales.push(scale);
        }
    }
    let since = since_reversal(problem);
    let since = BinnedAxis::new("time_since_reversal_s", "s".into(), quantiles(&since, BINS), since);
    scales.extend((since.bins.len() > 1 && scales.iter().any(|s| s.name == "direction")).then_some(since));
    scales
}

impl BinnedAxis {
    /// A known signal, in bins that suit it.
    fn of(prepared: &Prepared, signal: Signal, values: &[f64]) -> Self {
        let problem = &prepared.main;
        let unit_scale = prepared.column_scale(signal);
        let values: Vec<f64> = problem.reduce.apply(values.to_vec()).into_iter().map(|v| v * unit_scale).collect();
        let (name, unit) = (prepared.column_name(signal), prepared.column_unit(signal));
        match signal {
            Signal::Velocity | Signal::Load if problem.settled => {
                let held = block_means(&values, problem);
                Self::new(name, unit, levels(&held), held).held()
            }
            // The residual contains the noise of the response, so that bins of the response itself would show a false
            // line. The mean over a block has little noise.
            Signal::Drive if problem.settled => {
                let held = block_means(&values, problem);
                Self::new(name, unit, quantiles(&held, BINS), held).held()
            }
            Signal::Link | Signal::Position => {
                let values = if problem.view.constants.slides { values } else { turned(values) };
                Self::new(name, unit, even(&values, ANGLE_BINS), values)
            }
            Signal::Repeat => Self::new(name, unit, levels(&values), values),
            Signal::Direction => {
                let values: Vec<f64> = values.iter().map(|d| if *d > 0.0 { 1.0 } else { -1.0 }).collect();
                let both = values.contains(&1.0) && values.contains(&-1.0);
                let bin = values.iter().map(|d| usize::from(both && *d > 0.0)).collect();
                Self::new(name, unit, bin, values).held()
            }
            _ => Self::new(name, unit, quantiles(&values, BINS), values),
        }
    }

    /// An unknown column as read, and its means over blocks: an unknown sensor may share the noise of the response, and
    /// the mean over a block has little noise.
    fn of_unknown(prepared: &Prepared, signal: Signal) -> (Self, Self) {
        let problem = &prepared.main;
        let values = problem.reduce.apply(problem.view.get(signal).to_vec());
        let (column, unit) = (prepared.column_name(signal), prepared.column_unit(signal));
        let as_read = Self::new(column, unit.clone(), quantiles(&values, BINS), values);
        let held = block_means(&as_read.values, problem);
        let scale = Self::new(column, unit, quantiles(&held, BINS), held);
        (as_read, scale)
    }

    fn new(name: &str, unit: String, bin: Vec<usize>, values: Vec<f64>) -> Self {
        let count = bin.iter().max().map_or(0, |b| b + 1);
        let mut bins = vec![(f64::INFINITY, f64::NEG_INFINITY, 0.0, 0.0f64); count];
        for (b, v) in bin.iter().zip(&values) {
            let (low, high, sum, n) = &mut bins[*b];
            (*low, *high, *sum, *n) = (low.min(*v), high.max(*v), *sum + v, *n + 1.0);
        }
        let bins = bins.into_iter().map(|(from, to, sum, n)| Bin { from, centre: sum / n.max(1.0), to }).collect();
        Self { name: name.into(), unit, values, bin, bins, is_held: false }
    }

    fn held(self) -> Self {
        Self { is_held: true, ..self }
    }

    /// The same quantity in fewer bins with about equally many rows, for a map over two axes.
    pub fn coarse(&self, count: usize) -> Self {
        if self.bins.len() <= count {
            return self.clone();
        }
        let coarse = Self::new(&self.name, self.unit.clone(), quantiles(&self.values, count), self.values.clone());
        Self { is_held: self.is_held, ..coarse }
    }

    /// The absolute value of the quantity.
    pub fn size(&self, name: &str) -> Self {
        let values: Vec<f64> = self.values.iter().map(|v| v.abs()).collect();
        Self::new(name, self.unit.clone(), levels(&values), values)
    }

    /// Whether the axis is the time, or correlates with it nearly perfectly.
    pub fn correlates_with_time(&self) -> bool {
        let middle = 0.5 * (self.bin.len() as f64 - 1.0);
        let mean = self.bin.iter().sum::<usize>() as f64 / self.bin.len() as f64;
        let (mut tt, mut tb, mut bb) = (0.0, 0.0, 0.0);
        for (row, bin) in self.bin.iter().enumerate() {
            let (t, b) = (row as f64 - middle, *bin as f64 - mean);
            (tt, tb, bb) = (tt + t * t, tb + t * b, bb + b * b);
        }
        tb * tb > TIME_AXIS * TIME_AXIS * tt * bb
    }

    fn says_the_same(&self, other: &Self) -> bool {
        let pairs = || self.values.iter().zip(&other.values);
        let range = range(&self.values);
        self.unit == other.unit && pairs().all(|(a, b)| (a - b).abs() <= 0.01 * (range.1 - range.0))
    }
}

/// Angles of more than one turn, folded into one turn.
fn turned(values: Vec<f64>) -> Vec<f64> {
    let (low, high) = range(&values);
    if high - low > TAU { values.into_iter().map(|a| a.rem_euclid(TAU)).collect() } else { values }
}

/// Replaces each value by the mean of its block. The residual contains the noise of the load sensor, so that bins of
/// the noisy load would show a false line.
fn block_means(values: &[f64], problem: &Problem) -> Vec<f64> {
    let mut sums = vec![(0.0, 0.0); problem.blocks];
    for (v, b) in values.iter().zip(&problem.block) {
        sums[*b].0 += v;
        sums[*b].1 += 1.0;
    }
    problem.block.iter().map(|b| sums[*b].0 / sums[*b].1).collect()
}

/// Time since the first row after the last reversal [s].
fn since_reversal(problem: &Problem) -> Vec<f64> {
    let row = |signal| problem.reduce.apply(problem.view.get(signal).to_vec());
    let (time, direction) = (row(Signal::Time), row(Signal::Direction));
    let mut start = 0;
    (0..time.len())
        .map(|i| {
            if i > 0 && (direction[i] > 0.0) != (direction[i - 1] > 0.0) {
                start = i;
            }
            time[i] - time[start]
        })
        .collect()
}

/// Bins of equal width over the range, without empty ones.
fn even(values: &[f64], count: usize) -> Vec<usize> {
    let (low, high) = range(values);
    if high <= low {
        return vec![0; values.len()];
    }
    let width = (high - low) / count as f64;
    let bin: Vec<usize> = values.iter().map(|v| (((v - low) / width) as usize).min(count - 1)).collect();
    let mut used = vec![0; count];
    bin.iter().for_each(|b| used[*b] = 1);
    let number: Vec<usize> = used
        .iter()
        .scan(0, |next, u| {
            *next += u;
            Some(*next)
        })
        .collect();
    bin.iter().map(|b| number[*b] - 1).collect()
}

/// Bins with about equally many rows; equal values share a bin.
fn quantiles(values: &[f64], count: usize) -> Vec<usize> {
    fill(values, count, |_, gap| gap > 0.0)
}

/// The same for set points: values that are close together share a bin.
fn levels(values: &[f64]) -> Vec<usize> {
    fill(values, BINS, |value, gap| gap > SAME_LEVEL * value.abs())
}

/// Fills one bin after the other in the order of the values; `may_part` returns whether a bin may end at a value and
/// gap.
fn fill(values: &[f64], count: usize, may_part: impl Fn(f64, f64) -> bool) -> Vec<usize> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|a, b| values[*a].total_cmp(&values[*b]));
    let full = (values.len() / count).max(1);
    let mut bin = vec![0; values.len()];
    let (mut number, mut held) = (0, 0);
    for (k, i) in order.iter().enumerate() {
        if held >= full && may_part(values[*i], values[*i] - values[order[k - 1]]) {
            number += 1;
            held = 0;
        }
        bin[*i] = number;
        held += 1;
    }
    bin
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn set_points_are_bins_of_their_own() {
        let values: Vec<f64> = (0..60).map(|i| f64::from(i / 10) + 1e-3 * f64::from(i % 10) + 1.0).collect();
        let bin = levels(&values);
        assert_eq!((bin[0], bin[9], bin[10], bin[59]), (0, 0, 1, 5));
    }

    #[test]
    fn empty_bins_of_an_angle_are_left_out() {
        assert_eq!(even(&[0.0, 0.1, 5.9, 6.0], 60), [0, 1, 2, 2]);
    }
}
