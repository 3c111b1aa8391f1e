//! The interval of a changepoint. The model is not differentiable in it, so that the interval contains all moments
//! that fit nearly as well.

use crate::linear::basis::dot;
use crate::regression::linear_model::{LinearModel, Term};
use crate::signal::Signal;

/// 95 % point of the likelihood ratio of a change point (Hansen 2000, table 1).
const RATIO_95: f64 = 7.35;

/// Tested rows on each side.
const FARTHEST: usize = 400;

/// Moments whose squared error exceeds the minimum by no more than the noise allows. The interval includes at least
/// the rows next to the changepoint.
pub fn interval(terms: &LinearModel, residual: &[f64], term: usize, shape: usize) -> [f64; 2] {
    let times = terms.problem.reduce.apply(terms.problem.view.get(Signal::Time).to_vec());
    let best = terms.terms[term].shape[shape];
    let sse = |moment: f64| {
        let mut trial = terms.clone();
        let Term { effect, form, shape: known, .. } = &terms.terms[term];
        let mut moved = known.clone();
        moved[shape] = moment;
        trial.terms[term] = Term::new(*effect, form.clone(), moved, terms.problem);
        trial.linear().sse
    };
    let allowed = dot(residual, residual) + RATIO_95 * long_run_variance(residual);
    let at = times.partition_point(|t| *t < best);
    let earlier = times[..at].iter().rev().take(FARTHEST).find(|t| sse(**t) > allowed);
    let later = times[at..].iter().skip(1).take(FARTHEST).find(|t| sse(**t) > allowed);
    let (first, last) = (times.first().copied().unwrap_or(best), times.last().copied().unwrap_or(best));
    [earlier.copied().unwrap_or(first), later.copied().unwrap_or(last)]
}

/// Long-run variance of the residual: an AR(1) process with its lag-one correlation.
fn long_run_variance(residual: &[f64]) -> f64 {
    let square = dot(residual, residual);
    if square == 0.0 {
        return 0.0;
    }
    let lag: f64 = residual.windows(2).map(|w| w[0] * w[1]).sum();
    let correlation = (lag / square).clamp(0.0, 0.95);
    square / residual.len() as f64 * (1.0 + correlation) / (1.0 - correlation)
}
