//! Effects that were added and removed again.

use crate::regression::cross_validation::validation_rms;
use crate::selection::floating_search::FloatingSearch;

/// An effect that was added and removed again, with the validation RMS that the last model has with it.
pub struct Withdrawn<'p> {
    pub effect: &'p str,
    pub why: RemovalReason,
    pub validation_rms: f64,
}

#[derive(Clone, Copy, PartialEq, Eq)]
pub enum RemovalReason {
    /// The run does not determine its size or shape.
    Unidentified,
    /// It explains only a part of the structure over its own axis.
    PartialExplanation,
    /// Together with a free function of the axis with structure it explains nothing.
    Spurious,
    /// A random-walk offset explains as much.
    RandomWalk,
    /// Its coefficients are physically impossible.
    Infeasible,
    /// Later effects explain the same.
    Insignificant,
}

impl RemovalReason {
    pub fn words(self) -> &'static str {
        match self {
            RemovalReason::Unidentified => "this run does not determine its size",
            RemovalReason::PartialExplanation => "it explains only part of the structure over its axis",
            RemovalReason::Spurious => "it explains nothing beyond the remaining structure",
            RemovalReason::RandomWalk => "a zero that drifts over time explains as much",
            RemovalReason::Infeasible => "its size would be physically impossible",
            RemovalReason::Insignificant => "it adds nothing to the other effects",
        }
    }
}

/// Effects that were removed and stayed out, with the known reason or the one of the search itself.
pub fn all<'p>(search: &FloatingSearch<'_, 'p>, reasons: &[(&'p str, RemovalReason)]) -> Vec<Withdrawn<'p>> {
    let of = |effect: &'p str| {
        let with = search.model_with(effect);
        let mut sized = with.terms.iter().zip(with.linear().coefficients);
        let of_search = match sized.all(|(term, coefficients)| term.id() != effect || term.allows(&coefficients)) {
            true => RemovalReason::Insignificant,
            false => RemovalReason::Infeasible,
        };
        let why = reasons.iter().find(|(id, _)| *id == effect).map_or(of_search, |(_, why)| *why);
        Withdrawn { effect, why, validation_rms: validation_rms(&with) }
    };
    search.given_back().map(of).collect()
}
