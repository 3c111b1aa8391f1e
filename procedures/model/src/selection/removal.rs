//! Effects that came in and were taken back.

use crate::regression::cross_validation::held_out_rms;
use crate::selection::floating_search::FloatingSearch;

/// An effect that came in and was taken back, with the held-out RMS that the last model would have with it.
pub struct Withdrawn<'p> {
    pub effect: &'p str,
    pub why: RemovalReason,
    pub held_out_rms: f64,
}

#[derive(Clone, Copy, PartialEq, Eq)]
pub enum RemovalReason {
    /// The run does not decide its size or shape.
    Unidentified,
    /// It explains only a part of what shows over its own axis.
    PartialExplanation,
    /// Beside any function of the axis over which structure remains it explains nothing.
    Spurious,
    /// It shows no more than a zero that wanders over time.
    RandomWalk,
    /// It would have to be of an impossible size.
    Infeasible,
    /// Whatever came in since explains the rest of it.
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

/// What was withdrawn and stayed out, for the reasons that are known or those of the search itself.
pub fn all<'p>(search: &FloatingSearch<'_, 'p>, reasons: &[(&'p str, RemovalReason)]) -> Vec<Withdrawn<'p>> {
    let of = |effect: &'p str| {
        let with = search.model_with(effect);
        let mut sized = with.terms.iter().zip(with.linear().factors);
        let of_search = match sized.all(|(term, factors)| term.id() != effect || term.allows(&factors)) {
            true => RemovalReason::Insignificant,
            false => RemovalReason::Infeasible,
        };
        let why = reasons.iter().find(|(id, _)| *id == effect).map_or(of_search, |(_, why)| *why);
        Withdrawn { effect, why, held_out_rms: held_out_rms(&with) }
    };
    search.given_back().map(of).collect()
}
