//! Significance of an effect: the family-wise p-value over all candidates, by sign flips of blocks (max-T).

use crate::Options;
use crate::regression::candidates::CandidateSet;
use crate::regression::linear_model::Term;
use crate::regression::partial_regression::PartialRegression;
use crate::stats::permutation_test::{MaxTNull, Score};

/// Family-wise p-value of an effect: how often noise makes any candidate of the library as significant as this one.
pub fn significance(term: &Term, library: &CandidateSet, partial: &PartialRegression, options: &Options) -> f64 {
    let scores = library.candidates.iter().map(|c| partial.score(&c.columns, &partial.orthogonalized(&c.columns)));
    family_wise(&term.columns, scores.collect(), partial, options)
}

/// p-value of one effect without other candidates.
pub fn alone(term: &Term, partial: &PartialRegression, options: &Options) -> f64 {
    chance(&term.columns, partial, options)
}

/// p-value of columns without other candidates.
pub fn chance(columns: &[Vec<f64>], partial: &PartialRegression, options: &Options) -> f64 {
    family_wise(columns, Vec::new(), partial, options)
}

/// Family-wise p-value with given scores of the candidates.
pub fn family_wise(
    columns: &[Vec<f64>],
    mut scores: Vec<Score>,
    partial: &PartialRegression,
    options: &Options,
) -> f64 {
    let score = partial.score(columns, &partial.orthogonalized(columns));
    let z = score.z().max(partial.jackknife_z(columns).unwrap_or(f64::NEG_INFINITY));
    scores.push(score);
    MaxTNull::new(&scores, options.flips, options.seed).p_value(z)
}
