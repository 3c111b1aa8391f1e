//! Rejects aliased periodic candidates: signals that only look like a wave over an angle.
//!
//! A signal that repeats with time looks at one speed like a wave over the angle with a suitable order. Examples are
//! encoder counts that beat with the sampling, and the settling of a drive after each reversal. A real wave over the
//! angle shows at every speed at which it passes slowly enough. It shows in the samples as well as in their means.

use crate::linear::basis::{Basis, dot};
use crate::preprocess::Problem;
use crate::preprocess::design::segments::stretches;
use crate::regression::linear_model::Term;
use crate::regression::partial_regression::{PartialRegression, products};
use crate::selection::acceptance::Candidate;
use crate::signal::{Signal, Signals};
use crate::thresholds::{EVEN_SPEED, LARGER_PART, NOISE_ERRORS};
use crate::view::View;
use std::f64::consts::PI;
use std::ops::Range;

/// More sample rows than these add no information.
const MOST_ROWS: usize = 4_000;

/// Passes all candidates but waves that are missing in data where they have to be present.
pub(super) fn passes(candidate: &Candidate) -> bool {
    let Candidate { term, now, partial, .. } = candidate;
    if term.effect.traits().wave.is_none() || !now.problem.settled || term.columns.is_empty() {
        return true;
    }
    let part = Part::of(term, now.problem, partial);
    !part.shows_at_one_speed(now.problem) && !part.is_beat(term, now.problem)
}

/// A candidate wave, orthogonal to the model, with its least-squares coefficients.
struct Part {
    stretches: Vec<Range<usize>>,
    coefficients: Vec<f64>,
    /// Error reduction in each stretch, and the reduction that is expected if the wave is present with the same
    /// amplitude.
    found: Vec<f64>,
    expected: Vec<f64>,
}

impl Part {
    fn of(term: &Term, problem: &Problem, partial: &PartialRegression) -> Self {
        let stretches = stretches(&problem.segment);
        let coefficients = partial.orthogonalized(&term.columns).coefficients();
        let mut wave = vec![0.0; problem.rows()];
        for (column, coefficient) in term.columns.iter().zip(&coefficients) {
            wave.iter_mut().zip(partial.basis.rest(column)).for_each(|(w, c)| *w += coefficient * c);
        }
        let (found, expected) = (products(&wave, &partial.residual, &stretches), products(&wave, &wave, &stretches));
        Self { stretches, coefficients, found, expected }
    }

    /// Whether the wave shows only at the speed at which it explains most, although other speeds would show it too.
    fn shows_at_one_speed(&self, problem: &Problem) -> bool {
        let velocity = problem.view.get(Signal::Velocity);
        let mean = |rows: &Range<usize>| velocity[rows.clone()].iter().sum::<f64>() / rows.len() as f64;
        let mut by_speed: Vec<(f64, usize)> =
            self.stretches.iter().enumerate().map(|(k, rows)| (mean(rows).abs(), k)).collect();
        by_speed.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut found = vec![0.0];
        by_speed.iter().for_each(|(_, k)| found.push(found[found.len() - 1] + self.found[*k]));
        let slower = |than: f64| by_speed.partition_point(|(speed, _)| *speed < than);
        let near = |speed: f64| slower((1.0 - EVEN_SPEED) * speed)..slower((1.0 + EVEN_SPEED) * speed);
        let gain = |speed: f64| found[near(speed).end] - found[near(speed).start];
        let Some((main, _)) = by_speed.iter().max_by(|a, b| gain(a.0).total_cmp(&gain(b.0))) else { return false };
        let here = near(*main);
        let others = by_speed[..here.start].iter().chain(&by_speed[here.end..]);
        let (found, expected): (Vec<f64>, Vec<f64>) = others.map(|(_, k)| (self.found[*k], self.expected[*k])).unzip();
        is_missing(&found, &expected)
    }

