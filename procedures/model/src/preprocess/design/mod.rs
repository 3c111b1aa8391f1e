//! Which rows are independent, which belong together, and which repeat each other.

pub(crate) mod blocks;
pub(crate) mod replicates;
pub(crate) mod segments;
