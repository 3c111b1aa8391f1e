//! Unexplained structure that no effect of the library explains: functions of an axis, a spectral line in time, and
//! correlation of neighbouring moments.

use crate::linear::added_columns::Added;
use crate::linear::basis::dot;
use crate::linear::blocked_ridge::{BlockedRidge, ranges};
use crate::linear::cholesky::Cholesky;
use crate::preprocess::Problem;
use crate::preprocess::form_error::FormErrorKind;
use crate::regression::solution::{Solution, effect_columns, nuisance};
use crate::regression::two_stage_model::TwoStageModel;
use crate::residual_analysis::functions::{Functions, functions};
use crate::signal::Signal;
use crate::stats::jackknife;
use crate::stats::summary::quantile;
use crate::thresholds::{LEFT_SHARE, NOISE_ERRORS};
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Tested ridge strengths of the free functions.
const RIDGES: [f64; 3] = [1e-3, 1e-2, 1e-1];
/// Residuals are clipped at this number of robust standard deviations for the tests over time.
const MOST_DEVIATIONS: f64 = 6.0;
/// Highest frequency of a tested spectral line [Hz], and the number of steps between two lines of the spectrum.
const FASTEST_LINE_HZ: f64 = 2.0;
const LINE_STEPS: i32 = 4;
/// Averaging time of neighbouring means [s]. Events of a second leave no correlation between longer means.
pub const MEANS_S: f64 = 0.5;

/// Pattern of the structure that remains.
#[derive(Debug, Clone, PartialEq)]
pub enum Pattern {
    /// A function of these signals.
    Function(Vec<Signal>),
    /// A wave in time, with its frequency [Hz].
    Wave(f64),
    /// Correlation of neighbouring means over [`MEANS_S`].
    Correlation,
}

/// Structure that remains.
#[derive(Debug, Clone, PartialEq)]
pub struct Unexplained {
    pub pattern: Pattern,
    /// Share of the squared validation error that a function explains, of the squared residual that a wave explains, or
    /// covariance of neighbouring means as a share of the variance.
    pub share: f64,
    /// Whether a function of an axis explains more than all added effects together.
    pub is_all: bool,
}

/// The significant unexplained structure. `end` is the last model of a search from `start`.
pub fn left(start: &TwoStageModel, end: &TwoStageModel, solution: &Solution) -> Option<Unexplained> {
    let model = &end.main;
    let ridge = &solution.ridge;
    let all = functions(model.problem);
    let judged: Vec<(f64, f64)> = all.par_iter().map(|axis| reduction(ridge, axis)).collect();
    let shows = |share: f64, errors: f64| share > LEFT_SHARE && errors > NOISE_ERRORS;
    let axes = all.iter().zip(&judged).filter(|(_, (share, errors))| shows(*share, *errors));
    let mut found: Vec<(Option<&Functions>, Pattern, f64)> =
        axes.map(|(axis, (share, _))| (Some(axis), Pattern::Function(axis.over.clone()), *share)).collect();
    let weighted = clipped(&solution.residual, &solution.weight);
    let row_s = model.problem.form_error.as_deref().map_or(1.0, |e| e.row_s);
    let direction = model.problem.reduce.apply(model.problem.view.get(Signal::Direction).to_vec());
    let [plain, turned] = neighbours(&weighted, &direction, row_s);
    let (hz, wave) = line(&weighted, model.problem, row_s);
    let over_time = [(Pattern::Wave(hz), wave), (Pattern::Correlation, plain), (Pattern::Correlation, turned)];
    let over_time = over_time.into_iter().filter(|(_, (share, errors))| shows(*share, *errors));
    found.extend(over_time.map(|(pattern, (share, _))| (None, pattern, share)));
    let (axis, pattern, share) = found.into_iter().max_by(|a, b| a.2.total_cmp(&b.2))?;
    let grew = start.effects.len() < end.effects.len();
    let is_all = axis.filter(|_| grew).is_some_and(|axis| explains_all(axis, start, end, solution));
    Some(Unexplained { pattern, share, is_all })
}

