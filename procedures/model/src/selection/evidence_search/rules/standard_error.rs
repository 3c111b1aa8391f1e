//! The error reduction of a candidate exceeds its own standard error over the blocks.
//!
//! One block with a large error can give most of the reduction. The one-standard-error rule (Breiman and others 1984)
//! keeps the simpler model then.

use crate::selection::evidence_search::rules::Figures;
use crate::thresholds::ONE_ERROR;

pub(super) fn passes(figures: &Figures) -> bool {
    figures.errors > ONE_ERROR
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::regression::evidence::errors;

    #[test]
    fn a_reduction_in_one_block_of_many_is_rejected() {
        let with = |gains: &[f64]| Figures {
            gain: 0.2,
            errors: errors(gains),
            p_value: 0.001,
            form_error_imitates: false,
            alpha: 0.05,
            is_full: false,
        };
        assert!(passes(&with(&[1.0, 0.8, 1.2, 1.1, 0.9])));
        assert!(!passes(&with(&[5.0, -0.2, 0.1, -0.1, 0.2])));
    }
}
