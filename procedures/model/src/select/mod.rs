//! Which effect is missing.

mod flips;
mod library;
mod search;

pub use library::{Library, gain};
pub use search::{Move, Rival, Silence, held_out, search, significance};