fn taken(ridge: &BlockedRidge, axis: &Functions) -> Vec<f64> {
    if axis.columns.is_empty() {
        return vec![0.0; ridge.blocks.len()];
    }
    let scale = |c: &Vec<f32>| c.iter().map(|v| v * v).sum::<f32>() > 0.0;
    let columns: Vec<&Vec<f32>> = axis.columns.iter().filter(|c| scale(c)).collect();
    let added = Added::new(ridge, &columns);
    let of = |strength: &f64| {
        added.gains(*strength, |_| true).iter().map(|gain| gain.validation_losses).collect::<Vec<f64>>()
    };
    let all = RIDGES.iter().map(of);
    all.max_by(|a, b| a.iter().sum::<f64>().total_cmp(&b.iter().sum())).unwrap_or_default()
}

/// Share of the validation losses of a regression that a function of an axis takes, and its logarithm in standard
/// errors.
fn reduction(ridge: &BlockedRidge, axis: &Functions) -> (f64, f64) {
    reduced(&ridge.losses, &taken(ridge, axis))
}

/// Gains of blocks as a share of their losses, and its logarithm in standard errors.
fn reduced(losses: &[f64], gains: &[f64]) -> (f64, f64) {
    let after: Vec<f64> = losses.iter().zip(gains).map(|(loss, gain)| loss - gain).collect();
    let (log, error) = jackknife::log_ratio(losses, &after);
    (1.0 - log.exp(), -log / error.max(f64::MIN_POSITIVE))
}

/// Whether the given model with one free function has a significantly smaller validation error than the last model.
fn explains_all(axis: &Functions, start: &TwoStageModel, end: &TwoStageModel, solution: &Solution) -> bool {
    let plain = &start.main;
    let mut columns = effect_columns(plain);
    let Some(form_error) = plain.problem.form_error.as_deref() else { return false };
    // Form error that an added effect represents is no nuisance here.
    let nuisance = nuisance(plain, form_error, |kind| match kind {
        FormErrorKind::Jerk => end.main.has_delay() && !plain.has_delay(),
        FormErrorKind::Bristle => !std::ptr::eq(plain.problem, end.main.problem),
        FormErrorKind::BristleRate | FormErrorKind::Snap | FormErrorKind::LoadRate => false,
    });
    columns.extend(nuisance.columns());
    let last = &solution.ridge;
    let block = &plain.problem.block;
    let ridge = BlockedRidge::new(&columns, &plain.response(), &solution.weight, block, Some(last.strength));
    let with = ridge.losses.iter().zip(taken(&ridge, axis)).map(|(loss, gain)| loss - gain);
    let better: Vec<f64> = last.losses.iter().zip(with).map(|(end, with)| end - with).collect();
    let (share, errors) = reduced(&last.losses, &better);
    share > LEFT_SHARE && errors > NOISE_ERRORS
}

/// A weighted residual with clipped outliers.
fn clipped(residual: &[f64], weight: &[f64]) -> Vec<f64> {
    let weighted: Vec<f64> = residual.iter().zip(weight).map(|(e, w)| e * w).collect();
    let most = MOST_DEVIATIONS * 1.4826 * quantile(weighted.iter().map(|e| e.abs()), 0.5);
    weighted.into_iter().map(|e| e.clamp(-most, most)).collect()
}

