//! Residual maps: where the model fails, with bands that hold for all regions of all maps together.

use crate::Options;
use crate::linear::dot;
use crate::prepare::Problem;
use crate::view::Signal;
use statrs::distribution::{ContinuousCDF, StudentsT};

/// One bin of one map.
#[derive(Debug, Clone)]
pub struct MapFinding {
    pub axis: Signal,
    pub from: f64,
    pub to: f64,
    /// Sign of the motion, where the map keeps directions apart.
    pub direction: Option<f64>,
    pub mean: f64,
    pub half_width: f64,
    pub rows: usize,
}

/// All maps of one residual.
pub struct Maps {
    /// Bins whose residual is not noise, the worst first.
    pub findings: Vec<MapFinding>,
    /// Share of the squared error that the best map would take off held-out data, with its axis.
    pub removable: Option<(Signal, f64)>,
}

const BINS: usize = 24;
const ANGLE_BINS: usize = 60;

struct Map {
    axis: Signal,
    by_direction: bool,
    /// Bin of every row.
    bin: Vec<usize>,
    edges: Vec<f64>,
}

impl Maps {
    pub fn new(problem: &Problem, residual: &[f64], options: &Options) -> Self {
        let maps = layouts(problem);
        let energy = dot(residual, residual);
        let mut findings = Vec::new();
        let mut removable: Option<(Signal, f64)> = None;
        for map in &maps {
            let share = held_out_share(map, problem, residual, energy);
            if removable.is_none_or(|r| share > r.1) {
                removable = Some((map.axis, share));
            }
            let bins = map.bin.iter().max().map_or(0, |b| b + 1);
            for b in 0..bins {
                let Some(Stretch { mean, error, pieces, rows }) = stretch(map, b, problem, residual) else { continue };
                let (bin, direction) =
                    if map.by_direction { (b / 2, Some(if b % 2 == 0 { -1.0 } else { 1.0 })) } else { (b, None) };
                let (from, to) = (map.edges[bin], map.edges[bin + 1]);
                findings
                    .push((pieces, MapFinding { axis: map.axis, from, to, direction, mean, half_width: error, rows }));
            }
        }
        // Bonferroni over all bins of all maps: bands that hold together, whatever the maps have in common.
        let alpha = options.alpha / findings.len().max(1) as f64;
        let mut findings: Vec<MapFinding> = findings
            .into_iter()
            .filter_map(|(pieces, mut f)| {
                let t = StudentsT::new(0.0, 1.0, (pieces - 1) as f64).ok()?;
                f.half_width *= t.inverse_cdf(1.0 - alpha / 2.0);
                (f.mean.abs() > f.half_width).then_some(f)
            })
            .collect();
        findings.sort_by(|a, b| (b.mean.powi(2) * b.rows as f64).total_cmp(&(a.mean.powi(2) * a.rows as f64)));
        Self { findings, removable }
    }
}

/// Mean of the residual in one bin, with its standard error over the blocks that pass through it.
struct Stretch {
    mean: f64,
    error: f64,
    pieces: usize,
    rows: usize,
}

/// `None` where fewer than three blocks pass: one bin of one block says nothing about the next.
fn stretch(map: &Map, bin: usize, problem: &Problem, residual: &[f64]) -> Option<Stretch> {
    let mut pieces: Vec<(usize, f64, f64)> = Vec::new();
    for (i, _) in map.bin.iter().enumerate().filter(|(_, b)| **b == bin) {
        match pieces.last_mut() {
            Some((block, sum, n)) if *block == problem.block[i] => {
                *sum += residual[i];
                *n += 1.0;
            }
            _ => pieces.push((problem.block[i], residual[i], 1.0)),
        }
    }
    let g = pieces.len();
    if g < 3 {
        return None;
    }
    let rows: f64 = pieces.iter().map(|p| p.2).sum();
    let mean = pieces.iter().map(|p| p.1).sum::<f64>() / rows;
    let spread: f64 = pieces.iter().map(|p| (p.1 - mean * p.2).powi(2)).sum();
    let error = (spread * g as f64 / (g - 1) as f64).sqrt() / rows;
    Some(Stretch { mean, error, pieces: g, rows: rows as usize })
}

