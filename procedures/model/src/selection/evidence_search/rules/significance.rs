//! The p-value of a candidate is below the family-wise error probability.
//!
//! Significance is a condition, not a rank: p-values rank candidates badly. Without it, noise passes the other rules in
//! half of the runs without a missing effect. The p-value is corrected for every form of the library (Bonferroni).

use crate::selection::evidence_search::rules::Figures;

pub(super) fn passes(figures: &Figures) -> bool {
    figures.p_value < figures.alpha
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::regression::evidence::chance;

    #[test]
    fn a_wald_statistic_is_judged_by_its_number_of_blocks() {
        // Three standard errors: clear with 30 blocks, not with 4; and not for one of 20 forms.
        let with = |blocks: usize, forms: f64| Figures {
            gain: 0.2,
            errors: 3.0,
            p_value: forms * chance(9.0, 1, blocks),
            form_error_imitates: false,
            alpha: 0.05,
            is_full: false,
        };
        assert!(passes(&with(30, 1.0)) && !passes(&with(4, 1.0)) && !passes(&with(30, 20.0)));
    }
}
