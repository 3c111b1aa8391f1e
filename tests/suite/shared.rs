//! Measurements of others and practice cases, which are stored outside of the project.

use crate::house::root;
use std::path::PathBuf;

/// A path below `../shared`. `None`, with a message, if it is missing: the test is skipped.
pub fn shared(place: &str) -> Option<PathBuf> {
    let path = root().join("../shared").join(place);
    if path.exists() {
        return Some(path);
    }
    eprintln!("SKIPPED: ../shared/{place} is not here");
    None
}
