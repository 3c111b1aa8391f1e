//! Tests an effect that differs from leg to leg against the scatter between legs.
//!
//! The permutation test flips the signs of blocks, and blocks are parts of long legs. An offset of a whole leg is
//! common to all its blocks. An example is the rest position of an encoder in its coupling or of a gear. A few
//! consecutive legs can then differ like a step in time.

use crate::Options;
use crate::effect::ShapeSearch;
use crate::linear::basis::{Basis, dot};
use crate::preprocess::Problem;
use crate::preprocess::design::segments::stretches;
use crate::preprocess::independent_blocks::legs;
use crate::regression::linear_model::{LinearModel, Term};
use crate::regression::partial_regression::{PartialRegression, jackknife_p_value, products};
use crate::regression::significance::chance;
use crate::selection::acceptance::Candidate;
use crate::selection::acceptance::formula_error::AcceptanceThreshold;
use crate::stats::grouped::{means, within};
use crate::thresholds::{NOISE_ERRORS, SAME_SHAPE};
use jointbench_instrument::Kind;
use statrs::distribution::{ContinuousCDF, FisherSnedecor};
use std::ops::Range;

/// Rejects an effect whose part that is orthogonal to the model is explained by the scatter of whole legs. An effect
/// that differs from leg to leg has to pass an F-test of the leg means. A step counts as one of several places: it
/// can lie between any two legs, and a step within a leg moves the mean of that leg too.
pub(super) fn passes(candidate: &Candidate) -> bool {
    let Candidate { term, now, partial, threshold: AcceptanceThreshold { kind, options, .. }, .. } = *candidate;
    // A friction run has one leg for each speed and direction, so that its blocks already are its legs.
    if kind == Kind::Friction {
        return true;
    }
    let legs = stretches(&legs(now.problem));
    let steps = term.form.shape.iter().any(|shape| shape.search == ShapeSearch::Jump);
    let orthogonalized: Vec<Vec<f64>> = term.columns.iter().map(|column| partial.basis.rest(column)).collect();
    if !steps && !orthogonalized.iter().all(|column| is_between(column, &legs)) {
        return shows_within(&orthogonalized, &legs, partial, now.problem, options)
            || shows_between(&orthogonalized, term, &legs, partial, options);
    }
    // The leg-constant columns of the model use degrees of freedom of the leg means.
    let taken = now.columns().into_iter().filter(|column| is_between(column, &legs)).count() as f64;
    let explained = orthogonalized.len() as f64;
    let free = legs.len() as f64 - taken - explained;
    if free < 1.0 {
        return !(steps && orthogonalized.iter().all(|column| is_small(column, &partial.residual)));
    }
    let plain = means(&partial.residual, &legs);
    let left = Basis::of(&orthogonalized.iter().map(|column| means(column, &legs)).collect::<Vec<_>>()).rest(&plain);
    let (before, after) = (dot(&plain, &plain), dot(&left, &left));
    let f = (before - after) / explained / (after / free).max(f64::MIN_POSITIVE);
    let places = if steps { legs.len() as f64 - 1.0 } else { 1.0 };
    !FisherSnedecor::new(explained, free).is_ok_and(|law| places * (1.0 - law.cdf(f)) > options.alpha)
}

/// Whether an effect of a model is significant within blocks, with a separate offset for each block.
pub fn shows_within_blocks(term: &Term, now: &LinearModel, options: &Options) -> bool {
    let without = now.without(term.id());
    let partial = PartialRegression::of(&without);
    let orthogonalized: Vec<Vec<f64>> = term.columns.iter().map(|column| partial.basis.rest(column)).collect();
    shows_within(&orthogonalized, &stretches(&without.problem.block), &partial, without.problem, options)
}

/// Whether the effect is significant within legs, with a separate offset for each leg.
fn shows_within(
    orthogonalized: &[Vec<f64>],
    legs: &[Range<usize>],
    partial: &PartialRegression,
    problem: &Problem,
    options: &Options,
) -> bool {
    let within = |column: &Vec<f64>| within(column, legs);
    let basis = Basis::of(&partial.basis.vectors().iter().map(within).collect::<Vec<_>>());
    let residual = basis.rest(&within(&partial.residual));
    let columns: Vec<Vec<f64>> = orthogonalized.iter().map(within).collect();
    chance(&columns, &PartialRegression::new(basis, residual, problem), options) <= options.alpha
}

/// Whether the coefficient of the effect is significant in a delete-one-leg jackknife.
fn shows_between(
    orthogonalized: &[Vec<f64>],
    term: &Term,
    legs: &[Range<usize>],
    partial: &PartialRegression,
    options: &Options,
) -> bool {
    let mut taken = vec![0.0; partial.residual.len()];
    for (column, coefficient) in orthogonalized.iter().zip(partial.orthogonalized(&term.columns).coefficients()) {
        taken.iter_mut().zip(column).for_each(|(t, v)| *t += coefficient * v);
    }
    let (sums, squares) = (products(&taken, &partial.residual, legs), products(&taken, &taken, legs));
    jackknife_p_value(&sums, &squares).is_some_and(|chance| chance <= options.alpha)
}

/// For too few legs to estimate their scatter: a step is rejected unless it exceeds the scatter of the readings.
fn is_small(column: &[f64], residual: &[f64]) -> bool {
    let (square, along) = (dot(column, column), dot(column, residual));
    let left = (dot(residual, residual) - along * along / square).max(0.0) / residual.len() as f64;
    (along / square).abs() < NOISE_ERRORS * left.sqrt()
}

fn is_between(column: &[f64], legs: &[Range<usize>]) -> bool {
    let of_legs = means(column, legs).into_iter().zip(legs);
    of_legs.map(|(mean, leg)| leg.len() as f64 * mean * mean).sum::<f64>() > SAME_SHAPE * dot(column, column)
}

#[cfg(test)]
mod tests {
    use crate::selection::tiny::Tiny;
    use jointbench_instrument::Kind;

    #[test]
    fn a_temperature_that_is_unrelated_to_the_scatter_of_legs_is_rejected() {
        let is_random = |of_temperature: f64, of_legs: f64| {
            let warm = |leg: usize| (2.1 * leg as f64).sin();
            let tiny = Tiny::warmed(
                Kind::Encoder,
                &["offset"],
                |row| 25.0 + warm(row.leg),
                |row| of_temperature * warm(row.leg) + of_legs * row.leg_scatter + 0.1 * row.scatter,
            );
            !tiny.passes(super::passes, "temperature_drift", Vec::new())
        };
        assert!(is_random(0.0, 1.0) && !is_random(1.0, 0.1));
    }
}
