//! Computed channels: formulas over the columns of a run, row by row, and their spectra.

mod formula;
mod over_time;
mod spectrum;

pub use formula::ChannelFormula;
pub use spectrum::{Spectrum, spectrum};

#[cfg(test)]
mod tests;
