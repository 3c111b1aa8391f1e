//! Presliding has a reach that the run resolves.
//!
//! The elements of the search begin with the shortest displacement that the encoder resolves. If that one explains most,
//! friction changes its direction at once: the position only shows the moment better than the velocity.

use crate::report::fit::Bristles;
use crate::selection::evidence_search::rules::Refit;

pub(super) fn passes(Refit { now, after, .. }: &Refit) -> bool {
    std::ptr::eq(now.main.problem, after.main.problem) || after.prepared.about.bristles.as_ref().is_none_or(is_resolved)
}

fn is_resolved(bristles: &Bristles) -> bool {
    bristles.single().is_none_or(|(_, reach, _)| Some(&reach) != bristles.reaches_rad.first())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shortest_element_is_no_presliding() {
        let with =
            |weights: [f64; 3]| Bristles { reaches_rad: vec![1e-4, 1e-3], weights: weights.to_vec(), band_rad_s: 0.01 };
        assert!(!is_resolved(&with([0.8, 0.1, 0.1])));
        assert!(is_resolved(&with([0.1, 0.8, 0.1])) && is_resolved(&with([0.1, 0.1, 0.8])));
    }
}
