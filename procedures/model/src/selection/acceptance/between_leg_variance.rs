//! Whether an effect that differs from leg to leg is more than the legs scatter by.
//!
//! The blocks that are turned over are parts of long legs. What a whole leg has in common (where an encoder came to rest in
//! its coupling, where a gear rests) is in all of them, and few legs in a row lie apart like a step in time.

use crate::Options;
use crate::effect::ShapeSearch;
use crate::linear::basis::{Basis, dot};
use crate::preprocess::Problem;
use crate::preprocess::design::segments::stretches;
use crate::preprocess::independent_blocks::legs;
use crate::regression::linear_model::{LinearModel, Term};
use crate::regression::partial_regression::{PartialRegression, jackknife, products};
use crate::regression::significance::chance;
use crate::stats::grouped::{means, within};
use crate::thresholds::{BETWEEN_LEGS, STEP_OVER_READINGS};
use jointbench_instrument::Kind;
use statrs::distribution::{ContinuousCDF, FisherSnedecor};
use std::ops::Range;

/// What the columns of an effect have of their own beside the model, against the scatter of whole legs. What differs from leg
/// to leg has to pass an F-test of their means: a step may lie between any two legs, and one within a leg moves its mean too.
pub fn is_random_leg_effect(
    term: &Term,
    now: &LinearModel,
    ground: &PartialRegression,
    kind: Kind,
    options: &Options,
) -> bool {
    // A friction run has a leg for every speed both ways: its blocks are its legs.
    if kind == Kind::Friction {
        return false;
    }
    let legs = stretches(&legs(now.problem));
    let steps = term.form.shape.iter().any(|shape| shape.search == ShapeSearch::Jump);
    let own: Vec<Vec<f64>> = term.columns.iter().map(|column| ground.basis.rest(column)).collect();
    if !steps && !own.iter().all(|column| is_between(column, &legs)) {
        return !shows_within(&own, &legs, ground, now.problem, options)
            && !shows_between(&own, term, &legs, ground, options);
    }
    // The model has taken its own share of what the legs scatter by.
    let taken = now.columns().into_iter().filter(|column| is_between(column, &legs)).count() as f64;
    let explained = own.len() as f64;
    let free = legs.len() as f64 - taken - explained;
    if free < 1.0 {
        return steps && own.iter().all(|column| is_small(column, &ground.residual));
    }
    let plain = means(&ground.residual, &legs);
    let left = Basis::of(&own.iter().map(|column| means(column, &legs)).collect::<Vec<_>>()).rest(&plain);
    let (before, after) = (dot(&plain, &plain), dot(&left, &left));
    let f = (before - after) / explained / (after / free).max(f64::MIN_POSITIVE);
    let places = if steps { legs.len() as f64 - 1.0 } else { 1.0 };
    FisherSnedecor::new(explained, free).is_ok_and(|law| places * (1.0 - law.cdf(f)) > options.alpha)
}

/// An effect of a model shows within blocks, with a zero of its own for each.
pub fn shows_within_blocks(term: &Term, now: &LinearModel, options: &Options) -> bool {
    let without = now.without(term.id());
    let ground = PartialRegression::of(&without);
    let own: Vec<Vec<f64>> = term.columns.iter().map(|column| ground.basis.rest(column)).collect();
    shows_within(&own, &stretches(&without.problem.block), &ground, without.problem, options)
}

/// The effect shows within legs, with a zero of its own for each.
fn shows_within(
    own: &[Vec<f64>],
    legs: &[Range<usize>],
    ground: &PartialRegression,
    problem: &Problem,
    options: &Options,
) -> bool {
    let within = |column: &Vec<f64>| within(column, legs);
    let basis = Basis::of(&ground.basis.vectors().iter().map(within).collect::<Vec<_>>());
    let residual = basis.rest(&within(&ground.residual));
    let columns: Vec<Vec<f64>> = own.iter().map(within).collect();
    chance(&columns, &PartialRegression::new(basis, residual, problem), options) <= options.alpha
}

/// Its size stands out of what it would be without one leg after the other.
fn shows_between(
    own: &[Vec<f64>],
    term: &Term,
    legs: &[Range<usize>],
    ground: &PartialRegression,
    options: &Options,
) -> bool {
    let mut taken = vec![0.0; ground.residual.len()];
    for (column, factor) in own.iter().zip(ground.own(&term.columns).factors()) {
        taken.iter_mut().zip(column).for_each(|(t, v)| *t += factor * v);
    }
    let (sums, squares) = (products(&taken, &ground.residual, legs), products(&taken, &taken, legs));
    jackknife(&sums, &squares).is_some_and(|chance| chance <= options.alpha)
}

/// Legs too few to tell their scatter: a step is one where it is larger than what the readings scatter by.
fn is_small(column: &[f64], residual: &[f64]) -> bool {
    let (square, along) = (dot(column, column), dot(column, residual));
    let left = (dot(residual, residual) - along * along / square).max(0.0) / residual.len() as f64;
    (along / square).abs() < STEP_OVER_READINGS * left.sqrt()
}

fn is_between(column: &[f64], legs: &[Range<usize>]) -> bool {
    let of_legs = means(column, legs).into_iter().zip(legs);
    of_legs.map(|(mean, leg)| leg.len() as f64 * mean * mean).sum::<f64>() > BETWEEN_LEGS * dot(column, column)
}
