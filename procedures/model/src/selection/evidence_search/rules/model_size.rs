//! The model has a place for one more effect.
//!
//! Each added effect is one that a person has to check. The user of a search sets a smaller number.

use crate::selection::evidence_search::rules::Figures;

pub(super) fn passes(figures: &Figures) -> bool {
    !figures.is_full
}