/// Frequency [Hz] of the strongest spectral line in time, and its cross-validated error reduction as a share of the
/// squared residual and in standard errors.
fn line(values: &[f64], problem: &Problem, row_s: f64) -> (f64, (f64, f64)) {
    let blocks = ranges(&problem.block);
    let whole_s = values.len() as f64 * row_s;
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let moments: Vec<f64> = (0..values.len()).map(|i| i as f64 * row_s).collect();
    let power = |hz: f64| {
        let (turn, mut c, mut s) = (TAU * hz * row_s, 0.0, 0.0);
        // One step of a rotation for each row.
        let (sin, cos) = turn.sin_cos();
        let (mut x, mut y) = (1.0, 0.0);
        for v in values {
            c += (v - mean) * x;
            s += (v - mean) * y;
            (x, y) = (x * cos - y * sin, x * sin + y * cos);
        }
        c * c + s * s
    };
    let highest = (FASTEST_LINE_HZ.min(0.5 / row_s) * whole_s) as usize;
    let powers: Vec<f64> = (2..highest.max(2)).into_par_iter().map(|k| power(k as f64 / whole_s)).collect();
    let Some(strongest) = (0..powers.len()).max_by(|a, b| powers[*a].total_cmp(&powers[*b])) else {
        return (0.0, (0.0, 0.0));
    };
    let losses: Vec<f64> = blocks.iter().map(|rows| dot(&values[rows.clone()], &values[rows.clone()])).collect();
    let tried = (-LINE_STEPS..=LINE_STEPS).map(|step| {
        let hz = ((strongest + 2) as f64 + 0.5 * f64::from(step) / f64::from(LINE_STEPS)) / whole_s;
        let waves: [Vec<f64>; 2] = [
            moments.iter().map(|t| (TAU * hz * t).cos()).collect(),
            moments.iter().map(|t| (TAU * hz * t).sin()).collect(),
        ];
        let sums: Vec<[f64; 5]> = blocks
            .iter()
            .map(|rows| {
                let [c, s] = waves.each_ref().map(|wave| &wave[rows.clone()]);
                let y = &values[rows.clone()];
                [dot(c, c), dot(c, s), dot(s, s), dot(c, y), dot(s, y)]
            })
            .collect();
        let all = sums.iter().fold([0.0; 5], |a, b| std::array::from_fn(|k| a[k] + b[k]));
        let gains = sums.iter().map(|of_block| {
            let rest: [f64; 5] = std::array::from_fn(|k| all[k] - of_block[k]);
            let coefficients = Cholesky::new(&[rest[0], rest[1], rest[1], rest[2]], 2, 1e-9).solve(&rest[3..]);
            let there = [
                of_block[0] * coefficients[0] + of_block[1] * coefficients[1],
                of_block[1] * coefficients[0] + of_block[2] * coefficients[1],
            ];
            2.0 * (coefficients[0] * of_block[3] + coefficients[1] * of_block[4]) - dot(&coefficients, &there)
        });
        (hz, reduced(&losses, &gains.collect::<Vec<f64>>()))
    });
    tried.max_by(|a, b| a.1.0.total_cmp(&b.1.0)).unwrap_or_default()
}

/// Covariance of neighbouring means as a share of the variance, and in standard errors: for the residual, and for the
/// residual with the sign of the direction.
fn neighbours(values: &[f64], direction: &[f64], row_s: f64) -> [(f64, f64); 2] {
    let length = ((MEANS_S / row_s).round() as usize).max(1);
    let of = |values: Vec<f64>| {
        let means: Vec<f64> = values.chunks_exact(length).map(|c| c.iter().sum::<f64>() / length as f64).collect();
        let n = means.len().max(1) as f64;
        let mean = means.iter().sum::<f64>() / n;
        let about: Vec<f64> = means.iter().map(|m| m - mean).collect();
        let product = if about.len() > 1 { dot(&about[1..], &about[..about.len() - 1]) } else { 0.0 };
        let middle = values.iter().sum::<f64>() / values.len() as f64;
        let variance = values.iter().map(|v| (v - middle).powi(2)).sum::<f64>() / values.len() as f64;
        let pairs = (n - 1.0).max(1.0);
        (
            product / pairs / variance.max(f64::MIN_POSITIVE),
            product / dot(&about, &about).max(f64::MIN_POSITIVE) * n.sqrt(),
        )
    };
    let turned = values.iter().zip(direction).map(|(v, d)| if *d < 0.0 { -v } else { *v }).collect();
    [of(values.to_vec()), of(turned)]
}
