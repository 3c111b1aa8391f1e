//! Design of the data: independent rows, common conditions, and replicates.

pub(crate) mod blocks;
pub(crate) mod replicates;
pub(crate) mod segments;
