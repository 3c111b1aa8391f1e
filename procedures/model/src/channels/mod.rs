//! Channels that no instrument measures: formulas over the columns of a run, row by row, and what is in them at each frequency.

mod formula;
mod over_time;
mod spectrum;

pub use formula::{ChannelFormula, OverTime};
pub use spectrum::{Spectrum, spectrum};

#[cfg(test)]
mod tests;
