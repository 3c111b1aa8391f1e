//! A candidate enters only if it explains more than the formula error of the other effects.

use crate::Options;
use crate::selection::acceptance::Candidate;
use crate::thresholds::{FORMULA_ERROR, LARGER_PART};
use jointbench_instrument::Kind;

/// Thresholds that a candidate has to reach.
#[derive(Clone, Copy)]
pub struct AcceptanceThreshold<'l> {
    /// Squared error of the baseline model with all effects whose formula is exact.
    pub plain: f64,
    pub kind: Kind,
    pub options: &'l Options,
}

/// Relative formula error: no formula fits nature better than to this share of what it explains, squared (4.5 % in
/// RMS). Encoder errors are waves over the encoder's own angle, steps and slopes. Their formulas are exact.
fn form_error(kind: Kind) -> f64 {
    if kind == Kind::Encoder { 0.0 } else { FORMULA_ERROR }
}

/// Rejects a candidate that explains no more than the formulas of the other effects may leave.
pub(super) fn passes(candidate: &Candidate) -> bool {
    candidate.share >= candidate.threshold.least_share(candidate.partial.sse)
}

impl AcceptanceThreshold<'_> {
    /// Least partial R² of a candidate for a model with the squared error `sse`. A reduction within the formula
    /// error of the other effects is no evidence.
    pub fn least_share(&self, sse: f64) -> f64 {
        let remainder = form_error(self.kind) * (self.plain - sse).max(0.0);
        self.options.practical_share.max((remainder / sse).min(LARGER_PART))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_candidate_has_to_explain_more_than_the_formula_error_of_the_others() {
        let options = Options::default();
        let least = |kind, sse| AcceptanceThreshold { plain: 100.0, kind, options: &options }.least_share(sse);
        // Nothing explained yet; 99 explained with an error of 0.2 %; all but nothing explained.
        assert_eq!(least(Kind::Friction, 100.0), options.practical_share);
        assert!((least(Kind::Friction, 1.0) - 0.002 * 99.0).abs() < 1e-12);
        assert_eq!(least(Kind::Friction, 1e-6), LARGER_PART);
        assert_eq!(least(Kind::Encoder, 1.0), options.practical_share);
    }
}
