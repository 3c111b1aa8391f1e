//! How often noise alone would bring an effect as far: the family-wise p-value over all candidates.

use crate::Options;
use crate::regression::candidates::CandidateSet;
use crate::regression::linear_model::Term;
use crate::regression::partial_regression::PartialRegression;
use crate::stats::permutation_test::{MaxTNull, Score};

/// How often noise alone would bring any candidate of the library as far as this one: the family-wise p-value.
pub fn significance(term: &Term, library: &CandidateSet, ground: &PartialRegression, options: &Options) -> f64 {
    let scores = library.candidates.iter().map(|c| ground.score(&c.columns, &ground.own(&c.columns)));
    family_wise(&term.columns, scores.collect(), ground, options)
}

/// The p-value of one effect that nothing else was tried beside.
pub fn alone(term: &Term, ground: &PartialRegression, options: &Options) -> f64 {
    chance(&term.columns, ground, options)
}

/// The same of its columns.
pub fn chance(columns: &[Vec<f64>], ground: &PartialRegression, options: &Options) -> f64 {
    family_wise(columns, Vec::new(), ground, options)
}

/// The same from scores that are there already.
pub fn family_wise(columns: &[Vec<f64>], mut scores: Vec<Score>, ground: &PartialRegression, options: &Options) -> f64 {
    let own = ground.score(columns, &ground.own(columns));
    let z = own.z().max(ground.jackknife_z(columns).unwrap_or(f64::NEG_INFINITY));
    scores.push(own);
    MaxTNull::new(&scores, options.flips, options.seed).p_value(z)
}
