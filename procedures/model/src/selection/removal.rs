//! Effects that were added and removed again.

use crate::regression::cross_validation::validation_rms;
use crate::report::reasons::RemovalReason;
use crate::selection::floating_search::FloatingSearch;

/// An effect that was added and removed again, with the validation RMS that the last model has with it.
pub struct Withdrawn<'p> {
    pub effect: &'p str,
    pub why: RemovalReason,
    pub validation_rms: f64,
}

/// Effects that were removed and stayed out.
pub fn all<'p>(search: &FloatingSearch<'_, 'p>) -> Vec<Withdrawn<'p>> {
    let of = |(effect, why)| Withdrawn { effect, why, validation_rms: validation_rms(&search.model_with(effect)) };
    search.removals().map(of).collect()
}
