//! Residual maps: where the model fails, with bands that hold for all regions of all maps together.

use super::flips::{Null, Score};
use crate::Options;
use crate::linear::{Basis, dot};
use crate::prepare::Problem;
use crate::view::Signal;

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
    pub z: f64,
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
    pub fn new(problem: &Problem, basis: &Basis, residual: &[f64], options: &Options) -> Self {
        let maps = layouts(problem);
        let energy = dot(residual, residual);
        let mut scores = Vec::new();
        let mut findings = Vec::new();
        let mut removable: Option<(Signal, f64)> = None;
        for map in &maps {
            let share = held_out_share(map, problem, residual, energy);
            if removable.is_none_or(|r| share > r.1) {
                removable = Some((map.axis, share));
            }
            let bins = map.bin.iter().max().map_or(0, |b| b + 1);
            for b in 0..bins {
                let rows: Vec<usize> = (0..residual.len()).filter(|i| map.bin[*i] == b).collect();
                let mut seen: Vec<usize> = rows.iter().map(|i| problem.block[*i]).collect();
                seen.dedup();
                if rows.len() < 3 || seen.len() < 3 {
                    continue;
                }
                let mut indicator = vec![0.0; residual.len()];
                rows.iter().for_each(|i| indicator[*i] = 1.0);
                let own = basis.rest(&indicator);
                let mean = rows.iter().map(|i| residual[*i]).sum::<f64>() / rows.len() as f64;
                let score = Score::new(&[own], residual, &problem.block, problem.blocks);
                let z = score.z();
                scores.push(score);
                let (bin, direction) =
                    if map.by_direction { (b / 2, Some(if b % 2 == 0 { -1.0 } else { 1.0 })) } else { (b, None) };
                findings.push(MapFinding {
                    axis: map.axis,
                    from: map.edges[bin],
                    to: map.edges[bin + 1],
                    direction,
                    mean,
                    half_width: 0.0,
                    rows: rows.len(),
                    z,
                });
            }
        }
        let null = Null::new(&scores, problem.blocks, options.flips.min(299), options.seed ^ 0x6d61_7073);
        let critical = null.critical(options.alpha);
        let n = residual.len() as f64;
        for f in &mut findings {
            // The band in units of the mean: as far as the score would fall to the critical one.
            f.half_width = f.mean.abs() * (critical.max(0.1) / f.z.max(0.1)).min(50.0);
        }
        findings.retain(|f| f.z > critical);
        findings.sort_by(|a, b| (b.mean.powi(2) * b.rows as f64 / n).total_cmp(&(a.mean.powi(2) * a.rows as f64 / n)));
        Self { findings, removable }
    }
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
