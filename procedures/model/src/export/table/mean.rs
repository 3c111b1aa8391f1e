//! Mean curves of hysteresis effects, the best approximation in a table.

use crate::ModelError;
use crate::export::load_noise::remembered;
use crate::export::parts::Parts;
use crate::export::table::axes::{cell, even};
use crate::linear::cholesky::Cholesky;
use crate::prediction::predict_on;
use crate::preprocess::Problem;
use crate::report::fit::{Fit, MeanCurve};
use crate::signal::Signal;

/// Signals with a persistent hysteresis at steady state; the hysteresis over a position vanishes after a long motion
/// in one direction.
const WAYS: [Signal; 2] = [Signal::Current, Signal::Load];

/// Whether the steady-state value over the signal depends on its history.
pub fn has_ways(signal: Signal) -> bool {
    WAYS.contains(&signal)
}

/// Small smoothness penalty for points without rows of the run.
const RIDGE: f64 = 1e-6;

/// Each hysteresis effect as a piecewise linear curve over its signal, fitted to the rows of the run.
pub fn curves(fit: &Fit, problem: &Problem) -> Result<Vec<MeanCurve>, ModelError> {
    let named = crate::formula::signals(fit.kind);
    let mut curves = Vec::new();
    for part in Parts::of(fit)?.parts {
        let Some(signal) = remembered(&part).filter(|signal| has_ways(*signal)) else { continue };
        let name = named.iter().find(|s| s.signal == signal).map_or("", |s| s.name);
        let range = fit.scope.iter().flat_map(|scope| &scope.signals).find(|range| range.name == name);
        let (Some(range), Some(values)) = (range, problem.view.find(signal)) else { continue };
        let alone = Fit {
            effects: vec![part.effect.to_owned()],
            terms: fit.terms.iter().filter(|term| term.effect == part.effect).cloned().collect(),
            ..fit.clone()
        };
        let held = predict_on(&alone, &problem.view, problem.rows(), |column| problem.reduce.apply(column))?;
        let at = even(range);
        let x = problem.reduce.apply(values.to_vec());
        let mean = nearest(&at, &x, &held);
        let mut curve = MeanCurve { effect: part.effect.into(), signal: name.into(), at, mean, off_rms: 0.0 };
        let sse: f64 = x.iter().zip(&held).map(|(x, held)| (held - curve.value(*x)).powi(2)).sum();
        curve.off_rms = (sse / held.len().max(1) as f64).sqrt();
        curves.push(curve);
    }
    Ok(curves)
}

/// Values of the piecewise linear curve that fits `y` best, smooth where the rows do not determine it.
fn nearest(at: &[f64], x: &[f64], y: &[f64]) -> Vec<f64> {
    let n = at.len();
    let (mut gram, mut side) = (vec![0.0; n * n], vec![0.0; n]);
    let mut add = |weights: &[(usize, f64)], times: f64, y: f64| {
        for (i, a) in weights {
            side[*i] += times * a * y;
            weights.iter().for_each(|(j, b)| gram[i * n + j] += times * a * b);
        }
    };
    for (x, y) in x.iter().zip(y) {
        let (cell, share) = cell(at, *x);
        add(&[(cell, 1.0 - share), (cell + 1, share)], 1.0, *y);
    }
    let bend = RIDGE * x.len() as f64;
    (1..n - 1).for_each(|k| add(&[(k - 1, 1.0), (k, -2.0), (k + 1, 1.0)], bend, 0.0));
    Cholesky::new(&gram, n, 1e-12).solve(&side)
}

impl MeanCurve {
    /// Linear interpolation; beyond the ends the value of the end applies.
    pub(crate) fn value(&self, x: f64) -> f64 {
        if self.at.len() < 2 || self.mean.len() < self.at.len() {
            return 0.0;
        }
        let (cell, share) = cell(&self.at, x);
        self.mean[cell] + share * (self.mean[cell + 1] - self.mean[cell])
    }
}
