//! Rules that remove an added effect from a model, one file for each rule.

pub(crate) mod infeasible;
pub(crate) mod insignificant;
pub(crate) mod mutually_cancelling;
pub(crate) mod partial_explanation;
pub(crate) mod random_walk;
pub(crate) mod redundant;
pub(crate) mod spurious;
pub(crate) mod swapped;
pub(crate) mod unidentified;
