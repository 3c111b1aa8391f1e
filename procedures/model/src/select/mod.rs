//! Which effect is missing.

mod flips;
mod library;
mod rivals;
mod search;

pub use library::{Library, gain};
pub use rivals::{Rival, significance};
pub use search::{Move, Search, Silence, held_out};
