//! Sentences about effects that the search rejected.

use crate::diagnosis::findings::Findings;
use crate::report::reasons::RemovalReason;
use crate::report::text::all_marked;
use crate::selection::removal::Withdrawn;
use crate::thresholds::LISTED_LOSS;
use crate::words::{Scale, list};

/// Rejected effects that would reduce the error, but that the run determines poorly.
fn undetermined<'f, 'p>(found: &'f Findings<'p>) -> impl Iterator<Item = &'f Withdrawn<'p>> {
    let bound = LISTED_LOSS * found.end_validation_rms;
    found.withdrawn.iter().filter(move |w| w.why == RemovalReason::Unidentified && w.validation_rms < bound)
}

/// Rejected effects with the reason.
pub fn rejected(found: &Findings, unit: &str) -> String {
    // Effects that could replace an effect of the model are reported with that effect.
    let open: Vec<&Withdrawn> = undetermined(found).filter(|w| !found.is_confounded(w.effect)).collect();
    let rejected = |why: RemovalReason| -> Vec<&str> {
        let of = found.withdrawn.iter().filter(|w| w.why == why && !found.is_confounded(w.effect));
        of.map(|w| w.effect).rev().collect()
    };
    let named: Vec<&str> = open.iter().map(|w| w.effect).rev().collect();
    let with = open.iter().map(|w| w.validation_rms).fold(f64::INFINITY, f64::min);
    let open = (!open.is_empty()).then(|| {
        let (object, size) = if open.len() > 1 { ("the best of them", "them") } else { ("it", "it") };
        let scale = Scale::of(found.end_validation_rms, unit);
        format!(
            " Rejected: {}. With {object} the validation error would be {} instead of {}, but this run determines \
             {size} poorly.",
            list(&all_marked(&named)),
            scale.figure(with),
            scale.figure(found.end_validation_rms)
        )
    });
    let for_reason = [RemovalReason::PartialExplanation, RemovalReason::Spurious].into_iter().filter_map(|why| {
        let effects = rejected(why);
        (!effects.is_empty()).then(|| format!(" Rejected: {} ({}).", list(&all_marked(&effects)), why.words()))
    });
    let refused = found.decided.iter().flat_map(|decided| &decided.refused).filter(|r| !found.is_confounded(r.effect));
    let refused: Vec<&str> = refused.map(|refused| refused.effect).collect();
    let refused =
        (!refused.is_empty()).then(|| format!(" Rejected (reasons in the list): {}.", list(&all_marked(&refused))));
    open.into_iter().chain(for_reason).chain(refused).collect()
}