    /// Whether the wave shows only where more than half a period passes for each mean (Shannon 1949), and the samples
    /// behind those means do not contain it.
    fn is_beat(&self, term: &Term, problem: &Problem) -> bool {
        let view = &problem.view;
        let Some(angle) = term.effect.traits().wave.and_then(|angle| view.samples.find(angle)) else { return false };
        let order = term.shape.first().copied().unwrap_or_default();
        let is_fast = |rows: &Range<usize>| {
            let chunks = &view.chunks[rows.clone()];
            let way: f64 = chunks.iter().map(|c| (angle[c.end - 1] - angle[c.start]).abs()).sum();
            order * way > PI * chunks.len() as f64
        };
        let mut fast: Vec<usize> = (0..self.stretches.len()).filter(|k| is_fast(&self.stretches[*k])).collect();
        let (whole, part): (f64, f64) = (self.found.iter().sum(), fast.iter().map(|k| self.found[*k]).sum());
        if part < LARGER_PART * whole || problem.sampled.is_empty() {
            return false;
        }
        let mut rows = 0;
        fast.retain(|k| {
            rows += self.stretches[*k].len();
            rows <= MOST_ROWS
        });
        let expected: Vec<f64> = fast.iter().map(|k| self.expected[*k]).collect();
        let share = fast.iter().map(|k| self.share_of_samples(term, problem, &self.stretches[*k]));
        let found: Vec<f64> = share.zip(&expected).map(|(share, expected)| share * expected).collect();
        is_missing(&found, &expected)
    }

    /// Found amplitude in the samples of a stretch, relative to the expected amplitude.
    fn share_of_samples(&self, term: &Term, problem: &Problem, rows: &Range<usize>) -> f64 {
        let view = &problem.view;
        let range = view.chunks[rows.start].start..view.chunks[rows.end - 1].end;
        let mut signals = Signals::new(range.len());
        view.samples.iter().for_each(|(signal, values)| signals.set(signal, values[range.clone()].to_vec()));
        let load = signals.find(Signal::Load).map(<[f64]>::to_vec);
        let at = View::new(signals.clone(), signals, Vec::new(), vec![0], view.sample_s);
        let trend = (0..range.len()).map(|i| i as f64).collect();
        let basis = Basis::of([vec![1.0; range.len()], trend].iter().chain(&load));
        let mut wave = vec![0.0; range.len()];
        for (column, coefficient) in
            term.effect.columns(term.form.name, &term.shape, &at).iter().zip(&self.coefficients)
        {
            wave.iter_mut().zip(basis.rest(column)).for_each(|(w, c)| *w += coefficient * c);
        }
        dot(&wave, &problem.sampled[range]) / dot(&wave, &wave).max(f64::MIN_POSITIVE)
    }
}

/// Whether the larger part of the expected reduction is missing, and the difference to all of it is significant.
fn is_missing(found: &[f64], expected: &[f64]) -> bool {
    let (sum, all) = (found.iter().sum::<f64>(), expected.iter().sum::<f64>());
    if all <= 0.0 {
        return false;
    }
    let share = sum / all;
    let error = found.iter().zip(expected).map(|(f, a)| (f - share * a).powi(2)).sum::<f64>().sqrt() / all;
    share < LARGER_PART && 1.0 - share > NOISE_ERRORS * error
}

#[cfg(test)]
mod tests {
    use crate::selection::tiny::Tiny;
    use jointbench_instrument::Kind;

    #[test]
    fn a_wave_that_shows_at_one_speed_only_is_an_alias() {
        let is_alias = |shows: fn(f64) -> bool| {
            let tiny = Tiny::new(Kind::Friction, &["coulomb"], |row| {
                let wave = if shows(row.velocity.abs()) { (2.0 * row.angle).cos() } else { 0.0 };
                5.0 * row.direction + wave + 0.1 * row.scatter
            });
            !tiny.passes(super::passes, "cogging", vec![2.0])
        };
        assert!(is_alias(|speed| speed == 6.0));
        assert!(!is_alias(|_| true));
    }
}
