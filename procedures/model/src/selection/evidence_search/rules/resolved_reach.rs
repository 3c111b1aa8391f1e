//! Presliding has a reach that the run resolves.
//!
//! The elements of the search extend from the shortest displacement that the encoder resolves to a part of the motion. If
//! the shortest one explains most, friction changes its direction at once: the position only shows the moment better than
//! the velocity. If the longest one does, the contacts hardly slide in this motion: it may be another torque of the angle.

use crate::report::fit::Bristles;
use crate::selection::evidence_search::rules::Refit;

pub(super) fn passes(Refit { now, after, .. }: &Refit) -> bool {
    std::ptr::eq(now.main.problem, after.main.problem) || after.prepared.about.bristles.as_ref().is_none_or(is_resolved)
}

fn is_resolved(bristles: &Bristles) -> bool {
    let ends = [bristles.reaches_rad.first(), bristles.reaches_rad.last()];
    bristles.single().is_none_or(|(_, reach, _)| !ends.contains(&Some(&reach)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shortest_and_the_longest_element_are_no_presliding() {
        let with = |weights: [f64; 5]| {
            is_resolved(&Bristles { reaches_rad: vec![1e-4, 1e-3, 1e-2], weights: weights.to_vec(), band_rad_s: 0.01 })
        };
        assert!(with([0.1, 0.6, 0.1, 0.1, 0.1]) && with([0.1, 0.1, 0.1, 0.6, 0.1]));
        assert!(!with([0.6, 0.1, 0.1, 0.1, 0.1]));
        assert!(!with([0.1, 0.1, 0.6, 0.1, 0.1]) && !with([0.1, 0.1, 0.1, 0.1, 0.6]));
    }
}
