//! Residual analysis: the axes with structure, the noise floor, and lack of fit.

pub(crate) mod events;
pub(crate) mod functions;
pub(crate) mod lack_of_fit;
pub(crate) mod maps;
pub(crate) mod noise_floor;
pub(crate) mod random_walk_offset;
pub(crate) mod structure;
pub(crate) mod undersampled_harmonics;
