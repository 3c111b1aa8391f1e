//! Which effect is missing.

mod flips;
mod library;
mod rivals;
mod search;

pub use library::{Library, gain};
pub use search::{Move, Rival, Search, Silence, held_out, significance};
