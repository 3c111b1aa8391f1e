//! Which effect is missing.

mod flips;
mod library;
mod maps;
mod search;

pub use library::{Library, gain};
pub use maps::{MapFinding, Maps};
pub use search::{Move, Rival, Silence, held_out, search, significance};