fn layouts(problem: &Problem) -> Vec<Map> {
    let direction = problem.reduce.apply(problem.view.get(Signal::Direction).to_vec());
    let mut maps = Vec::new();
    for (axis, by_direction, turn) in [
        (Signal::Velocity, false, false),
        (Signal::Link, true, true),
        (Signal::Link, false, true),
        (Signal::Position, true, true),
        (Signal::Position, false, true),
        (Signal::Load, true, false),
        (Signal::Temperature, false, false),
        (Signal::Time, false, false),
        (Signal::Current, false, false),
    ] {
        let Some(values) = problem.view.find(axis) else { continue };
        let values = problem.reduce.apply(values.to_vec());
        let steady = problem.settled && matches!(axis, Signal::Velocity | Signal::Load);
        let values = if steady { block_means(&values, problem) } else { values };
        let values: Vec<f64> =
            if turn { values.iter().map(|a| a.rem_euclid(std::f64::consts::TAU)).collect() } else { values };
        let (mut bin, edges) = if turn { even_bins(&values, ANGLE_BINS) } else { equal_bins(&values, BINS) };
        if edges.len() < 3 {
            continue;
        }
        if by_direction {
            bin.iter_mut().zip(&direction).for_each(|(b, d)| *b = *b * 2 + usize::from(*d > 0.0));
        }
        maps.push(Map { axis, by_direction, bin, edges });
    }
    maps
}

/// Each value replaced by the mean of its block. The residual holds the noise of the load sensor: sorted by the noisy
/// load itself it would show a line that is not there.
fn block_means(values: &[f64], problem: &Problem) -> Vec<f64> {
    let mut sums = vec![(0.0, 0.0); problem.blocks];
    for (v, b) in values.iter().zip(&problem.block) {
        sums[*b].0 += v;
        sums[*b].1 += 1.0;
    }
    problem.block.iter().map(|b| sums[*b].0 / sums[*b].1).collect()
}

/// Bins of equal width over the range.
fn even_bins(values: &[f64], count: usize) -> (Vec<usize>, Vec<f64>) {
    let (low, high) = values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
    if high <= low {
        return (vec![0; values.len()], vec![low, high]);
    }
    let width = (high - low) / count as f64;
    let bin = values.iter().map(|v| (((v - low) / width) as usize).min(count - 1)).collect();
    (bin, (0..=count).map(|i| low + width * i as f64).collect())
}

/// Bins with about equally many rows; equal values stay together.
fn equal_bins(values: &[f64], count: usize) -> (Vec<usize>, Vec<f64>) {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let n = sorted.len();
    let mut edges: Vec<f64> = (0..count).map(|i| sorted[i * n / count]).collect();
    edges.push(sorted[n - 1]);
    edges.dedup();
    let last = edges.len().saturating_sub(2);
    let bin = values.iter().map(|v| edges.partition_point(|e| e <= v).saturating_sub(1).min(last)).collect();
    (bin, edges)
}

/// What the means of the bins, taken from the other folds, take off a fold's squared error.
fn held_out_share(map: &Map, problem: &Problem, residual: &[f64], energy: f64) -> f64 {
    let bins = map.bin.iter().max().map_or(0, |b| b + 1);
    let mut sum = vec![0.0; bins];
    let mut count = vec![0.0; bins];
    let mut fold_sum = vec![0.0; bins * problem.folds];
    let mut fold_count = vec![0.0; bins * problem.folds];
    for (i, b) in map.bin.iter().enumerate() {
        sum[*b] += residual[i];
        count[*b] += 1.0;
        fold_sum[problem.fold[i] * bins + b] += residual[i];
        fold_count[problem.fold[i] * bins + b] += 1.0;
    }
    let mut saved = 0.0;
    for (at, n) in fold_count.iter().enumerate() {
        let b = at % bins;
        let others = count[b] - n;
        if *n == 0.0 || others == 0.0 {
            continue;
        }
        let predicted = (sum[b] - fold_sum[at]) / others;
        saved += 2.0 * predicted * fold_sum[at] - n * predicted * predicted;
    }
    if energy > 0.0 { saved / energy } else { 0.0 }
}
