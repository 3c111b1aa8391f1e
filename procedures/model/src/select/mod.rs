//! Which effect is missing.

mod flips;
mod forms;
mod ground;
mod imitated;
mod layout;
mod library;
mod rivals;
mod scatter;
mod search;
mod wander;
mod waves;

pub use ground::Ground;
pub use imitated::moved;
pub use layout::{enter, lay};
pub use library::Library;
pub use rivals::{Rival, alone, is_tie, significance};
pub use scatter::within;
pub use search::{Move, Search, Silence, held_out};
pub use wander::Wander;
