//! One step of a selection.

use crate::regression::two_stage_model::Assembly;
use crate::selection::forward_step::Rival;

/// What was added or removed, and the model after it.
pub struct Advance<'p> {
    pub added: Option<Rival<'p>>,
    pub removed: Option<&'p str>,
    pub ties: Vec<&'p str>,
    pub after: Assembly<'p>,
}
